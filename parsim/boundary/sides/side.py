"""What every side of the box is."""

from typing import ClassVar

from parsim.case.types import ShortTable


class SideTable(ShortTable):
    """What a case may say of a side.

    holds_water, holds_bodies: whether it is a wall to them; repeats: whether the box begins again beyond it; continues:
    whether the walls beside it go on beyond it. What is neither held nor repeated leaves the box there.
    """

    holds_water: ClassVar[bool] = False
    holds_bodies: ClassVar[bool] = False
    repeats: ClassVar[bool] = False
    continues: ClassVar[bool] = False
