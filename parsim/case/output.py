"""The tables of a case about what is written and shown."""

from pydantic import Field

from parsim.case.types import Number, Positive, Table
from parsim.observe.sensors import Sensor


class Output(Table):
    """What is written, and when."""

    frames: Positive = Field(0.05, description="time between frames, s")
    series: Positive = Field(0.005, description="time between rows of the series, s")
    sensors: tuple[Sensor, ...] = Field((), description="what is measured at places")
    checkpoints: Positive = Field(15.0, description="wall time between checkpoints, minutes; the last two are kept")
    milestones: Positive | None = Field(
        None, description="time between checkpoints that are kept for good, s; left out: none"
    )


class Report(Table):
    """What the page of a run shows; without times the thirds of the run."""

    snapshots: tuple[Number, ...] = Field((), description="times of the pictures, s")
    profiles: tuple[Number, ...] = Field((), description="times of the water's profiles, s")
    places: tuple[Number, ...] = Field((), description="times at which the places of the bodies are told, s")
    alike_until: Positive | None = Field(
        None, description="time until which repeated experiments are alike, s; left out: the end of the run"
    )
