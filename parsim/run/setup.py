"""From a case to its models: the only place where they are built."""

from parsim.boundary.gate import Gate, GateSamples
from parsim.boundary.wall import Walls
from parsim.coupling.films import Films
from parsim.coupling.samples import BodySamples
from parsim.domain.domain import Domain
from parsim.domain.grid import grid_of, layers_of, reach_of
from parsim.fluid.wcmps.scheme import WCMPS
from parsim.particles.neighbours import Neighbours
from parsim.solid.bodies import from_case
from parsim.solid.contacts import Contacts

_ROOM = 1.03  # length of the neighbour rows over that of the full lattice


class Models:
    """The models of one case, as attributes: scheme, bodies, contacts, gate, samples, films, domain, near."""

    def __init__(self, case, comm, timers):
        layers, self.reach = layers_of(case), reach_of(case)
        self.scheme = WCMPS(case, timers)
        self.bodies = from_case(case)
        self.contacts = Contacts(self.bodies, case)
        self.samples = BodySamples(case, self.bodies, layers)
        self.films = Films(case, self.bodies, self.samples, self.scheme.lattice)
        self.walls = Walls(case, layers)
        self.gate = Gate(case) if case.gate is not None else None
        self.gate_samples = GateSamples(case, self.gate, layers) if self.gate else None
        sources = [s for s in (self.samples, self.gate_samples, self.walls) if s is not None]
        self.domain = Domain(grid_of(case), comm, sources, timers=timers)
        share = (1.0 + case.run.skin / case.water.support) ** case.dimensions
        self.near = Neighbours(self.scheme.lattice.count * share * _ROOM)
