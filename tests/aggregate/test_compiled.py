"""Which functions are compiled, counted in a process of its own whose cache is empty."""

import json
import os
import subprocess
import sys

import numba
import pytest

COUNT = """
import json
import sys
from numba.core.event import Listener, install_listener
import roughmdr as rm

class Compiled(Listener):
    def __init__(self):
        self.found = []

    def on_start(self, event):
        function = event.data["dispatcher"].py_func
        self.found.append((f"{function.__module__}.{function.__qualname__}", str(event.data["args"])))

    def on_end(self, event): ...

section = {
    "source": "random", "shape": "paraboloid", "count": 20, "patch": "1 mm", "radius": "50 um",
    "height": {"distribution": "normal", "std": "1 um"},
}
asperities, answers = rm.generate(section, seed=1), []
for variables in (["force"], ["force", "stiffness"], ["force", "energy", "dissipated_energy"]):
    with install_listener("numba:compile", Compiled()) as compiled:
        law = rm.load_separation(
            asperities, separation=[1e-6, 0.0, 1e-6], effective_modulus=4e6, work=0.05, variables=variables
        )
    answers.append([compiled.found, law.force.values.tolist()])
print(json.dumps(answers))
"""

pytestmark = [pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled"), pytest.mark.large]


def names(found: list[list[str]]) -> set[str]:
    """The functions, in whichever form: called from Python, from compiled code, or by address."""
    return {name.removesuffix("_bare").removesuffix("_argument") for name, _ in found}


@pytest.fixture(scope="module")
def cold(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[list[list[str]], list[float]]]:
    """The functions that a paraboloid under JKR compiles for force, for stiffness after it, and for energies last."""
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path_factory.mktemp("cache")), "ROUGHMDR_CACHE": ""}
    command = [sys.executable, "-c", COUNT]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=600)
    return [(found, force) for found, force in json.loads(done.stdout)]


def test_no_energy_is_compiled_unless_it_is_asked_for(cold: list[tuple[list[list[str]], list[float]]]) -> None:
    energy, running = "roughmdr.kernels.closed.jkr_paraboloid.energy", "roughmdr.numerics.summation.cumulative_sum"
    of_force, of_energy = names(cold[0][0]), names(cold[2][0])
    assert "roughmdr.aggregate.loop._loop_jkr_paraboloid" in of_force
    assert {energy, running}.isdisjoint(of_force)
    assert {energy, running} <= of_energy


def test_another_variable_without_energy_compiles_nothing(cold: list[tuple[list[list[str]], list[float]]]) -> None:
    assert cold[1][0] == []


def test_no_function_is_compiled_twice(cold: list[tuple[list[list[str]], list[float]]]) -> None:
    found = [tuple(each) for part, _ in cold for each in part if each[0].startswith("roughmdr.")]
    assert len(found) == len(set(found)) > 10
    assert len({name for name, _ in found}) == len(found), "nor for other types"


def test_only_what_python_calls_gets_the_wrapper_for_that(cold: list[tuple[list[list[str]], list[float]]]) -> None:
    ours = {name for name, _ in cold[0][0] if name.startswith("roughmdr.")}
    called = {name for name in ours if not name.endswith(("_bare", "_argument"))}
    assert called == {
        "roughmdr.aggregate.loop._loop_jkr_paraboloid",
        "roughmdr.aggregate.detachment._fill_jkr_paraboloid",
    }


def test_the_force_is_the_same_with_energies(cold: list[tuple[list[list[str]], list[float]]]) -> None:
    assert cold[0][1] == cold[1][1] == cold[2][1]
