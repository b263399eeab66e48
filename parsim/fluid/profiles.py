"""How the velocity of water varies over its depth at the start, as a share of its mean: one table for each profile."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from parsim.case.fill import TOUCH
from parsim.case.messages import short
from parsim.case.types import Moderate, Number, Real, Table, choice


class Linear(Table):
    """Linear from the bottom to the top."""

    kind: Literal["linear"] = Field(description="linear")
    bottom: Annotated[Real, Field(ge=0, le=2)] = Field(
        0.0, description="share at the bottom; at the top it is 2 less this"
    )

    def at(self, above, depth):
        """Velocity over its mean at heights `above` the bottom (n,), m, of water of this depth, m."""
        return self.bottom + 2.0 * (1.0 - self.bottom) * above / depth

    def faults(self, depth):
        """What is wrong with it in water of this depth, m: messages that begin with the key."""
        return []


class Log(Table):
    """Logarithmic: u ~ ln(30 z / ks) above a fully rough bed (Nikuradse 1933)."""

    kind: Literal["log"] = Field(description="logarithmic")
    roughness: Moderate = Field(description="roughness ks of the bed, m; u ~ ln(30 z / ks)")

    def at(self, above, depth):
        """As of `Linear`. The mean over the depth H is ln(30 H / ks) - 1 + ks / (30 H): nothing flows backward."""
        rough = self.roughness / 30.0
        return np.log(np.maximum(above / rough, 1.0)) / (math.log(depth / rough) - 1.0 + rough / depth)

    def faults(self, depth):
        """As of `Linear`."""
        if self.roughness < 10.0 * depth:
            return []
        return [f"roughness = {self.roughness!r}: must be less than ten depths of the fill, {10.0 * depth:.6g} m"]


class Tabled(Table):
    """Shares by height, linear between, the same beyond the first and the last."""

    kind: Literal["table"] = Field(description="a table of shares by height")
    heights: tuple[Number, ...] = Field(description="heights above the bottom of the fill, m, ascending")
    shares: tuple[Number, ...] = Field(description="shares of the mean at these heights")

    def at(self, above, depth):
        """As of `Linear`."""
        return np.interp(above, self.heights, self.shares)

    def faults(self, depth):
        """As of `Linear`."""
        found, heights = [], short(list(self.heights))
        ascending = all(low < high for low, high in zip(self.heights, self.heights[1:], strict=False))
        if len(self.heights) < 2 or not ascending:
            found.append(f"heights = {heights}: must be two or more, ascending")
        elif self.heights[0] < -TOUCH or self.heights[-1] > depth + TOUCH:
            found.append(f"heights = {heights}: must be heights in the fill, 0 to {depth:.6g} m above its bottom")
        if len(self.shares) != len(self.heights):
            found.append(f"shares: {len(self.shares)} entries for {len(self.heights)} heights; must be as many")
        return found


Profile = choice(Linear, Log, Tabled)
