"""What the tables of a case file are made of. What may be chosen has its table beside its physics."""

from typing import Annotated, Literal, Union, get_args

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Strict, Tag, model_serializer, model_validator

Real = Annotated[float, Strict()]
Whole = Annotated[int, Strict()]
Number = Annotated[Real, Field(ge=-1e9, le=1e9)]
LEAST = 1e-30  # that counts as positive: over less than that nothing can be divided
Positive = Annotated[Real, Field(ge=LEAST, le=1e15)]
NotNegative = Annotated[Real, Field(ge=0, le=1e15)]
Share = Annotated[Real, Field(ge=0, le=1)]
Count = Annotated[Whole, Field(ge=1, le=10**9)]
Switch = Annotated[bool, Strict()]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$")]
Vector = tuple[Number, Number, Number]
Moderate = Annotated[Real, Field(ge=1e-9, le=1e9)]
Size = tuple[Moderate, Moderate, Moderate]
Place = tuple[Number, Number, Number | Literal["float"]]
CHOICE = "kind"  # the key that names which of several tables is meant
TAG = f"{CHOICE}="  # begins the steps that pydantic puts into a place for it


class Table(BaseModel):
    """A table of the case file: frozen, unknown keys refused, no silent conversion of types."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class ShortTable(Table):
    """A table that its `kind` alone may stand for, where that is all there is to say."""

    @model_validator(mode="before")
    @classmethod
    def _named(cls, value):
        return {CHOICE: value} if isinstance(value, str) else value

    @model_serializer(mode="wrap")
    def _short(self, handler):
        data = handler(self)
        return self.kind if all(value is None for key, value in data.items() if key != CHOICE) else data

    @classmethod
    def __get_pydantic_json_schema__(cls, core, handler):
        """The schema of the table or its name alone."""
        table = handler(core)
        table = table | {"required": sorted({CHOICE, *table.get("required", ())})}  # without it another may be meant
        return {"anyOf": [{"const": kind_of(cls), "type": "string"}, table]}


def kind_of(table):
    """The `kind` that a table model is."""
    return get_args(table.model_fields[CHOICE].annotation)[0]


def choice(*tables):
    """The annotation of a key that holds one of several tables, told apart by their `kind`.

    Where it is left out the first is meant, if its `kind` has a default.
    """
    if not tables[1:]:
        return tables[0]
    default = None if tables[0].model_fields[CHOICE].is_required() else kind_of(tables[0])
    short = issubclass(tables[0], ShortTable)

    def named(value):
        if isinstance(value, dict):
            kind = value.get(CHOICE, default)
        else:
            kind = getattr(value, CHOICE, value if short else None)
        return None if kind is None else TAG + str(kind)

    tagged = tuple(Annotated[table, Tag(TAG + kind_of(table))] for table in tables)
    return Annotated[Union[tagged], Discriminator(named)]  # noqa: UP007
