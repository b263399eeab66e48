"""Bodies that stand in a case once and are many: on a lattice, each a body of its own."""

import itertools

from parsim.errors import InputError
from parsim.geometry.shuffle import swayed

MOST = 10**6


def every(case):
    """All bodies of a case, what repeats written out. Raises InputError for more than can be meant."""
    found = []
    for body in case.bodies:
        if body.repeat is None:
            found.append(body)
            continue
        (nx, ny, nz), afloat = body.repeat.count, body.position[2] == "float"
        if nx * ny * nz > MOST:
            raise InputError(f"bodies.{body.name}.repeat.count: {nx * ny * nz} bodies; at most {MOST}")
        if afloat and nz > 1:
            raise InputError(f'bodies.{body.name}.repeat.count: {nz} along z, but "float" gives all the same height')
        axes = case.axes if not afloat else [axis for axis in case.axes if axis != 2]
        for number, place in enumerate(itertools.product(range(nz), range(ny), range(nx)), 1):
            shift = [i * step for i, step in zip(reversed(place), body.repeat.step, strict=True)]
            for axis in axes:
                shift[axis] += body.repeat.disorder * float(swayed(3 * number + axis))
            position = [p if p == "float" else p + s for p, s in zip(body.position, shift, strict=True)]
            update = {"name": f"{body.name}_{number}", "position": tuple(position), "repeat": None}
            found.append(body.model_copy(update=update))
    return found
