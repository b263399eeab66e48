"""The page: one HTML file that holds everything it shows."""

import base64
import html
from collections.abc import Iterable, Sequence

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.55 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; color: #1f2933; background: #fff;
  max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; line-height: 1.25; margin-bottom: .3rem; }
h2 { font-size: 1.2rem; margin-top: 2.4rem; border-bottom: 1px solid #cbd2d9; padding-bottom: .2rem; }
p.lead { color: #52606d; margin-top: 0; }
table { border-collapse: collapse; width: 100%; font-size: .92rem; margin: .8rem 0; }
div.wide { overflow-x: auto; }
th, td { text-align: left; padding: .3rem .7rem .3rem 0; border-bottom: 1px solid #e4e7eb; vertical-align: top; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
figure { margin: 1.2rem 0; break-inside: avoid; }
figure img, figure video { max-width: 100%; height: auto; display: block; margin: 0 auto; }
figcaption { color: #52606d; font-size: .9rem; margin-top: .3rem; }
ul.warnings { background: #fffbea; border-left: 4px solid #f0b429; padding: .6rem .6rem .6rem 2rem; }
pre { background: #f5f7fa; padding: .8rem; font-size: .78rem; overflow-x: auto; white-space: pre-wrap; }
@media print { body { max-width: none; margin: 0; font-size: 11pt; } h2 { break-after: avoid; }
  tr { break-inside: avoid; } video { border: 1px solid #cbd2d9; } }
"""
MEDIA = {"png": "image/png", "gif": "image/gif", "mp4": "video/mp4"}


def text(value: object) -> str:
    """A value as safe HTML: numbers short, None as a dash."""
    if value is None:
        return "&ndash;"
    if isinstance(value, float):
        value = f"{value:.4g}"
    return html.escape(str(value))


def section(title: str, *parts: str) -> str:
    """A titled section of the parts that are not empty; nothing when all are."""
    filled = [part for part in parts if part]
    return "\n".join([f"<h2>{text(title)}</h2>", *filled]) if filled else ""


def table(titles: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table whose columns of numbers stand to the right; nothing without rows."""
    if not rows:
        return ""

    numeric = [
        all(value is None or isinstance(value, int | float) for value in column) for column in zip(*rows, strict=True)
    ]

    def line(kind, row):
        styles = [' class="number"' if number else "" for number in numeric]
        cells = (f"<{kind}{style}>{text(value)}</{kind}>" for style, value in zip(styles, row, strict=True))
        return f"<tr>{''.join(cells)}</tr>"

    body = "\n".join(line("td", row) for row in rows)
    return f'<div class="wide"><table><thead>{line("th", titles)}</thead><tbody>\n{body}\n</tbody></table></div>'


def listing(items: Sequence[object], kind: str = "") -> str:
    """A list of lines; nothing without items."""
    lines = "\n".join(f"<li>{text(item)}</li>" for item in items)
    return f'<ul class="{kind}">{lines}</ul>' if items else ""


def picture(data: bytes, suffix: str, alternative: str, caption: str) -> str:
    """A picture or film held in the page, ``alternative`` for those who cannot see it; nothing without data."""
    if not data:
        return ""
    source = f"data:{MEDIA[suffix]};base64,{base64.b64encode(data).decode()}"
    if suffix == "mp4":
        shown = f'<video src="{source}" aria-label="{text(alternative)}" controls loop muted playsinline></video>'
    else:
        shown = f'<img src="{source}" alt="{text(alternative)}">'
    return f"<figure>{shown}<figcaption>{text(caption)}</figcaption></figure>"


def preformatted(words: str) -> str:
    """Text as it stands; nothing without it."""
    return f"<pre>{html.escape(words)}</pre>" if words else ""


def page(title: str, lead: str, sections: Iterable[str]) -> str:
    """The whole page."""
    body = "\n".join(part for part in sections if part)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{text(title)}</title><style>{STYLE}</style></head>
<body><h1>{text(title)}</h1><p class="lead">{text(lead)}</p>
{body}
</body></html>
"""
