"""The table [bed] of a case: ground from a file over the whole box, which becomes a fixed body."""

import re

from pydantic import Field

from parsim.case.fill import TOUCH
from parsim.case.types import Moderate, Name, Number
from parsim.solid.shapes.bed import BedShape
from parsim.terrain.frame import along
from parsim.terrain.place import Ground

NAME, DENSITY = "bed", 2650.0  # of the body; that of rock, kg/m3, for a body that never moves
Point = tuple[Number, Number]


class Bed(Ground):
    """Ground over the whole box; the completed case has it among its bodies, as the fixed body "bed"."""

    axis: tuple[Point, Point] | None = Field(
        None, description="two places in the file, in place of origin and angle: x runs from the first to the second"
    )
    resolution: Moderate | None = Field(None, description="distance between its heights, m; left out: the spacing")
    material: Name | None = Field(None, description="name of its material; left out: that of the walls")


def body_of(case):
    """(the keys of the body that the bed of a case is, messages): one of them is empty."""
    bed, key = case.bed, f'bed.file = "{case.bed.file}"'
    faults = list(_faults(case))
    if faults:
        return {}, faults
    place = {name: getattr(bed, name) for name in Ground.model_fields}
    if bed.axis:
        place["origin"], place["angle"] = along(*bed.axis)
    shape = BedShape(
        kind="bed", low=case.box.min, high=case.box.max[:2], resolution=bed.resolution or case.spacing, **place
    )
    wrong = [re.sub("^shape(.file)?: ", "", text) for text in shape.faults(False)]
    if not wrong and (most := float(shape.heights.z.max())) > case.box.max[2] + TOUCH:
        wrong = [f"its ground reaches up to z = {most:.6g} m, the box to {case.box.max[2]:g}; change box.max or datum"]
    if wrong:
        return {}, [f"{key}: {text}".replace(": shape.", ": bed.") for text in wrong]
    material = bed.material or case.wall_material or next(iter(case.materials), "")
    body = {"name": NAME, "shape": shape, "density": DENSITY, "position": shape.centre, "material": material}
    return body | {"fixed": True}, []


def _faults(case):
    """What is wrong before anything is read: messages."""
    low, high, bed, faces = case.box.min, case.box.max, case.bed, case.box.faces
    if case.dimensions == 2:
        yield "bed: a 2D case has none; a polygon that is fixed is one"
    if case.spacing is None and bed.resolution is None:
        yield "bed.resolution: missing; distance between its heights, m; required in a case without a spacing"
    if not (low[0] < high[0] and low[1] < high[1]):
        yield "bed: the box is empty"
    if bed.axis and ({"origin", "angle"} & bed.model_fields_set):
        yield "bed.axis: stands in place of bed.origin and bed.angle; give one or the other"
    if bed.axis and bed.axis[0] == bed.axis[1]:
        yield f"bed.axis = {[list(place) for place in bed.axis]}: must be two places"
    if bed.material is None and not case.materials:
        yield "bed.material: missing; a bed needs a material, and there is none, [materials.NAME] is missing"
    repeated = [name for name in ("x_min", "y_min") if getattr(faces, name).repeats]
    if repeated:
        yield f'bed: ends at the sides of the box; box.faces.{repeated[0]} = "periodic" cannot be with it'


def faults(case):
    """What is wrong with bodies that are beds: messages. They stand where their table says, and never move."""
    for body in case.bodies:
        if isinstance(body.shape, BedShape):
            if not body.fixed or any(body.angles):
                yield f"bodies.{body.name}: a bed must be fixed = true, with angles = [0.0, 0.0, 0.0]"
            elif max(abs(a - b) for a, b in zip(body.position, body.shape.centre, strict=True)) > TOUCH:
                yield (
                    f"bodies.{body.name}.position = {list(body.position)}: must be the middle of its floor, "
                    f"{list(body.shape.centre)}"
                )


def doubts(case):
    """What is allowed but doubtful in beds: messages."""
    for body in case.bodies:
        if isinstance(body.shape, BedShape):
            key = f'{body.name}: "{body.shape.file}"'
            if body.shape.told_of_filling:
                yield f"{key}: {body.shape.told_of_filling}"
            if (off := body.shape.coarse()) is not None:
                yield (
                    f"{key}: between heights {body.shape.resolution:g} m apart the ground of the file differs by up to "
                    f"{off:.3g} m from the bed; the spacing does not resolve its features"
                )
