"""The lines on contact, model error and trust of plans, runs and results."""

import math
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner
from scenes import SCENE, scene

import roughmdr as rm
from roughmdr.cli import main
from roughmdr.model_error.coupling import coupling_error, summits_error
from roughmdr.result.trust import trust_lines

NUMBERS = {
    "model_error": 0.317, "interaction_error": 1.4 * math.sqrt(0.035) + 0.035, "slope_error": 0.02,
    "profile_end_error": 0.0, "adhesion_range_error": 0.0, "resolution_error": 0.0, "border_error": 0.0,
    "largest_contact_fraction": 0.035, "trusted_separation": 1.1e-6, "overlap_fraction": 0.05,
}  # fmt: skip
NONE = dict.fromkeys(NUMBERS, math.nan)


def lines(**changes: float) -> dict[str, str]:
    return dict(trust_lines(NUMBERS | changes, [0.025, math.nan]))


def test_the_block_reads_as_it_should() -> None:
    told = lines()
    assert told["contact"] == "summed contact area 2.5 % of the patch at pull-off, 3.5 % at closest approach"
    assert told["model error"] == (
        "asperities are independent: force at given separation off by about 13 % (7.9 to 25) at pull-off"
    )
    assert told["trust"] == (
        "force within about 24 % down to h = 1.1 um (contact 2 %); below it asperities interact, which this scene "
        "leaves out: within 32 % at closest approach"
    )


def test_coupled_asperities_say_how_they_are_coupled() -> None:
    """In pairs, on a grid, or some runs so and some so; a mean field leaves the rest of the interaction out."""

    def told(*grid_points: float, **changes: float) -> str:
        numbers = NUMBERS | {"interaction_error": 7e-3, **changes, "grid_points": np.array(grid_points)}
        return dict(trust_lines(numbers, interaction="pairwise"))["model error"]

    rest = "with independent asperities off by about 16 % (9.4 to 30)"
    pairs = f"force at closest approach within 0.7 %, 5 % of it in contacts that overlap; {rest}"
    assert told(0.0, math.nan) == f"asperities are coupled in pairs: {pairs}"
    assert told(0.0, 0.0, 64.0) == f"asperities are coupled in pairs, in 1 of 3 by boundary elements: {pairs}"
    assert told(64.0) == f"computed by boundary elements: force at closest approach within 0.7 %; {rest}"
    on_grid = "computed by boundary elements: force at closest approach as right as the grid"
    assert told(64.0, interaction_error=0.0) == f"{on_grid}; {rest}"
    own = float(coupling_error(np.array(0.035), np.array(0.05)))
    flanks = own + float(summits_error(np.array(0.035), "summits"))
    numbers = NUMBERS | {"interaction_error": flanks, "grid_points": np.zeros(1)}
    of_summits = dict(trust_lines(numbers, interaction="pairwise", summits=True))
    because = "5 % of it in contacts that overlap, of which 23 % because flanks of summits are no paraboloids"
    assert because in of_summits["model error"]
    assert of_summits["model error"].endswith("with independent asperities off by about 20 % (9.4 to 42)")
    assert "down to" not in of_summits["trust"]  # flanks of summits cost more than that from first touch on
    assert "flanks" not in str(told(0.0, interaction_error=flanks))
    mean = dict(trust_lines(NUMBERS, interaction="mean_field"))
    assert mean["model error"].startswith("asperities feel each other's mean displacement only: force at given")
    assert "leaves out" not in mean["trust"]


@pytest.mark.large
@pytest.mark.parametrize("summits", [True, False])
def test_flanks_are_those_of_summits_in_plan_and_result(tmp_path: Path, summits: bool) -> None:
    """Asperities at random overlap, some more on the way than at closest approach: that makes no summits of them."""
    crowd = {
        "source": "random", "shape": "paraboloid", "count": 400, "patch": "0.3 mm", "radius": "50 um",
        "height": {"distribution": "normal", "std": "1 um"}, "placement": "random",
    }  # fmt: skip
    gaussian = {"source": "nayak", "patch": "0.2 mm", "m0": "4.5 um^2", "m2": 0.0144, "m4": 3.93e9}
    path = {"separation": {"start": "4 sigma", "stop": "1.5 sigma" if summits else "1 sigma", "steps": 25}}
    table = scene(
        adhesion=None, asperities=gaussian if summits else crowd, interaction={"model": "pairwise"}, path=path,
        seed=3, batch={"realizations": 2},
    )  # fmt: skip
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(table))
    planned = CliRunner().invoke(main, ["plan", str(tmp_path / "scene.toml")], catch_exceptions=False).output
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        told = rm.info(rm.run(table))
    for text in (planned, told):
        assert ("flanks of summits" in text) == summits


