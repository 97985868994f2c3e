"""Count the equilibria that the kernels evaluate to find one contact, while they run as plain Python.

    NUMBA_DISABLE_JIT=1 PYTHONPATH=pipelines python -m studies.stability.counting COUNT

Prints a JSON list: for each of the first COUNT cases, under JKR and under Dugdale adhesion, how many are evaluated to
find the contact and how many to set up its asperity; null where that is refused. Without adhesion none is.
"""

import json
import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from types import FrameType

import numpy as np

import roughmdr as rm
from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.closed import jkr_power
from roughmdr.kernels.dugdale import equilibrium
from studies.stability.cases import Case, design

EQUILIBRIUM = {"jkr": jkr_power._distance.__name__, "dugdale": equilibrium.state_along.__name__}
"""The kernel that evaluates an equilibrium, by adhesion model."""
Counts = list[list[list[int] | None]]


def start(count: int) -> "subprocess.Popen[str]":
    """Start counting in a process of its own, in which nothing is compiled."""
    command = [sys.executable, "-W", "ignore", "-m", __name__, str(count)]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)


def finish(process: "subprocess.Popen[str]") -> Counts:
    """Wait for a process that counts and return its counts."""
    printed, _ = process.communicate()
    if process.returncode:
        raise RuntimeError("counting failed")
    return list(json.loads(printed))


def calls(kernel: str, action: Callable[[], object]) -> int:
    """Return how often a kernel is called during ``action``."""
    count = 0

    def profiler(frame: FrameType, event: str, _: object) -> None:
        nonlocal count
        count += event == "call" and frame.f_code.co_name == kernel

    sys.setprofile(profiler)
    try:
        action()
    finally:
        sys.setprofile(None)
    return count


def evaluations(case: Case, model: str) -> list[int] | None:
    """Return the equilibria evaluated for the first asperity of a case: to find its contact, and to set it up."""
    shape, contacts = case.shapes()[0], list[Contact]()
    try:
        strength = case.tabor / rm.tabor(shape, effective_modulus=case.effective_modulus, work=case.work, strength=1.0)
        adhesion = Adhesion.checked("dugdale" if model == "dugdale" else "jkr", case.work, strength)
        set_up = calls(EQUILIBRIUM[model], lambda: contacts.append(Contact.of(shape, case.effective_modulus, adhesion)))
    except rm.RoughmdrError:
        return None
    (contact,) = contacts
    return [calls(EQUILIBRIUM[model], lambda: contact.law.state(case.distance, contact.params)), set_up]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    with np.errstate(all="ignore"):
        found = [[evaluations(case, model) for model in EQUILIBRIUM] for case in design(int(sys.argv[1]))]
    sys.stdout.write(json.dumps(found))
