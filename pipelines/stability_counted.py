"""How many equilibria the kernels try to find one contact, counted while they run as plain Python.

    NUMBA_DISABLE_JIT=1 python pipelines/stability_counted.py COUNT

Prints a JSON list: for each of the first cases of ``stability.py`` how many under JKR and under Dugdale adhesion, where
the contact is sought and where its asperity is set up; null where that is refused. Without adhesion none is tried.
"""

import json
import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import numpy as np
from stability_cases import Case, design

import roughmdr as rm
from roughmdr.asperity.contact import Contact
from roughmdr.kernels.adhesion import Adhesion

TRIALS = {"jkr": "_distance", "dugdale": "along"}
"""The kernel that makes an equilibrium of a state, by law."""
Counts = list[list[list[int] | None]]


def started(count: int) -> "subprocess.Popen[str]":
    """The count in a process of its own, where nothing is compiled."""
    command = [sys.executable, "-W", "ignore", str(Path(__file__)), str(count)]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)


def finished(process: "subprocess.Popen[str]") -> Counts:
    """What it printed."""
    printed, _ = process.communicate()
    if process.returncode:
        raise RuntimeError("counting failed")
    return list(json.loads(printed))


def calls(kernel: str, work: Callable[[], object]) -> int:
    """How often a kernel is called in the course of ``work``."""
    found = 0

    def seen(frame: FrameType, event: str, argument: object) -> None:
        nonlocal found
        found += event == "call" and frame.f_code.co_name == kernel

    sys.setprofile(seen)
    try:
        work()
    finally:
        sys.setprofile(None)
    return found


def counted(case: Case, law: str) -> list[int] | None:
    """Equilibria tried for the first asperity of a case: at its distance to the fold, and to set it up."""
    shape, asked = case.shapes()[0], {"effective_modulus": case.stiffness, "work": case.work}
    try:
        strength = case.tabor / rm.tabor(shape, **asked, strength=1.0)
        adhesion = Adhesion.checked("dugdale" if law == "dugdale" else "jkr", case.work, strength)
        contacts: list[Contact] = []
        before = calls(TRIALS[law], lambda: contacts.append(Contact.of(shape, case.stiffness, adhesion)))
    except rm.RoughmdrError:
        return None
    (contact,) = contacts
    return [calls(TRIALS[law], lambda: contact.law.state(case.distance, contact.params)), before]


def main() -> None:
    """Count and print."""
    warnings.simplefilter("ignore")
    with np.errstate(all="ignore"):
        found = [[counted(case, law) for law in TRIALS] for case in design(int(sys.argv[1]))]
    sys.stdout.write(json.dumps(found))


if __name__ == "__main__":
    main()
