"""Joints of bodies to the world: what exists is listed here."""

from parsim.case.types import choice
from parsim.solid.joints.drives import ScheduleTable, SteadyTable, SwayTable, SwingTable
from parsim.solid.joints.lock import LockTable
from parsim.solid.joints.pendulum import PendulumTable
from parsim.solid.joints.spring import SpringTable

JOINTS = (LockTable, SteadyTable, ScheduleTable, SwayTable, SwingTable, PendulumTable, SpringTable)
Joint = choice(*JOINTS)
