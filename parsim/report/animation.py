"""A short animation of all frames: MP4 where imageio has an encoder, else GIF."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from parsim.report import plane
from parsim.report.pictures import show
from parsim.report.scene import OBLIQUE, load

if TYPE_CHECKING:
    from collections.abc import Sequence

    from parsim.output.reader import Run
    from parsim.report.pictures import Gallery

MOST_FRAMES, SECONDS, SLOWEST, FASTEST = 100, 6.0, 5, 20
DOTS, COLOURS = 90, 96
LARGEST = 2000  # dots along a side


def chosen(count: int) -> list[int]:
    """Which of ``count`` frames are shown: all, or as evenly as may be at most MOST_FRAMES."""
    return sorted(set(np.linspace(0, count - 1, min(count, MOST_FRAMES)).round().astype(int).tolist()))


def rate(count: int) -> int:
    """Pictures per second."""
    return int(np.clip(count / SECONDS, SLOWEST, FASTEST))


def animate(run: Run, gallery: Gallery, frames: Sequence[int]) -> tuple[bytes, str]:
    """The animation of ``frames``: (bytes, "mp4" or "gif")."""
    # colours must not jump: 2D pictures share the scale of the run
    draw = _spatial if run.case["dimensions"] == 3 else _plane(run, frames)
    pictures = (_pixels(draw(run, gallery, frame)) for frame in frames)
    try:
        return _mp4(pictures, rate(len(frames))), "mp4"
    except (ImportError, RuntimeError, OSError):
        pictures = (_pixels(draw(run, gallery, frame)) for frame in frames)
        return _gif(pictures, rate(len(frames))), "gif"


def _spatial(run, gallery, frame):
    scene = load(run, frame)
    extent = OBLIQUE.extent(scene)
    height = 8 * (extent[3] - extent[2]) / (extent[1] - extent[0])
    drawn = Figure(figsize=(8, height))
    axes = drawn.add_axes((0, 0, 1, 1))
    show(axes, gallery, scene, frame, OBLIQUE)
    axes.text(0.03, 0.94, f"t = {scene.time:.2f} s", transform=axes.transAxes, fontsize=13)
    return drawn


def _plane(run, frames):
    fastest = max(plane.scale(run.water(frame), "speed") for frame in frames)

    def draw(run, gallery, frame):
        return plane.snapshot(run, frame, ("speed",), fastest)

    return draw


def _pixels(figure):
    """The figure as bytes (rows, columns, 3), both even, as the encoder wants them."""
    figure.set_dpi(min(DOTS, LARGEST / max(figure.get_size_inches())))
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    picture = np.asarray(canvas.buffer_rgba())[..., :3]
    return np.ascontiguousarray(picture[: picture.shape[0] // 2 * 2, : picture.shape[1] // 2 * 2])


def _mp4(pictures, fps):
    import imageio.v2 as imageio
    import imageio_ffmpeg

    imageio_ffmpeg.get_ffmpeg_exe()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "animation.mp4"
        with imageio.get_writer(path, fps=fps, codec="libx264", quality=7, macro_block_size=2) as writer:
            for picture in pictures:
                writer.append_data(picture)
        return path.read_bytes()


def _gif(pictures, fps):
    from PIL import Image

    images = [Image.fromarray(picture).quantize(COLOURS, dither=Image.Dither.NONE) for picture in pictures]
    target = io.BytesIO()
    images[0].save(target, "GIF", save_all=True, append_images=images[1:], duration=round(1000 / fps), loop=0)
    return target.getvalue()
