"""Ice in a case: fields of floes at the start and supplies of floes that come in, and the bodies that they become.

Lengths in m.
"""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from parsim.case import ice_faults, places, supply
from parsim.case.bodies import gate_box, placed
from parsim.case.course import Course
from parsim.case.ice_faults import floes_of, rectangle, shape_of, water_under
from parsim.case.plans import plan_of
from parsim.case.types import LEAST, Count, Name, NotNegative, Number, Positive, Real, Table, Vector, Whole
from parsim.errors import InputError
from parsim.geometry.faces import repeats
from parsim.ice.draw import Laws, stream_of
from parsim.ice.field import MOST, Placed, covering, plan, room_for, spread
from parsim.ice.laws import Law, Listed, Thickness
from parsim.ice.outlines import joined, outlines
from parsim.ice.place import Pose, Region
from parsim.ice.row import row

GAP = 0.5  # spacings, between floes and to all else, where no gap is given
SQUARE = Listed(kind="list", values=(1.0,))
Ends = Annotated[tuple[Number, ...], Field(max_length=2)]
Concentration = Annotated[Real, Field(ge=LEAST, le=0.9)]


class Floes(Table):
    """Floes drawn from laws: what fields and supplies have in common. KEY: where such tables are in a case."""

    KEY: ClassVar[str]
    name: Name = Field(description="name; its floes are bodies NAME_1, NAME_2 and so on")
    shape: Literal["box", "disc", "polygon"] = Field("box", description="what the floes are; in 2D box")
    size: Law = Field(
        description="size, m, a number or a law: longer edge of a box, diameter of a disc, that of the circle of a "
        "polygon's area"
    )
    thickness: Thickness = Field(description="thickness, m, a number or a law")
    aspect: Law | None = Field(None, description="length over width of boxes and polygons, a number or a law; else 1")
    gap: NotNegative | None = Field(
        None, description="least distance in plan to each other, bodies, gate and sides, m; left out: half a spacing"
    )
    density: Positive = Field(description="density, kg/m3")
    material: Name = Field(description="name of their material")
    seed: Annotated[Whole, Field(ge=0, lt=2**63)] = Field(0, description="another number gives other floes")
    floes: Count | None = Field(
        None, description="how many of the bodies are its floes; written with them, left out: none yet"
    )

    def laws(self, dimensions):
        """What its floes are drawn from."""
        return Laws(self.shape, self.size, self.thickness, self.aspect or SQUARE, dimensions)

    @property
    def stream(self):
        """The number of the stream of its draws."""
        return stream_of(f"{self.KEY}.{self.name}")

    def apart(self, case):
        """Their least distance in plan, m."""
        return GAP * case.spacing if self.gap is None else self.gap


class IceField(Floes):
    """Floes afloat at rest or at one velocity in a rectangle, drawn from laws."""

    KEY = "ice.fields"
    min: Ends = Field(description="lowest corner of the rectangle in plan (x, y), m; in 2D (x)")
    max: Ends = Field(description="highest corner (x, y), m; in 2D (x)")
    concentration: Concentration = Field(description="area of the floes over the rectangle's")
    velocity: Vector = Field((0.0, 0.0, 0.0), description="velocity at the start, m/s")


class IceSupply(Floes):
    """Floes that come in through the inlet with the water, drawn from laws. One of concentration and discharge."""

    KEY = "ice.supplies"
    concentration: Concentration | None = Field(
        None, description="area of the floes over that of the surface that comes in with them"
    )
    discharge: Course | None = Field(
        None, description="volume of ice that comes in, m3/s (2D: m2/s): a number, rows [time, value] or a file"
    )
    begins: NotNegative = Field(0.0, description="time from which on it comes, s")
    ends: Positive | None = Field(
        None, description="time at which it ends, s; left out: the end of the run, beyond which it has no floes"
    )


class Ice(Table):
    """Ice."""

    fields: tuple[IceField, ...] = Field((), description="fields of floes at the start")
    supplies: tuple[IceSupply, ...] = Field((), description="floes that come in through the inlet")


