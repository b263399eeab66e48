"""Laws of contact: what exists is listed here, in the order of their numbers."""

from parsim.case.types import choice
from parsim.solid.laws.foundation import FoundationLaw
from parsim.solid.laws.hertz import HertzLaw
from parsim.solid.laws.impulse import ImpulseLaw
from parsim.solid.laws.spring import SpringLaw

LAWS = (FoundationLaw, HertzLaw, SpringLaw, ImpulseLaw)
Law = choice(*LAWS)
DEFAULT = FoundationLaw()
