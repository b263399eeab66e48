"""Case files as nested dicts: reading with `extends`, replacing single values, writing TOML."""

import json
import re
import tomllib

from parsim.case import examples
from parsim.case.course import read_courses
from parsim.errors import InputError, nearest, suggestion


def read(path, inside=()):
    """Nested dict of the case file at `path`, merged over the file that it `extends`, if any.

    `inside` are the files that are being read already, to find loops. Raises InputError.
    """
    if path.resolve() in inside:
        raise InputError(f"{path}: extends = loops: " + " -> ".join(p.name for p in (*inside, path)))
    data = _parsed(path)
    locate(data, path.parent)
    parent = data.pop("extends", None)
    if parent is None:
        return data
    if not isinstance(parent, str) or "\0" in parent:
        raise InputError(f"{path}: extends = {parent!r}: must be the path of a case file, as text")
    return _merged(read(path.parent / parent, (*inside, path.resolve())), data)


def locate(data, folder):
    """Make the paths of files that a case names whole, and read those of courses: they count from where the case is."""
    study, ice, box = (data.get(name) for name in ("study", "ice", "box"))
    if isinstance(study, dict) and isinstance(study.get("table"), str):
        study["table"] = _whole(folder, study["table"], "study.table")
    for name in ("channel", "motion"):
        if isinstance(data.get(name), dict):
            read_courses(data[name], folder, name)
    faces = box.get("faces") if isinstance(box, dict) else None
    for name, side in faces.items() if isinstance(faces, dict) else ():
        if isinstance(side, dict):
            read_courses(side, folder, f"box.faces.{name}")
    named = [(f"bodies.{number}.shape", body.get("shape")) for number, body in enumerate(_tables(data.get("bodies")))]
    for key in ("fields", "supplies"):
        for given in _tables(ice.get(key) if isinstance(ice, dict) else None):
            read_courses(given, folder, f"ice.{key}")
            named += [(f"ice.{key}.{name}", value) for name, value in given.items()]
    for name, table in (*named, ("bed", data.get("bed"))):
        if isinstance(table, dict) and isinstance(table.get("file"), str):
            table["file"] = _whole(folder, table["file"], f"{name}.file")


def _whole(folder, path, key):
    """The whole path of a file that a case in a folder names. Raises InputError."""
    if "\0" in path:
        raise InputError(f"{key} = {path!r}: must be the path of a file")
    return str((folder / path).resolve())


def _tables(entries):
    """The tables in what should be a list of them."""
    return [entry for entry in entries if isinstance(entry, dict)] if isinstance(entries, list) else []


def _parsed(path):
    text = ""
    try:
        text = path.read_text(encoding="utf-8-sig")  # editors of Windows begin a file with a byte order mark
        return tomllib.loads(text)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file{suggestion(_nearest_file(path))}") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a folder; a case is a TOML file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file in UTF-8; a case is a TOML file") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not valid TOML: {_given_twice(text, str(error)) or error}") from None


def _given_twice(text, reason):
    """Which key of a TOML text is there twice and on which line, where that is what tomllib means; else None."""
    found = re.search(r"(overwrite|twice|namespace|inline table key '(.*)').* \(at line (\d+), ", reason)
    if not found:
        return None
    last, lines = int(found[3]), text.split("\n")
    heads = [re.match(r"\s*\[\[?\s*([^\[\]]+?)\s*\]", line) for line in lines[:last]]
    if heads[-1]:
        return f"{heads[-1][1]} is given twice, again on line {last}"
    if found[2]:
        return f"{found[2]} is given twice in the table between braces that ends on line {last}"
    for first in reversed(range(last)):  # a value may go over several lines, and the fault is where it ends
        try:
            tomllib.loads("\n".join(lines[first:last]))
        except ValueError:
            continue
        table = next((head[1] + "." for head in reversed(heads) if head), "")
        return f"{table}{lines[first].partition('=')[0].strip()} is given twice, again on line {first + 1}"
    return None


def _nearest_file(path):
    """The case file beside `path` whose name is like that of `path`, else an example's name, or None."""
    try:
        stems = {p.stem: p for p in path.parent.glob("*.toml")}
    except OSError:
        return None
    return stems.get(nearest(path.name.removesuffix(".toml"), stems)) or examples.like(path.as_posix())


def _merged(below, above):
    """Tables of `above` merged into those of `below`; everything else replaced."""
    both = dict(below)
    for key, value in above.items():
        old = below.get(key)
        both[key] = _merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return both


def replaced(data, overrides):
    """`data` (changed in place) with each "key.path=value" of `overrides` put in. Raises InputError."""
    messages = []
    for override in overrides:
        path, equals, text = override.partition("=")
        keys = [key.strip() for key in path.split(".")]
        if not equals or not all(keys):
            messages.append(f"--set {override}: must be key.path=value, such as run.until=2.0")
            continue
        try:
            _put(data, keys, _value(text.strip()))
        except KeyError as error:
            messages.append(f"--set {override}: {error.args[0]}")
    if messages:
        raise InputError(messages)
    return data


def _value(text):
    """The TOML value that `text` is, else the text itself."""
    try:
        data = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return data["value"] if len(data) == 1 else text


def _put(data, keys, value):
    for depth, key in enumerate(keys):
        path = ".".join(keys[:depth])
        if isinstance(data, list):
            key = _index(data, key, path)
        elif not isinstance(data, dict):
            raise KeyError(f"{path} is a single value and has no {key}")
        if depth == len(keys) - 1:
            data[key] = value
        else:
            data = data[key] if isinstance(data, list) else data.setdefault(key, {})


def _index(entries, key, path):
    """Place in the list `entries` that `key`, a name or a number, means."""
    names = [entry.get("name") if isinstance(entry, dict) else None for entry in entries]
    if key in names:
        return names.index(key)
    if key.isdecimal() and len(key) < 10 and int(key) < len(entries):
        return int(key)
    known = [name for name in names if isinstance(name, str)] or [str(i) for i in range(len(entries))]
    raise KeyError(f"{path} has no entry {key}; allowed: {', '.join(known) or 'none, the list is empty'}")


def written(data):
    """TOML text of a nested dict; tables of tables and lists of named tables as sections. Reads back equal."""
    plain, sections = [], []
    for key, value in data.items():
        if isinstance(value, dict) and value and all(isinstance(entry, dict) for entry in value.values()):
            sections += [_section(f"[{key}.{name}]", entry) for name, entry in value.items()]
        elif isinstance(value, dict):
            sections.append(_section(f"[{key}]", value))
        elif isinstance(value, tuple) and value and isinstance(value[0], dict):
            sections += [_section(f"[[{key}]]", entry) for entry in value]
        else:
            plain.append(f"{key} = {inline(value)}\n")
    return "\n".join(["".join(plain), *sections])


def _section(header, table):
    return "".join([f"{header}\n", *(f"{key} = {inline(value)}\n" for key, value in table.items())])


def inline(value):
    """One value as TOML: exact floats, text with every control character escaped."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {inline(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(inline(entry) for entry in value) + "]"
    return repr(value)