def with_floes(case):
    """(`case`, whose bodies have their places, with the floes of its fields among them, yet to float; messages)."""
    if not (case.ice.fields or case.ice.supplies or any(body.enters for body in case.bodies)):
        return case, []
    faults, fields, made, taken = ice_faults.names(case), [], [], None
    for given in case.ice.fields:
        try:
            field, wrong = ice_faults.read(given, case.dimensions)
            wrong = wrong or list(ice_faults.wrong(case, field))
            if not wrong and field.floes is None:
                if taken is None:
                    taken = [*map(places.of_body, placed(case)), *([gate_box(case)] if case.gate else [])]
                found, field = _spread(case, field, taken, made)
                made.append(found)
        except InputError as error:
            field, wrong = given, error.messages
        faults += [f"{given.KEY}.{given.name}.{text}" for text in wrong]
        fields.append(field)
    new = [body for _, bodies in made for body in bodies]
    supplies, waiting, wrong = _supplied(case)
    ice = case.ice.model_copy(update={"fields": tuple(fields), "supplies": tuple(supplies)})
    return case.model_copy(update={"bodies": (*case.bodies, *new, *waiting), "ice": ice}), faults + wrong


def undrawn(case):
    """A completed case without the floes of its fields and supplies, which what these say gives it anew."""
    every = *case.ice.fields, *case.ice.supplies
    drawn = {body.name for given in every for body in floes_of(case, given)}
    fields, supplies = (
        tuple(given.model_copy(update={"floes": None}) for given in some)
        for some in (case.ice.fields, case.ice.supplies)
    )
    ice = case.ice.model_copy(update={"fields": fields, "supplies": supplies})
    return case.model_copy(update={"bodies": tuple(b for b in case.bodies if b.name not in drawn), "ice": ice})


def _supplied(case):
    """(The supplies of a case, completed; the bodies that wait to come in, yet to float at the inlet; messages)."""
    supplies, bodies = [], []
    known = {body.name for given in case.ice.supplies for body in floes_of(case, given)}
    faults = [
        f"bodies.{body.name}.enters = true: is written with the floes of ice.supplies; leave it out"
        for body in case.bodies
        if body.enters and body.name not in known
    ]
    x, y = case.box.min[0] + 0.5 * (case.spacing or 0.0), 0.5 * (case.box.min[1] + case.box.max[1])
    for given in case.ice.supplies:
        try:
            supplied, wrong = supply.read(case, given)
            if not wrong and supplied.floes is None:
                found = [Placed(floe, Pose(x, y, 0.0)) for floe in supply.floes(case, supplied)]
                new = [_body(case, supplied, number, one) for number, one in enumerate(found, 1)]
                bodies += [body.model_copy(update={"enters": True}) for body in new]
                supplied = supplied.model_copy(update={"floes": len(found)})
        except InputError as error:
            supplied, wrong = given, error.messages
        faults += [f"{given.KEY}.{given.name}.{text}" for text in wrong]
        supplies.append(supplied)
    return supplies, bodies, faults


def told(case):
    """Of each field of a completed case: floes, area and concentration, asked for and reached, in words."""
    lines = []
    for field in case.ice.fields:
        reached, whole = sum(_area(body) for body in floes_of(case, field)), rectangle(field)
        unit = "m" if case.dimensions == 2 else "m2"
        lines.append(
            f"ice        {field.name}: {field.floes} floes on {reached:.4g} {unit}, {field.concentration * whole:.4g} "
            f"{unit} asked for; concentration {reached / whole:.4g}"
        )
    for given in case.ice.supplies:
        volume = sum(body.shape.volume for body in floes_of(case, given))
        unit = "m2" if case.dimensions == 2 else "m3"
        lines.append(f"ice        {given.name}: up to {given.floes} floes of {volume:.4g} {unit} will come in")
    return lines


def doubts(case):
    """What is allowed but doubtful in the fields of a checked case: messages."""
    for field in (*case.ice.fields, *case.ice.supplies) if case.water.scheme.WET else ():
        widths = [2.0 * body.shape.thinnest(case.dimensions == 2) for body in floes_of(case, field)]
        few = [width for width in widths if round(width / case.spacing) < 4]
        if few:
            yield (
                f"{field.KEY}.{field.name}: {len(few)} of {len(widths)} floes have fewer than four particles across "
                f"their thinnest side, {min(few):.6g} m at least; four or more give usable loads"
            )
    for given in case.ice.supplies:
        if given.ends is None and (last := supply.lasts_to(case, given)) < case.run.until:
            yield (
                f"{given.KEY}.{given.name}: has floes to the end that the run first had, about {last:.4g} s, and none "
                f"from there to run.until = {case.run.until!r}; a supply that is given `ends` lasts to that"
            )


