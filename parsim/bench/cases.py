"""The cases of the benchmark, as nested dicts of a case file."""

from typing import Any

_WOOD = {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}


def still_water(count: int, support: float) -> dict[str, Any]:
    """A cube of about `count` particles of water at rest in a tank."""
    edge, l0 = round(count ** (1 / 3)), 0.01
    size = round(edge * l0, 9)
    return _case(support, l0, [size, size, round(size + 5 * l0, 9)], [{"min": [0.0, 0.0, 0.0], "max": [size] * 3}])


def sea(count: int, support: float) -> dict[str, Any]:
    """About `count` particles of water at rest, 24 deep, without sides: the same mixture of particles at any size."""
    deep, l0 = 24, 0.01
    size = [round(round((count / deep) ** 0.5) * l0, 9)] * 2
    case = _case(support, l0, [*size, (deep + 5) * l0], [{"min": [0.0, 0.0, 0.0], "max": [*size, deep * l0]}])
    case["box"]["faces"] = {f"{axis}_{side}": "periodic" for axis in "xy" for side in ("min", "max")}
    return case


def dam_break(
    spacing: float, support: float, speed: float = 0.0, length: float = 0.15, section: float = 0.15
) -> dict[str, Any]:
    """Water, `length` long and `section` high and wide (m), that runs down a tank; `speed`, m/s, is its first one."""
    column = {"min": [0.0, 0.0, 0.0], "max": [length, section, section], "velocity": [speed, 0.0, 0.0]}
    return _case(support, spacing, [0.75, section, 0.3], [column])


def floating_blocks(spacing: float, support: float) -> dict[str, Any]:
    """Four blocks on 15 cm of water behind a gate that rises: the ice release of Amaro et al. (2021), case 1."""
    case = _case(support, spacing, [0.7, 0.15, 0.3], [{"min": [0.0, 0.0, 0.0], "max": [0.15, 0.15, 0.15]}])
    case["gate"] = {"min_x": 0.15, "max_x": 0.155}
    case["materials"] = {"wood": _WOOD}
    case["bodies"] = [
        {
            "name": f"block_{row}{column}",
            "shape": {"size": [0.0725, 0.0725, 0.0195]},
            "mass": 0.089,
            "material": "wood",
            "position": [0.038 + 0.074 * column, 0.038 + 0.074 * row, "float"],
        }
        for row in (0, 1)
        for column in (0, 1)
    ]
    return case


def heap(edge: int) -> dict[str, Any]:
    """Balls without water, `edge` x `edge` x 5/4 `edge` of them, that fall a little and come to rest as a heap."""
    size, step = 0.05, 0.0506
    count = [edge, edge, edge + edge // 4]
    high = round(1.3 * count[2] * step, 9)
    body = {"name": "ball", "shape": {"kind": "sphere", "diameter": size}, "density": 900.0, "material": "soft"}
    lattice = {"count": count, "step": [step] * 3, "disorder": 0.005 * size}
    return {
        "dimensions": 3,
        "box": {"max": [round(edge * step + 0.0004, 9)] * 2 + [high]},
        "materials": {"soft": _WOOD | {"restitution": 0.3}},
        "contacts": {"law": {"kind": "spring", "stiffness": 3e4}},
        "bodies": [body | {"position": [0.5 * step] * 3, "repeat": lattice}],
        "output": {"series": 0.1},
        "run": {"until": 100.0},
    }


def _case(support, spacing, size, fill):
    return {
        "dimensions": 3,
        "spacing": spacing,
        "box": {"max": size},
        "run": {"until": 100.0},
        "water": {"scheme": {"support": support}, "fill": fill},
    }
