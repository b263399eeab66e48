"""Laws of what differs from floe to floe, size, thickness and aspect: their tables in a case, and what is drawn.

A law is drawn from by the inverse of its distribution, so that one even number from 0 to 1 gives one floe. Laws of size
may say by number or by area how much there is of a size D. By area, the shares of floes by number go with the law's
over D^d, with d = 2 and in a 2D case, where a floe covers a length, d = 1: `power`. Lengths in m.
"""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from statistics import NormalDist
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from parsim.case.messages import short
from parsim.case.types import CHOICE, LEAST, Moderate, Real, Share, Table, choice
from parsim.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

_SUM = 1e-3  # by which the sum of shares may be off one
_DECADES = 300.0  # over which a power may go: doubles have 308
_LEAST = 1e-6  # share of a law that its limits must leave


class LawTable(Table):
    """What every law is."""

    weight: Literal["number", "area"] = Field(
        "number", description="whether shares are of the number of floes or of the area that they cover; sizes only"
    )

    def completed(self) -> LawTable:
        """The same with what a file says. Raises InputError."""
        return self

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """What is wrong with it in a case of these dimensions: messages that begin with the key."""
        raise NotImplementedError

    def at(self, share: float, dimensions: int = 3) -> float:
        """The value that this share of all floes, by number, stays below."""
        return self._at(share, (dimensions - 1) * (self.weight == "area"))

    def _at(self, share: float, power: int) -> float:
        raise NotImplementedError


class Listed(LawTable):
    """Some values, each with its share."""

    kind: Literal["list"] = Field(description="some values, each with its share")
    values: tuple[Moderate, ...] = Field(description="values")
    shares: tuple[Share, ...] | None = Field(None, description="share of each, together 1; left out: the same of all")

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """See `LawTable`."""
        if not self.values:
            yield "values = []: must be at least one"
        elif self.shares is not None:
            yield from _faults_of_shares(self.shares, len(self.values), f"{len(self.values)} values")

    def _at(self, share: float, power: int) -> float:
        shares = self.shares or (1.0,) * len(self.values)
        return self.values[_chosen([s / v**power for s, v in zip(shares, self.values, strict=True)], share)[0]]


class Uniform(LawTable):
    """Even between two values."""

    kind: Literal["uniform"] = Field(description="even between two values")
    min: Moderate = Field(description="least value")
    max: Moderate = Field(description="largest value")

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """See `LawTable`."""
        yield from _faults_of_limits(self.min, self.max)

    def _at(self, share: float, power: int) -> float:
        return _power_law(share, self.min, self.max, power)


class Power(LawTable):
    """A density that goes with D^-exponent between two values."""

    kind: Literal["power"] = Field(description="a density that goes with a power of the value, cut at both ends")
    exponent: Annotated[Real, Field(ge=-20, le=20)] = Field(description="a: the density goes with D^-a")
    min: Moderate = Field(description="least value")
    max: Moderate = Field(description="largest value")

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """See `LawTable`."""
        yield from _faults_of_limits(self.min, self.max)
        if (abs(1.0 - self.exponent) + 2.0) * abs(math.log10(self.max / self.min)) > _DECADES:
            yield f"exponent = {self.exponent!r}: from {self.min!r} to {self.max!r} is more than numbers hold"

    def _at(self, share: float, power: int) -> float:
        return _power_law(share, self.min, self.max, self.exponent + power)


class Lognormal(LawTable):
    """A normal distribution of the logarithm, cut at both ends."""

    kind: Literal["lognormal"] = Field(description="a normal distribution of the logarithm, cut at both ends")
    median: Moderate = Field(description="median before it is cut")
    sigma: Annotated[Real, Field(ge=LEAST, le=5)] = Field(description="standard deviation of the natural logarithm")
    min: Moderate = Field(description="least value")
    max: Moderate = Field(description="largest value")

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """See `LawTable`."""
        yield from _faults_of_limits(self.min, self.max)
        low, high = self._shares((dimensions - 1) * (self.weight == "area"))
        if self.min <= self.max and high - low < _LEAST:
            yield (
                f"min, max: {self.min!r} to {self.max!r} leave less than a millionth of what has the median "
                f"{self.median!r} and sigma = {self.sigma!r}"
            )

    def _normal(self, power: int) -> NormalDist:
        """Of the logarithm, by number: over D^power it is the same with another median (Hatch & Choate 1929)."""
        return NormalDist(math.log(self.median) - power * self.sigma**2, self.sigma)

    def _shares(self, power: int) -> tuple[float, float]:
        return self._normal(power).cdf(math.log(self.min)), self._normal(power).cdf(math.log(self.max))

    def _at(self, share: float, power: int) -> float:
        low, high = self._shares(power)
        within = min(max(low + share * (high - low), 1e-15), 1.0 - 1e-15)
        return min(max(math.exp(self._normal(power).inv_cdf(within)), self.min), self.max)


