"""Laws of contact: what exists is listed here, in the order of their numbers."""

from parsim.case.types import choice
from parsim.solid.laws.foundation import FoundationLaw

LAWS = (FoundationLaw,)
Law = choice(*LAWS)
DEFAULT = FoundationLaw()
