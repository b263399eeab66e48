"""What the tables of a case file are made of. What may be chosen has its table in a file of its own, as its physics."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, Strict

Real = Annotated[float, Strict()]
Whole = Annotated[int, Strict()]
Number = Annotated[Real, Field(ge=-1e9, le=1e9)]
Positive = Annotated[Real, Field(gt=0, le=1e15)]
NotNegative = Annotated[Real, Field(ge=0, le=1e15)]
Share = Annotated[Real, Field(ge=0, le=1)]
Count = Annotated[Whole, Field(ge=1, le=10**9)]
Switch = Annotated[bool, Strict()]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$")]
Vector = tuple[Number, Number, Number]
Moderate = Annotated[Real, Field(ge=1e-9, le=1e9)]
Size = tuple[Moderate, Moderate, Moderate]
Place = tuple[Number, Number, Number | Literal["float"]]
Face = Literal["wall", "open", "periodic"]


class Table(BaseModel):
    """A table of the case file: frozen, unknown keys refused, no silent conversion of types."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
