"""All variables of datasets and files, declared once: name, unit and description."""
# ruff: noqa: F403  # a name is listed where it is declared, and nowhere else

from roughmdr.variables.asperity import *
from roughmdr.variables.attributes import *
from roughmdr.variables.law import *
from roughmdr.variables.run import *
from roughmdr.variables.variable import *
