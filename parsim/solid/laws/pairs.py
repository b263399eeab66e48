"""What a law of contact needs of every pair of materials."""

import math

import numpy as np

from parsim.solid.laws.law import damping_of


def law_of_pairs(case, bodies):
    """Table (6, n, n) over pairs of materials: what the law needs of them; damping ratio, of hard bodies
    restitution; friction; shear; rolling friction; pressure at which the weaker of them is crushed, Pa.

    Restitution and friction of a pair are those given for it, else the means of the two (Canelas et al. 2016, doi
    10.1016/j.cpc.2016.05.003).
    """
    each, names = list(case.materials.values()), list(case.materials)
    least = thinnest(bodies) if len(bodies) else 1.0
    given = {frozenset(pair.between): pair for pair in case.contacts.pairs}
    law = np.zeros((6, len(each), len(each)))
    for i, one in enumerate(each):
        for j, two in enumerate(each):
            law[0, i, j] = case.contacts.law.of_pair(one, two, least)
            pair = given.get(frozenset((names[i], names[j])))
            restitution = _of_pair("restitution", one, two, pair)
            law[1, i, j] = restitution if case.contacts.law.INSTANT else damping_of(restitution)
            law[2, i, j] = _of_pair("friction", one, two, pair)
            law[3, i, j] = case.contacts.law.shear(one, two)
            law[4, i, j] = _of_pair("rolling", one, two, pair)
            law[5, i, j] = min(one.crushing_strength or math.inf, two.crushing_strength or math.inf)
    return law


def thinnest(bodies):
    """Half the least width of any body, m."""
    return min(shape.thinnest(bodies.planar) for shape in bodies.shapes)


def _of_pair(key, one, two, pair):
    """What is given for a pair of materials, else the mean of the two."""
    own = getattr(pair, key) if pair else None
    return 0.5 * (getattr(one, key) + getattr(two, key)) if own is None else own
