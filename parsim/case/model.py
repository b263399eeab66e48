"""A case: everything one run is made from, typed, checked and frozen.

`load` reads a TOML file; what it returns is complete: every default is filled in, and `Case.to_toml` writes a file
that loads back equal. SI units; angles in degrees; x downstream, y across, z up. A 2D case is the x-z plane and one
metre wide: its box, fills and bodies reach from y = 0 to y = 1.
"""

import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from parsim.boundary.sides import OPEN, WALL, Side
from parsim.case.bed import Bed, body_of
from parsim.case.channel import Channel
from parsim.case.checks import checked, doubts
from parsim.case.contacts import Contacts, Material
from parsim.case.file import locate, read, replaced, written
from parsim.case.friction import Eddies, Friction
from parsim.case.ice import Ice
from parsim.case.measure import Measure
from parsim.case.messages import validated
from parsim.case.motion import Motion
from parsim.case.output import Output, Report
from parsim.case.types import (
    LEAST,
    Count,
    Moderate,
    Name,
    NotNegative,
    Number,
    Place,
    Positive,
    Real,
    Switch,
    Table,
    Vector,
)
from parsim.fluid import DEFAULT, Scheme
from parsim.fluid.profiles import Profile
from parsim.solid.joints import Joint
from parsim.solid.shapes import Shape


class Faces(Table):
    """What each side of the box is. A 2D case has no y faces."""

    x_min: Side = Field(WALL, description="upstream side")
    x_max: Side = Field(WALL, description="downstream side")
    y_min: Side = Field(WALL, description="side at small y; 3D only")
    y_max: Side = Field(WALL, description="side at large y; 3D only")
    z_min: Side = Field(WALL, description="floor")
    z_max: Side = Field(OPEN, description="top")


class Box(Table):
    """The box that holds everything; its faces are where walls stand."""

    min: Vector = Field((0.0, 0.0, 0.0), description="lowest corner, m; in 2D y = 0")
    max: Vector = Field(description="highest corner, m; in 2D y = 1")
    faces: Faces = Field(Faces(), description="what each side of the box is")

    @property
    def size(self):
        """Edge lengths (x, y, z), m."""
        return tuple(high - low for low, high in zip(self.min, self.max, strict=True))


class Fill(Table):
    """A box of water at the start; bodies and the gate are cut out of it."""

    min: Vector = Field(description="lowest corner, m")
    max: Vector = Field(description="highest corner, m; its z is the water level, floating bodies included")
    velocity: Vector = Field((0.0, 0.0, 0.0), description="velocity at t = 0, m/s; of a profile its mean")
    profile: Profile | None = Field(
        None, description="how the velocity varies over the depth, as a share of its mean; left out: not at all"
    )


class Water(Table):
    """The water, and the scheme that moves it."""

    scheme: Scheme = Field(DEFAULT, description="the scheme that moves it")
    density: Positive = Field(1000.0, description="density, kg/m3")
    viscosity: NotNegative = Field(1e-6, description="kinematic viscosity, m2/s")
    speed: Moderate | None = Field(
        None, description="largest expected speed, m/s; left out: 2 sqrt(g H), H the greatest depth of the fill"
    )
    friction: Friction | None = Field(None, description="how walls and bodies rub it; left out: not at all")
    eddies: Eddies | None = Field(None, description="eddy viscosity; left out: none")
    disorder: Annotated[Real, Field(ge=0, le=0.5)] = Field(
        0.0, description="how far particles are off the lattice at the start, at most, over the spacing"
    )
    pressure: Literal["hydrostatic", "zero"] = Field("hydrostatic", description="pressure at the start")
    fill: tuple[Fill, ...] = Field((), description="boxes of water at the start")


class Repeat(Table):
    """Many bodies alike, on a lattice; each is then a body of its own, its name with a number from 1."""

    count: tuple[Count, Count, Count] = Field(description="how many along x, y and z")
    step: Vector = Field(description="distances along x, y and z, m")
    disorder: NotNegative = Field(0.0, description="how far each is off its place along each axis, at most, m")


class Body(Table):
    """A rigid body. Exactly one of density and mass is given."""

    name: Name = Field(description="name, used in results: a letter, then letters, digits, _ or -")
    shape: Shape = Field(description="shape")
    density: Positive | None = Field(None, description="density, kg/m3")
    mass: Positive | None = Field(None, description="mass, kg; in 2D kg per metre of width")
    position: Place = Field(description='centre, m; "float" as z floats the body at its draught in the fill under it')
    angles: Vector = Field((0.0, 0.0, 0.0), description="turned about the x, then the y, then the z axis, degrees")
    velocity: Vector = Field((0.0, 0.0, 0.0), description="velocity of the centre at the start, m/s")
    spin: Vector = Field((0.0, 0.0, 0.0), description="angular velocity at the start, global axes, rad/s")
    material: Name = Field(description="name of its material")
    fixed: Switch = Field(False, description="never moves")
    released: Number | None = Field(None, description="held in place before this time, s; left out: never held")
    repeat: Repeat | None = Field(None, description="many of them on a lattice; left out: one")
    enters: Switch = Field(False, description="a floe of a supply, which waits to come in; written with ice.supplies")


class Gate(Table):
    """A plate across the whole box that rises at constant speed."""

    min_x: Number = Field(description="upstream face, m")
    max_x: Number = Field(description="downstream face, m")
    bottom: Number | None = Field(None, description="lower edge while closed, m; left out: the floor")
    speed: NotNegative = Field(0.4, description="upward speed once it opens, m/s")
    opens: Number = Field(0.0, description="time at which it starts to rise, s")


