"""What a case says of ground from a file: which, and where it lies in the case."""

from typing import Literal

from pydantic import Field

from parsim.case.types import Moderate, Number, Table
from parsim.terrain.frame import Frame


class Ground(Table):
    """Ground from a file, and where it lies in the case."""

    file: str = Field(
        description="heights: ESRI ASCII .asc, GeoTIFF .tif, points .xyz .txt .csv, triangles .stl, HEC-RAS sections "
        ".g01 to .g99; a path from where the case is"
    )
    scale: Moderate = Field(1.0, description="length, m, of one unit of the file: 0.3048 for feet")
    origin: tuple[Number, Number] = Field(
        (0.0, 0.0), description="the place in the file, in its units, that is x = y = 0 in the case"
    )
    angle: Number = Field(
        0.0, description="by which the x axis of the case is turned from that of the file, anticlockwise, degrees"
    )
    datum: Number = Field(0.0, description="the height in the file, in its units, that is z = 0 in the case")
    nodata: Literal["refuse", "nearest", "linear"] = Field(
        "refuse", description="what becomes of places without a height: refused, or filled from those around"
    )
    layout: Literal["straight", "map"] = Field(
        "straight",
        description="of sections: x along the channel from the first one, y to the left from the middle between the "
        "banks; or where their cut lines lie on the map",
    )
    river_reach: str | None = Field(
        None, description='of sections: "River, Reach", which to take; left out: the only one of the file'
    )

    @property
    def frame(self) -> Frame:
        """The `Frame` of the case in the file."""
        return Frame(self.origin, self.angle, self.datum, self.scale)
