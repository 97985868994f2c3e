"""Pictures of results with many realisations, of which little is copied at once."""

import tracemalloc
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.pictures.kinds import draw_request
from roughmdr.pictures.request import Drawable, Request, drawable
from roughmdr.variables import NOT_RUN

ASPERITIES = {**scene()["asperities"], "count": 3}
BATCH = {"realizations": 1500}
UNLOADED = {
    "path": {"separation": {"stop": "0.5 sigma", "steps": 200}, "unload": True},
    "adhesion": {"model": "jkr", "work": 0.05},
}
LOADED = {
    "path": {"preload": "0.2 mN", "steps": 200, "unload": True},
    "output": {"variables": ["force", "contact_area", "model_error_curve"]},
}
SWEPT = {**UNLOADED, "sweep": {"adhesion.work": [0.02, 0.05]}}


@pytest.mark.large
@pytest.mark.parametrize(
    ("changes", "request_", "missing"),
    [
        (UNLOADED, Request("law", ("force",), per_area=True), True),
        large(UNLOADED, Request("law", ("stiffness",), x="force"), False),
        large(UNLOADED, Request("convergence"), True),
        large(LOADED, Request("law", ("force",)), True),
        large(SWEPT, Request("sweep", ("contact_area",), at={"force": "1 uN"}), False),
    ],
)
def test_a_picture_of_many_realisations_copies_few_at_once(
    changes: dict[str, Any], request_: Request, missing: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The picture is the same as with all at once, to the last bit, also where a realisation is missing."""
    made = rm.run(scene(asperities=ASPERITIES, batch=BATCH, **changes))
    if missing:
        made.status[..., 3] = NOT_RUN
        for array in made.data_vars.values():
            if array.dtype.kind == "f" and "realization" in array.dims:
                array.loc[{"realization": 3}] = np.nan
    source = drawable(made)
    expected = picture(source, request_)
    monkeypatch.setattr("roughmdr.result.view.AT_ONCE", 2**20 if request_.at else 2**18)
    monkeypatch.setattr("roughmdr.batch.moments._AT_ONCE", 2**14)
    tracemalloc.start()
    try:
        figure = draw_request(source, request_).figure
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert figure.axes
    assert source.data.variables["force"].values.nbytes >= 4.8e6
    assert peak < 0.5 * source.data.variables["force"].values.nbytes
    assert picture(source, request_) == expected


def picture(source: Drawable, request: Request) -> bytes:
    content = BytesIO()
    draw_request(source, request).figure.savefig(content, format="png")
    return content.getvalue()