class Run(Table):
    """How long and in what steps."""

    until: Positive = Field(description="end time, s")
    settle: NotNegative = Field(0.0, description="length of damped motion before t = 0, s")
    cfl: Real = Field(1.0, ge=LEAST, le=1.75, description="time step over spacing / (speed of sound + largest speed)")
    skin: Real = Field(0.4, ge=LEAST, le=2, description="margin of the neighbour lists over the spacing")
    rebuild_at_most: Count = Field(20, description="steps between rebuilds of the neighbour lists, at most")
    outside: Literal["remove", "stop"] = Field(
        "remove", description="what becomes of water and bodies that leave the box"
    )
    patience: Positive = Field(600.0, description="wall time without progress after which a rank is taken for hung, s")
    balance_every: Count = Field(1, description="rebuilds between looks at the balance of the ranks")


class Case(Table):
    """A complete case."""

    title: str = Field("", description="one line for people")
    dimensions: Literal[2, 3] = Field(description="2 (the x-z plane, one metre wide) or 3")
    spacing: Real = Field(  # None only until it is completed
        None,
        ge=1e-6,
        le=1e6,
        description="particle spacing l0, m; must divide the box; without water half the thinnest body if left out",
    )
    gravity: Vector = Field((0.0, 0.0, -9.81), description="gravity, m/s2")
    gravity_ramp: NotNegative = Field(
        0.0, description="time from 0 on in which gravity grows from nothing, s; of a case without water"
    )
    wall_material: Name | None = Field(None, description="material of walls and gate; left out: the first material")
    box: Box = Field(description="the box that holds everything")
    water: Water = Field(Water(), description="the water and its scheme")
    bed: Bed | None = Field(None, description="ground from a file over the whole box; left out: none")
    channel: Channel | None = Field(None, description="a discharge that is held between periodic sides; left out: none")
    motion: Motion | None = Field(
        None, description="how the box moves; all else is seen from the box; left out: it stands"
    )
    gate: Gate | None = Field(None, description="a plate that rises; left out: none")
    contacts: Contacts = Field(Contacts(), description="how bodies touch")
    run: Run = Field(description="how long and in what steps")
    output: Output = Field(Output(), description="what is written, and when")
    report: Report = Field(Report(), description="what the page of the run shows")
    measure: Measure | None = Field(None, description="what is measured of a river with ice; left out: nothing")
    materials: dict[Name, Material] = Field({}, description="materials by name")
    bodies: tuple[Body, ...] = Field((), description="rigid bodies")
    ice: Ice = Field(Ice(), description="floes by laws")
    joints: tuple[Joint, ...] = Field((), description="what ties bodies to the world")

    @property
    def start(self):
        """Time of the first step, s: the settling runs before t = 0."""
        return 0.0 - self.run.settle

    @property
    def depth(self):
        """Greatest depth of the fill above the floor of the box, m; 0 without fill."""
        return max((0.0, *(fill.max[2] - self.box.min[2] for fill in self.water.fill)))

    @property
    def speed(self):
        """Largest expected speed, m/s: `water.speed`, else 2 sqrt(g H) (Amaro et al. 2021)."""
        if self.water.speed is not None:
            return self.water.speed
        return 2.0 * math.sqrt(math.hypot(*self.gravity) * self.depth)

    @property
    def sound_speed(self):
        """Speed of sound of the water model, c0, m/s; inf without water."""
        return self.water.scheme.sound_speed(self.speed)

    @property
    def layers(self):
        """Layers of boundary particles that fill the support."""
        return math.ceil(self.water.scheme.support)

    @property
    def reach(self):
        """Radius of the neighbour lists, m."""
        return (self.water.scheme.support + self.run.skin) * self.spacing

    @property
    def width(self):
        """Width of the box across, m; a metre in 2D."""
        return 1.0 if self.dimensions == 2 else self.box.size[1]

    @property
    def axes(self):
        """Indices of the axes along which things move: (0, 1, 2), in 2D (0, 2)."""
        return (0, 2) if self.dimensions == 2 else (0, 1, 2)

    def with_bed(self):
        """(the same with its bed among the bodies, messages)."""
        if self.bed is None:
            return self, []
        keys, faults = body_of(self)
        bodies = (*self.bodies, Body(**keys)) if keys else self.bodies
        return self.model_copy(update={"bodies": bodies, "bed": None}), faults

    def mass_of(self, body):
        """Mass of one of `bodies`, kg (2D: per metre of width)."""
        return body.density * body.shape.volume if body.mass is None else body.mass

    def density_of(self, body):
        """Density of one of `bodies`, kg/m3."""
        return body.mass / body.shape.volume if body.density is None else body.density

    def warnings(self):
        """What is allowed but doubtful: a list of messages."""
        return doubts(self)

    def to_toml(self):
        """The complete case as a TOML text that loads back equal; keys without a value are left out."""
        return written(self.model_dump(exclude_none=True))


def load(path, overrides=()):
    """Read, complete and check a case file.

    `overrides` are texts "key.path=value", list entries addressed by number or by name (bodies.A1.density=900).
    Raises InputError with every fault found.
    """
    data = replaced(read(Path(path)), overrides)
    data.pop("study", None)  # varies cases and is part of none
    locate(data, Path(path).parent)
    return parse(data)


def parse(data):
    """A complete, checked case from the nested dict of a case file. Raises InputError with every fault found."""
    return checked(*validated(Case, data))


def schema():
    """JSON schema of a case file, a dict."""
    described = Case.model_json_schema()
    described["properties"]["extends"] = {"type": "string", "description": "case file this one adds to (relative path)"}
    described["anyOf"] = [{"required": ["extends"]}, {"required": described.pop("required")}]
    return described