def _spread(case, field, taken, made):
    """(what the floes take of the plan, their bodies), and the field that says how many. Raises InputError."""
    bottom, level = water_under(case, field)
    gap, laws = field.apart(case), field.laws(case.dimensions)
    asked, region = field.concentration * rectangle(field), _region(case, field, gap)
    floes = covering(asked, field.seed, field.stream, laws)
    if floes is None:
        raise InputError(f"size: more than {MOST} floes cover {asked:.6g} m2; make them larger or the field smaller")
    ice_faults.check_sizes(case, field, floes, region)
    share = field.density / case.water.density
    thickest = max(floe.thickness for floe in floes)
    if share * thickest > level - bottom:
        text = f"thickness: reaches {thickest:.6g} m, a draught of {share * thickest:.6g} m, more than the depth of "
        raise InputError(f"{text}water there, {level - bottom:.6g} m")
    band = level - share * thickest - gap, level + (1.0 - share) * thickest + gap
    solids = [place for place in taken if place.low()[2] < band[1] and place.high()[2] > band[0]]
    fixed = outlines([], [])
    for solid in solids:
        fixed = joined(fixed, plan_of(solid, band[0]))
    for others, _ in made:
        fixed = joined(fixed, others)
    found = (_in_a_row if case.dimensions == 2 else spread)(floes, region, fixed, gap)
    if found is None:
        raise InputError(_crowded(case, field, floes, region, fixed, gap))
    bodies = [_body(case, field, number, one) for number, one in enumerate(found, 1)]
    return (plan(found), bodies), field.model_copy(update={"floes": len(found)})


def _crowded(case, field, floes, region, fixed, gap):
    """The message that there is no room."""
    if case.dimensions == 2:
        here = _in_a_row(floes, region, fixed, gap, some=True)
        reached = sum(one.floe.area for one in here)
    else:
        reached = room_for(floes, region, fixed, gap)
    least = min(floe.size for floe in floes)
    return (
        f"concentration = {field.concentration!r}: no room for {len(floes)} floes {gap:.4g} m apart; there was for "
        f"{reached / rectangle(field):.2g}. Ask for less, for a smaller gap or larger floes (the least is {least:.4g} "
        f"m){'' if field.shape == 'polygon' or case.dimensions == 2 else ', or for polygons'}"
    )


def _in_a_row(floes, region, fixed, gap, some=False):
    """Floes of a plane, placed; None where there is no room for all, unless some are enough."""
    low, _, high, _ = fixed.extents()
    centres = row(floes, region.low[0], region.high[0], list(zip(low.tolist(), high.tolist(), strict=True)), gap)
    if not some and None in centres:
        return None
    return [Placed(f, Pose(_rounded(c), 0.5, 0.0)) for f, c in zip(floes, centres, strict=True) if c is not None]


def _rounded(x):
    return round(x, 9)


def _region(case, field, gap):
    """Where floes may be: in the rectangle, and a gap off the sides of the box, half a spacing off periodic ones."""
    around, low, high = repeats(case), [], []
    for axis in range(len(field.min)):
        off = max(gap, 0.5 * case.spacing if around[axis] else 0.0)
        low.append(max(field.min[axis], case.box.min[axis] + off))
        high.append(min(field.max[axis], case.box.max[axis] - off))
    return Region((*low, *[0.0][len(low) - 1 :]), (*high, *[1.0][len(high) - 1 :]))


def _body(case, field, number, one):
    """The body of a floe, which is to float."""
    from parsim.case.model import Body

    return Body(
        name=f"{field.name}_{number}",
        shape=shape_of(case, one.floe),
        density=field.density,
        position=(one.pose.x, one.pose.y, "float"),
        angles=(0.0, 0.0, round(math.degrees(one.pose.turn), 6)),
        velocity=getattr(field, "velocity", (0.0, 0.0, 0.0)),
        material=field.material,
    )


def _area(body):
    """Area of a floe in plan, m2; in 2D its length by the metre across."""
    return body.shape.volume / (2.0 * body.shape.half[2])
