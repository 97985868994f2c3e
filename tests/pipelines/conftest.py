"""The study that a module of tests names, carried out once in its short form."""

from collections.abc import Iterator

import pytest
import study
import xarray as xr
from carried_out import CarriedOut, carried_out


@pytest.fixture(scope="module")
def studied(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CarriedOut]:
    name: str = request.module.STUDIED
    with carried_out(study.study(name), tmp_path_factory.mktemp(name)) as made:
        yield made


@pytest.fixture(scope="module")
def result(studied: CarriedOut) -> xr.Dataset:
    return studied.result
