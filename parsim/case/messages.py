"""What is wrong with a case file's keys and values, in words: key path, value, what is allowed, nearest name."""

import re
from copy import deepcopy
from typing import get_args, get_origin

from pydantic import BaseModel, ValidationError

from parsim.case.types import CHOICE, LEAST, TAG, kind_of
from parsim.errors import InputError, nearest, suggestion

_ALLOWED = {
    "missing": "missing",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be a text",
    "string_unicode": "must be a text in UTF-8",
    "finite_number": "must be a finite number",
    "tuple_type": "must be a list",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "literal_error": "must be {expected}",
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "too_long": "must have {max_length} entries",
    "too_short": "must have at least {min_length} entries",
    "string_pattern_mismatch": "must be a letter followed by letters, digits, _ or - (64 at most)",
}


def validated(model, data):
    """(`model` made from the nested dict `data`, messages about its unknown keys).

    A misspelt key is reported, then read as the key it resembles, so that everything else is checked too.
    Raises InputError if there is more wrong than unknown keys.
    """
    messages, data = [], deepcopy(data)
    while True:
        try:
            return model.model_validate(data), messages
        except ValidationError as error:
            faults = [_placed(data, fault) for fault in error.errors(include_url=False)]
        unknown = [fault["loc"] for fault in faults if fault["type"] == "extra_forbidden"]
        if not unknown:
            raise InputError(messages + _described(model, data, faults))
        messages += [_mended(model, data, place) for place in unknown]


def _placed(data, fault):
    """A fault with its place as in the file: where there is a choice of tables pydantic puts in which was chosen."""
    place, value = [], data
    for step in fault["loc"]:
        if isinstance(step, str) and step.startswith(TAG):
            continue
        place.append(step)
        value = _step(value, step)
    changed = {"loc": tuple(place)}
    if fault["type"] == "union_tag_invalid":
        *others, last = fault["ctx"]["expected_tags"].replace(TAG, "").split(", ")
        changed = {
            "loc": (*place, CHOICE),
            "type": "literal_error",
            "ctx": {"expected": f"{', '.join(others)} or {last}"},
        }
    elif fault["type"] == "union_tag_not_found":
        table = isinstance(value, dict)
        changed = {"loc": (*place, CHOICE), "type": "missing"} if table else {"loc": tuple(place), "type": "model_type"}
    return fault | changed


def _mended(model, data, place):
    """Message about the unknown key at `place`; renames it in `data` to what was meant, or drops it."""
    table = _value_at(data, place[:-1])
    value = table.pop(place[-1])
    known = list(_model_at(model, data, place[:-1]).model_fields)
    path = key_path(data, place)
    meant = nearest(place[-1], known)
    if meant is not None:
        table.setdefault(meant, value)
        return f"{path}: unknown key{suggestion(key_path(data, (*place[:-1], meant)))}"
    kinds = [kind_of(t) for t in _tables_at(model, data, place[:-1])[0] if place[-1] in t.model_fields]
    if kinds:
        return f"{path}: belongs to {CHOICE} = {' or '.join(map(repr, kinds))}; allowed: {', '.join(known)}"
    elsewhere = dict(_all_keys(model))
    meant = nearest(place[-1], elsewhere, 0.8)
    return f"{path}: unknown key{suggestion(elsewhere.get(meant)) or '; allowed: ' + ', '.join(known)}"


def _described(model, data, faults):
    """One message per place; several causes at one place are alternatives."""
    causes = {}
    for fault in faults:
        place = _within(data, fault["loc"], fault["type"] == "missing")
        text = _ALLOWED.get(fault["type"], fault["msg"]).format(**fault.get("ctx", {}))
        if fault.get("ctx", {}).get("ge") == LEAST:
            text = f"must be greater than 0, {LEAST:g} or more"
        causes.setdefault(place, []).append(text)
    return [_message(model, data, place, texts) for place, texts in causes.items()]


def _message(model, data, place, texts):
    path, meaning = key_path(data, place), _description(model, data, place)
    if "missing" in texts:
        return f"{path}: missing; {meaning}" if meaning else f"{path}: missing; required"
    allowed = " or ".join(text if i == 0 else text.removeprefix("must be ") for i, text in enumerate(texts))
    value = _value_at(data, place)
    meant = nearest(value, re.findall("'([^']+)'", allowed)) if isinstance(value, str) else None
    return f"{path} = {short(value)}: {allowed}" + (f" ({meaning})" if meaning else "") + suggestion(meant)


def short(value):
    """A value for a message, cut when long."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def key_path(data, place):
    """Key path such as bodies.A1.density; list entries by name where they have one."""
    words, value = [], data
    for step in place:
        value = _step(value, step)
        name = value.get("name") if isinstance(step, int) and isinstance(value, dict) else None
        words.append(name if isinstance(name, str) else str(step))
    return ".".join(words)


def _step(value, step):
    try:
        return value[step]
    except (KeyError, IndexError, TypeError):
        return None


def _value_at(data, place):
    for step in place:
        data = _step(data, step)
    return data


def _within(data, place, missing):
    """The leading part of `place` that exists in `data` (pydantic adds steps of its own for unions and keys)."""
    inside = len(place) - 1 if missing else len(place)
    for depth in range(inside):
        here = _value_at(data, place[:depth])
        step = place[depth]
        exists = step in here if isinstance(here, dict) else isinstance(here, list) and isinstance(step, int)
        if not exists:
            return place[:depth]
    return place


def _tables(annotation):
    """The table models inside an annotation such as Gate | None, tuple[Body, ...], dict[str, Material] or a choice."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [table for part in get_args(annotation) for table in _tables(part)]


def _chosen(tables, value):
    """That of the tables which is of the kind that the dict `value` names, else the first."""
    kind = value.get(CHOICE) if isinstance(value, dict) else None
    named = [table for table in tables if kind in get_args(getattr(table.model_fields.get(CHOICE), "annotation", None))]
    return (named or tables or [None])[0]


def _tables_at(model, data, place):
    """(table models among which there is a choice at `place` below `model`, value there); steps that choose an entry of
    a list or table are passed over."""
    tables, steps = [model], iter(place)
    for step in steps:
        annotation, data = _chosen(tables, data).model_fields[step].annotation, _step(data, step)
        if get_origin(annotation) in (tuple, dict):
            data = _step(data, next(steps, None))
        tables = _tables(annotation)
    return tables, data


def _model_at(model, data, place):
    """The table model at `place` below `model`."""
    return _chosen(*_tables_at(model, data, place))


def _description(model, data, place):
    """What the key at `place` means, from the model, or an empty text."""
    names = [i for i, step in enumerate(place) if isinstance(step, str)]
    if not names:
        return ""
    *above, key = place[: names[-1] + 1]
    tables, value = _tables_at(model, data, above)
    if key == CHOICE and tables[1:]:
        return f"one of {', '.join(repr(kind_of(table)) for table in tables)}"
    field = _chosen(tables, value).model_fields.get(key)
    return field.description if field else ""


def _all_keys(model, path=""):
    """(key, full path) of every key of every table, the nearest to the top last."""
    for name, field in reversed(model.model_fields.items()):
        for inner in _tables(field.annotation):
            many = ".NAME" if get_origin(field.annotation) in (tuple, dict) else ""
            yield from _all_keys(inner, f"{path}{name}{many}.")
        yield name, path + name
