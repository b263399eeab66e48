"""Small cases with fields of ice, in 3D and in 2D."""

FIELD = {
    "name": "ice",
    "min": [0.0, 0.0],
    "max": [2.4, 1.0],
    "concentration": 0.5,
    "shape": "polygon",
    "size": {"kind": "uniform", "min": 0.1, "max": 0.3},
    "thickness": 0.06,
    "density": 900.0,
    "material": "ice",
    "velocity": [0.1, 0.0, 0.0],
    "seed": 2,
}
BASIN = {
    "dimensions": 3,
    "spacing": 0.02,
    "box": {"max": [2.4, 1.0, 0.4]},
    "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [2.4, 1.0, 0.2]}]},
    "materials": {"ice": {"young": 1e7, "poisson": 0.3, "friction": 0.1, "restitution": 0.3}},
    "run": {"until": 0.1},
}


def field(**changes):
    """A field of ice; a change to None leaves the key out."""
    return {key: value for key, value in (FIELD | changes).items() if value is not None}


def basin(*fields, gate=False, **changes):
    """A basin with these fields, and a gate in its middle if wanted."""
    stood = {"gate": {"min_x": 1.3, "max_x": 1.34}} if gate else {}
    return BASIN | stood | changes | {"ice": {"fields": list(fields)}}


def plane(changes, **more):
    """A plane, 2 m long, with a field of ice all along it."""
    own = field(min=[0.0], max=[2.0], shape="box", size={"kind": "uniform", "min": 0.05, "max": 0.15}) | changes
    box = {"max": [2.0, 1.0, 0.4]}
    water = {"fill": [{"min": [0.0, 0.0, 0.0], "max": [2.0, 1.0, 0.2]}]}
    return basin(own, dimensions=2, box=box, water=water, **more)
