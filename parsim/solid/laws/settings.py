"""What a case may say of a law of contact: one table for each; what exists is listed at the end."""

from typing import Literal

from pydantic import Field

from parsim.case.types import Positive, Table, choice


class FoundationLaw(Table):
    """An elastic layer under every face in contact (`parsim.solid.laws.foundation`)."""

    kind: Literal["foundation"] = Field("foundation", description="an elastic layer under every face")
    depth: Positive | None = Field(
        None, description="depth of the elastic layer, m; left out: half the thinnest edge of any body"
    )


Law = choice(FoundationLaw)