class Histogram(LawTable):
    """Shares of classes; even within each."""

    kind: Literal["histogram"] = Field(description="shares of classes, even within each")
    weight: Literal["number", "area"] = Field(
        "area", description="whether shares are of the number of floes or of the area that they cover"
    )
    file: str | None = Field(
        None,
        description="CSV file of two columns, value and share: the share lies between the value of the line before "
        "and its own, that of the first line is 0",
    )
    edges: tuple[Moderate, ...] = Field((), description="ends of the classes, ascending, if there is no file")
    shares: tuple[Share, ...] = Field((), description="share of each class, together 1")

    def completed(self) -> Histogram:
        """See `LawTable`."""
        if self.file is None:
            return self
        if self.edges or self.shares:
            raise InputError(f"file = {short(self.file)}: edges and shares are given besides; give one of both")
        values, shares = _table(self.file)
        if shares[0] != 0.0:
            raise InputError(f"{self.file}: the share of the first line is {shares[0]:g}; must be 0, the first class "
                             "ends on the second line")  # fmt: skip
        if values.min() <= 0.0 or shares.min() < 0.0:
            raise InputError(f"{self.file}: values must be positive, and shares not negative")
        return self.model_copy(
            update={"file": None, "edges": tuple(values.tolist()), "shares": tuple(shares[1:].tolist())}
        )

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """See `LawTable`."""
        if len(self.edges) < 2:
            yield f"file, edges: {'one end is' if self.edges else 'none is'} given; a class has two"
        elif any(low >= high for low, high in itertools.pairwise(self.edges)):
            yield f"edges = {short(list(self.edges))}: must be ascending"
        else:
            yield from _faults_of_shares(self.shares, len(self.edges) - 1, f"{len(self.edges) - 1} classes")

    def _at(self, share: float, power: int) -> float:
        classes = list(itertools.pairwise(self.edges))
        parts = [s * _moment(a, b, power) / (b - a) for s, (a, b) in zip(self.shares, classes, strict=True)]
        number, rest = _chosen(parts, share)
        low, high = classes[number]
        return _power_law(rest, low, high, power)


class Ratio(Table):
    """A thickness that goes with the size."""

    kind: Literal["ratio"] = Field(description="goes with the size")
    ratio: Moderate = Field(description="thickness over size")
    min: Moderate | None = Field(None, description="least thickness, m; left out: none")
    max: Moderate | None = Field(None, description="largest thickness, m; left out: none")

    def completed(self) -> Ratio:
        """See `LawTable`."""
        return self

    def faults(self, dimensions: int = 3) -> Iterator[str]:
        """See `LawTable`."""
        if self.min is not None and self.max is not None:
            yield from _faults_of_limits(self.min, self.max)

    def of(self, size: float) -> float:
        """Thickness of a floe of this size, m."""
        return min(max(self.ratio * size, self.min or 0.0), self.max or math.inf)


class OrNumber:
    """Lets a number stand for the law by which all are alike."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """The law's own, after a number has become one."""
        from pydantic_core import core_schema

        return core_schema.no_info_before_validator_function(_as_law, handler(source))

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> Any:
        """A number or the law."""
        return {"anyOf": [{"type": "number"}, handler(core)]}


def _as_law(value):
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return {CHOICE: "list", "values": [value]} if number else value


LAWS = (Listed, Uniform, Lognormal, Power, Histogram)
Law: Any = Annotated[choice(*LAWS), OrNumber()]
Thickness: Any = Annotated[choice(*LAWS, Ratio), OrNumber()]


def _chosen(parts, share):
    """(the number of the part within which this share of all parts ends; how much of that part it takes)."""
    rest = share * sum(parts)
    for number, part in enumerate(parts):
        if rest < part:
            return number, rest / part
        rest -= part
    last = max(number for number, part in enumerate(parts) if part > 0.0)
    return last, 1.0


def _moment(low, high, power):
    """Integral of D^-power from `low` to `high`."""
    if power == 1:
        return math.log(high / low)
    return (high ** (1.0 - power) - low ** (1.0 - power)) / (1.0 - power)


def _power_law(share, low, high, power):
    """What has this share of a density that goes with D^-power, from `low` to `high`, below it."""
    ratio = high / low
    if abs(power - 1.0) < 1e-9:
        value = low * ratio**share
    else:
        value = low * (1.0 + share * (ratio ** (1.0 - power) - 1.0)) ** (1.0 / (1.0 - power))
    return min(max(value, low), high)


def _faults_of_limits(low, high):
    if low > high:
        yield f"min = {low!r}: must not be greater than max = {high!r}"


def _faults_of_shares(shares, number, what):
    if len(shares) != number:
        yield f"shares: {len(shares)} entries for {what}; must be as many"
    elif abs(sum(shares) - 1.0) > _SUM:
        yield f"shares = {short(list(shares))}: their sum is {sum(shares):.6g}; must be 1"


def _table(path):
    """Both columns of a CSV file, whose first line may name them. Raises InputError."""
    try:
        lines = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "is not a text file in UTF-8"
        raise InputError(f"file = {short(path)}: cannot be read: {reason}") from None
    rows = [(number, line.split(",")) for number, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    named = rows and not any(_number(cell) is not None for cell in rows[0][1])
    found = []
    for number, cells in rows[bool(named) :]:
        values = [_number(cell) for cell in cells]
        if len(values) != 2 or None in values:
            raise InputError(f"{path}: line {number} is {short(','.join(cells))}; must be two numbers, value and share")
        found.append(values)
    if len(found) < 2:
        raise InputError(f"{path}: has {len(found)} lines of numbers; a class takes two")
    return np.array(found).T


def _number(text):
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
