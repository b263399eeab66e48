"""The tables of a case about what touches: materials, pairs of them, the law."""

from typing import Annotated

import numpy as np
from pydantic import Field

from parsim.case.places import of_body
from parsim.case.types import LEAST, Name, NotNegative, Positive, Real, Share, Table, Whole
from parsim.errors import nearest, suggestion
from parsim.geometry.faces import period
from parsim.solid.laws import DEFAULT, Law


class Material(Table):
    """What contacts need to know of a material."""

    young: Positive = Field(description="Young's modulus, Pa")
    poisson: Real = Field(ge=0, lt=0.5, description="Poisson's ratio")
    friction: Real = Field(ge=0, le=10, description="coefficient of sliding friction")
    restitution: Real = Field(ge=LEAST, le=1, description="coefficient of restitution")
    rolling: Share = Field(0.0, description="coefficient of rolling friction, of what is round")
    crushing_strength: Positive | None = Field(
        None, description="pressure, Pa, at which what it touches with is crushed; left out: never"
    )
    roughness: NotNegative | None = Field(
        None, description="equivalent sand roughness ks of bodies of it in water, m; left out: water.friction.roughness"
    )


class Pair(Table):
    """What holds between two materials, where that is not the mean of theirs."""

    between: tuple[Name, Name] = Field(description="names of two materials, or of one twice")
    friction: Annotated[Real, Field(ge=0, le=10)] | None = Field(
        None, description="coefficient of sliding friction; left out: the mean of theirs"
    )
    restitution: Annotated[Real, Field(ge=LEAST, le=1)] | None = Field(
        None, description="coefficient of restitution; left out: the mean of theirs"
    )
    rolling: Share | None = Field(None, description="coefficient of rolling friction; left out: the mean of theirs")


class Contacts(Table):
    """How bodies touch each other, the walls and the gate."""

    law: Law = Field(DEFAULT, description="contact law")
    pairs: tuple[Pair, ...] = Field((), description="what holds between two materials")
    steps_per_contact: Annotated[Whole, Field(ge=5, le=10000)] = Field(20, description="steps in one contact, at least")


def faults(case):
    """Every material that is named exists, and every pair is given once."""
    uses = [(f"bodies.{body.name}.material", body.material) for body in case.bodies]
    if case.wall_material is not None:
        uses.append(("wall_material", case.wall_material))
    pairs = [tuple(sorted(pair.between)) for pair in case.contacts.pairs]
    uses += [(f"contacts.pairs.{i}.between", name) for i, pair in enumerate(pairs) for name in pair]
    twice = [
        f"contacts.pairs.{i}.between = {list(pair)}: is given already"
        for i, pair in enumerate(pairs)
        if pair in pairs[:i]
    ]
    timeless = [
        f"materials.{name}.crushing_strength = {material.crushing_strength!r}: contacts of the law "
        f'"{case.contacts.law.kind}" take no time and have no pressure; leave it out, or choose another law'
        for name, material in case.materials.items()
        if case.contacts.law.INSTANT and material.crushing_strength is not None
    ]
    return [*twice, *timeless] + [
        f'{key} = "{name}": {unknown_material(name, case.materials)}'
        for key, name in uses
        if name not in case.materials
    ]


def unknown_material(name, known):
    """Why a material is none, for the end of a message."""
    allowed = ", ".join(known) or "none, [materials.NAME] is missing"
    return f"no such material; allowed: {allowed}{suggestion(nearest(name, known))}"


def doubts(case):
    """What is allowed but doubtful in contacts: messages."""
    again = period(case)
    if not np.isfinite(again).any():
        return
    reach = np.array([of_body(body).reach for body in case.bodies]).reshape(-1, 3)
    for axis, along, length in zip("xyz", reach.T, again, strict=True):
        some = np.argsort(along)[-2:]
        if len(some) == 2 and (both := 2.0 * along[some].sum()) > length:
            one, two = (case.bodies[k].name for k in some[::-1])
            yield (
                f"bodies.{one}: with bodies.{two} {both:.4g} m long, more than the {length:.4g} m after which {axis} "
                "repeats; where both are level they touch through the nearer of their images only"
            )
