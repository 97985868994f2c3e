"""Sections of a scene that change the law of its contacts, or add to it: one class each."""

from collections.abc import Mapping
from typing import Any

from roughmdr.stages.conduction import Conduction
from roughmdr.stages.nominal import Nominal
from roughmdr.stages.plasticity import Plasticity
from roughmdr.stages.reference import Reference
from roughmdr.stages.stage import Stage
from roughmdr.stages.tangential import Tangential
from roughmdr.stages.viscoelastic import Viscoelastic

STAGES: tuple[type[Stage], ...] = (Nominal, Plasticity, Viscoelastic, Tangential, Conduction, Reference)
"""All stages, innermost first: each makes its law from the law of the one before."""


def stages_in(table: Mapping[str, Any]) -> list[type[Stage]]:
    """Return the stages that a scene, as a table, has in any of its cells."""
    return [stage for stage in STAGES if stage.is_in(table)]
