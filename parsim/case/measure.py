"""The tables of a case about what is measured of a river with ice, and what may be wrong with them."""

from pydantic import Field

from parsim.case.types import Name, Number, Positive, Table
from parsim.errors import nearest, suggestion

_WIDTHS = 2.0  # of the channel, that the reach of a jam has at least

Span = tuple[Number, Number]


class Sought(Table):
    """What makes a jam: ice that stands upstream of a plane and no longer passes it."""

    control: Name = Field(description="name of the control plane that ice no longer passes")
    reach: Span = Field(description="from where to where upstream of it ice stands, m; two widths at least")
    supply: Positive | None = Field(
        None,
        description="ice that comes, m3/s; left out: the most that comes into the reach over the time that makes a "
        "jam, or what is in it at the start at the water's speed",
    )


class Measure(Table):
    """What the page of a river shows. Without a case has no such section."""

    grid: Positive | None = Field(None, description="edge of a column, m; left out: two spacings")
    reach: Span | None = Field(None, description="where the energy slope and means are taken, m; left out: the box")
    before: Span | None = Field(
        None, description="times before ice changes the level, s; left out: the first 5 sqrt(H/g) after 0"
    )
    control: dict[Name, Number] = Field({}, description="planes through which ice is counted: their x by name, m")
    head_loss: Span | None = Field(None, description="two sections between which the lost head is told, m")
    jam: Sought | None = Field(None, description="what a jam would be; left out: none is looked for")
    cover: Name | None = Field(None, description="fixed body against which blocks drift; left out: none")
    piers: tuple[Name, ...] | None = Field(
        None, description="fixed bodies whose forces are told; left out: all but the cover"
    )


def faults(case):
    """What is wrong with the table `measure` of a completed case: messages."""
    measure = case.measure
    if measure is None:
        return []
    out = [] if case.gravity[2] < 0.0 else [f"measure: needs gravity along -z; gravity = {list(case.gravity)}"]
    if measure.grid is not None and measure.grid < case.spacing:
        out.append(f"measure.grid = {measure.grid!r}: must be at least the spacing, {case.spacing!r} m")
    low, high = case.box.min[0], case.box.max[0]
    spans = [("reach", measure.reach, low, high), ("head_loss", measure.head_loss, low, high)]
    spans.append(("before", measure.before, case.start, case.run.until))
    spans += [("jam.reach", measure.jam.reach, low, high)] if measure.jam else []
    out += [
        f"measure.{key} = {list(span)}: must rise within {least!r} to {most!r}"
        for key, span, least, most in spans
        if span is not None and not least <= span[0] < span[1] <= most
    ]
    out += [
        f"measure.control.{name} = {x!r}: outside the box; must be {low!r} to {high!r}"
        for name, x in measure.control.items()
        if not low <= x <= high
    ]
    return out + [*_jam(case, measure)] + [*_bodies(case, measure)]


def _jam(case, measure):
    if measure.jam is None:
        return
    sought, (begin, end) = measure.jam, measure.jam.reach
    if sought.control not in measure.control:
        hint = suggestion(nearest(sought.control, measure.control))
        allowed = ", ".join(measure.control) or "none"
        yield f'measure.jam.control = "{sought.control}": no such plane in measure.control; allowed: {allowed}{hint}'
    elif end > measure.control[sought.control]:
        plane = measure.control[sought.control]
        yield f"measure.jam.reach = {[begin, end]}: must end upstream of measure.control.{sought.control}, {plane!r} m"
    least = _WIDTHS * case.box.size[1]
    if case.dimensions == 3 and begin < end < begin + least * (1.0 - 1e-9):
        yield f"measure.jam.reach = {[begin, end]}: must be two widths of the channel long, {least:g} m, at least"


def _bodies(case, measure):
    """What is wrong with the bodies named."""
    fixed = {body.name: body.fixed for body in case.bodies}
    named = [("cover", measure.cover)] if measure.cover else []
    for key, name in named + [("piers", name) for name in measure.piers or ()]:
        if name not in fixed:
            hint = suggestion(nearest(name, fixed))
            yield f'measure.{key} = "{name}": no such body; allowed: {", ".join([*fixed][:9]) or "none"}{hint}'
        elif not fixed[name]:
            yield f'measure.{key} = "{name}": must be a fixed body'
    if measure.cover and measure.cover in (measure.piers or ()):
        yield f'measure.piers = "{measure.cover}": is the cover; leave it out'