def test_where_no_unloading_ends_out_of_contact_there_is_no_line_on_pull_off() -> None:
    told = dict(trust_lines(NUMBERS, [math.nan]))
    assert told["contact"] == "summed contact area 3.5 % of the patch at closest approach"
    assert "pull-off" not in str(told)


def test_a_path_with_little_contact_is_trusted_along_all_of_it() -> None:
    told = lines(interaction_error=0.045, model_error=0.065, largest_contact_fraction=1e-3, trusted_separation=math.nan)
    assert told["trust"] == "force within about 6.5 % along the whole path"


def test_where_nothing_is_to_be_believed_the_cause_is_told() -> None:
    assert lines(adhesion_range_error=1.0, model_error=1.0)["trust"].startswith(
        "none: the force may be off by all of it"
    )
    assert "JKR, where adhesion reaches further" in lines(adhesion_range_error=1.0, model_error=1.0)["trust"]


def test_a_path_without_contact_has_nothing_to_trust() -> None:
    told = lines(**{name: 0.0 for name in NUMBERS if name != "trusted_separation"}, trusted_separation=math.nan)
    assert told["trust"] == "no contact along the whole path"
    assert "model error" not in told


def test_without_a_nominal_area_nothing_is_known() -> None:
    told = dict(trust_lines({**NONE, "slope_error": 0.0}))
    assert "not known" in told["contact"]
    assert "no nominal area" in told["trust"]


SPARSE = {**SCENE["asperities"], "count": 50}
CASES: list[tuple[dict[str, Any], str]] = [
    ({"asperities": SPARSE}, "within about"),
    ({"adhesion": None, "path": {"separation": ["9 um", "8 um"]}}, "no contact"),
    ({"batch": {"estimator": "expected", "realizations": 1}}, "down to h = "),
    ({"output": {"keep": "statistics"}}, "down to h = "),
    ({"sweep": {"adhesion.work": [0.01, 0.02]}}, "down to h = "),
]


@pytest.mark.few(1)
@pytest.mark.parametrize(("changes", "says"), CASES)
def test_plan_run_and_info_tell_how_far_the_force_can_be_trusted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any], says: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(tomli_w.dumps(scene(**changes)))
    for command in (["plan", "s.toml"], ["run", "s.toml", "-o", "out.nc"], ["info", "out.nc"]):
        done = CliRunner().invoke(main, command, catch_exceptions=False)
        assert done.exit_code == 0, done.output
        trust = re.findall(r"^trust +(.*)$", done.stdout, re.MULTILINE)
        assert len(trust) == 1
        assert says in trust[0]
        assert re.search(r"^contact ", done.stdout, re.MULTILINE)


def test_the_plan_foresees_what_the_run_finds(tmp_path: Path) -> None:
    from roughmdr.batch.foresee import foresee_cells
    from roughmdr.batch.plan import make_plan
    from roughmdr.scene import read

    table = scene(batch={"realizations": 32})
    foreseen = foresee_cells(make_plan(read(table))).foreseen[0].law.model_error
    made = rm.run(table)
    for name in ("largest_contact_fraction", "model_error"):
        assert foreseen.named[name] == pytest.approx(float(made[name].mean()), rel=0.05)


def test_the_title_of_a_picture_tells_it_and_the_band_is_drawn() -> None:
    made = rm.run(scene(output={"variables": ["force", "model_error_curve"]}))
    figure = rm.plot(made, variables="force")
    assert "model: force within about" in figure.get_suptitle()
    plain = rm.plot(made.drop_vars("model_error_curve"), variables="force")
    assert len(figure.axes[0].collections) > len(plain.axes[0].collections)
