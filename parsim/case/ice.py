"""Ice in a case: the table of a field of floes at the start, and the bodies that it becomes. Lengths in m."""

import math
from typing import Annotated, Literal

from pydantic import Field

from parsim.case import ice_faults, places
from parsim.case.bodies import gate_box, placed
from parsim.case.ice_faults import floes_of, rectangle, shape_of, water_under
from parsim.case.plans import plan_of
from parsim.case.types import Count, Name, NotNegative, Number, Positive, Real, Table, Vector, Whole
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


class IceField(Table):
    """Floes afloat at rest or at one velocity in a rectangle, drawn from laws."""

    name: Name = Field(description="name; its floes are bodies NAME_1, NAME_2 and so on")
    min: Ends = Field(description="lowest corner of the rectangle in plan (x, y), m; in 2D (x)")
    max: Ends = Field(description="highest corner (x, y), m; in 2D (x)")
    concentration: Annotated[Real, Field(gt=0, le=0.9)] = Field(description="area of the floes over the rectangle's")
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
    velocity: Vector = Field((0.0, 0.0, 0.0), description="velocity at the start, m/s")
    seed: Annotated[Whole, Field(ge=0, lt=2**63)] = Field(0, description="another number gives other floes")
    floes: Count | None = Field(
        None, description="how many of the bodies are its floes; written with them, left out: none yet"
    )


class Ice(Table):
    """Ice."""

    fields: tuple[IceField, ...] = Field((), description="fields of floes at the start")


def with_floes(case):
    """(`case`, whose bodies have their places, with the floes of its fields among them, yet to float; messages)."""
    if not case.ice.fields:
        return case, []
    faults, fields, made, taken = ice_faults.names(case), [], [], None
    for given in case.ice.fields:
        try:
            field, wrong = ice_faults.read(given)
            wrong = wrong or list(ice_faults.wrong(case, field))
            if not wrong and field.floes is None:
                if taken is None:
                    taken = [*map(places.of_body, placed(case)), *([gate_box(case)] if case.gate else [])]
                found, field = _spread(case, field, taken, made)
                made.append(found)
        except InputError as error:
            field, wrong = given, error.messages
        faults += [f"ice.fields.{given.name}.{text}" for text in wrong]
        fields.append(field)
    new = [body for _, bodies in made for body in bodies]
    ice = case.ice.model_copy(update={"fields": tuple(fields)})
    return case.model_copy(update={"bodies": (*case.bodies, *new), "ice": ice}), faults


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
    return lines


def doubts(case):
    """What is allowed but doubtful in the fields of a checked case: messages."""
    for field in case.ice.fields if case.water.scheme.WET else ():
        widths = [2.0 * body.shape.thinnest(case.dimensions == 2) for body in floes_of(case, field)]
        few = [width for width in widths if round(width / case.spacing) < 4]
        if few:
            yield (
                f"ice.fields.{field.name}: {len(few)} of {len(widths)} floes have fewer than four particles across "
                f"their thinnest side, {min(few):.6g} m at least; four or more give usable loads"
            )


def _spread(case, field, taken, made):
    """(what the floes take of the plan, their bodies), and the field that says how many. Raises InputError."""
    bottom, level = water_under(case, field)
    gap = GAP * case.spacing if field.gap is None else field.gap
    laws = Laws(field.shape, field.size, field.thickness, field.aspect or SQUARE, case.dimensions)
    asked, region = field.concentration * rectangle(field), _region(case, field, gap)
    floes = covering(asked, field.seed, stream_of(f"ice.fields.{field.name}"), laws)
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
        velocity=field.velocity,
        material=field.material,
    )


def _area(body):
    """Area of a floe in plan, m2; in 2D its length by the metre across."""
    return body.shape.volume / (2.0 * body.shape.half[2])
