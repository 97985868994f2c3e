"""The scenes of ``left_out.py``, and each part that they do without, forced on."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple
from zlib import crc32

from roughmdr.aggregate import LoadingPath, LoadSeparation, compute
from roughmdr.batch.plan import make_plan
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.closed import hertz as elastic
from roughmdr.kernels.closed import jkr_paraboloid
from roughmdr.kernels.interface import Kernels
from roughmdr.numerics.arguments import Floats
from roughmdr.numerics.jit import njit
from roughmdr.numerics.rebind import rebuilt
from roughmdr.scene import Scene, read
from roughmdr.variables import CURVE_VARIABLES, DEFAULT_VARIABLES


class Size(NamedTuple):
    """How large a scene is."""

    asperities: int
    steps: int
    realizations: int = 1
    unload: bool = True
    adhesive: bool = False

    def reduced(self, factor: int) -> "Size":
        """The same with fewer realisations, two at least, or fewer asperities where there is just one, a hundred."""
        if self.realizations > 1:
            return self._replace(realizations=max(self.realizations // factor, 2))
        return self._replace(asperities=max(self.asperities // factor, 100))


SCENES = {
    "4,000 asperities": Size(4_000, 100, unload=False),
    "100,000 asperities, in and out": Size(100_000, 200),
    "200 realisations of 20 asperities": Size(20, 100, realizations=200, unload=False),
    "4,000 asperities, JKR": Size(4_000, 100, adhesive=True),
}
BATCH = "3,000 realisations of 20 asperities"
"""That of which statistics are kept, or curves."""
SIZES = {**SCENES, BATCH: Size(20, 100, realizations=3_000, unload=False)}
_SLIGHT = 1e-26
"""[J/m2], so little that JKR is Hertz to the digits that are stated."""


def scene_of(size: Size, **output: object) -> Scene:
    """Paraboloids of which only the force is asked; where they are adhesive, JKR is right and chosen."""
    return read(
        {
            "title": "What a scene does without",
            "seed": 3,
            "material": {"effective_modulus": "4 MPa"},
            **({"adhesion": {"model": "auto", "work": 0.05, "strength": "100 MPa"}} if size.adhesive else {}),
            "asperities": {
                "source": "random",
                "shape": "paraboloid",
                "count": size.asperities,
                "patch": "10 mm",
                "height": {"distribution": "normal", "std": "1 um"},
                "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
            },
            "path": {
                "separation": {"start": "4 sigma", "stop": "-0.5 sigma", "steps": size.steps},
                "unload": size.unload,
            },
            "output": {"variables": ["force"], **output},
            "batch": {"realizations": size.realizations},
        }
    )


class Way(NamedTuple):
    """How a scene is computed; as it stands nothing is in it that the scene does not need."""

    scene: Scene
    path: LoadingPath
    adhesion: Adhesion
    variables: tuple[str, ...]
    placed: bool = False
    compute: Callable[..., LoadSeparation] = compute

    @classmethod
    def of(cls, scene: Scene) -> "Way":
        """As a run goes it."""
        return cls(scene, make_plan(scene).cells[0].path, scene.adhesion_model, tuple(scene.output.variables))

    def laws(self) -> Iterator[LoadSeparation]:
        """Of each realisation."""
        asked = {
            "effective_modulus": self.scene.effective_modulus,
            "adhesion": self.adhesion,
            "variables": self.variables,
        }
        for realization in range(self.scene.batch.realizations):
            ensemble = self.scene.asperities.ensemble(self.scene.seed, realization, placed=self.placed)
            yield self.compute(ensemble, self.path, **asked)


@njit
def _everyone(height: Floats, lowest: float) -> int:
    """In place of how many asperities are within reach: all of them."""
    return int(height.size)


@njit
def _state(x: float, n: float) -> float:
    """The state of a paraboloid without adhesion; out of reach that of first touch."""
    return elastic.state_paraboloid(max(x, 0.0), n)


@njit
def _state_jkr(x: float, n: float) -> float:
    """The state of an adhesive paraboloid; out of reach that of first touch."""
    return jkr_paraboloid.state(x if x > 0.0 else 1.0, n)


class _Everywhere(Kernels):
    """A law in whose sum all paraboloids are visited at all steps; those that touch nothing carry no force."""

    @property
    def kernels(self) -> dict[str, object]:
        """As in ``Kernels``."""
        return {**super().kernels, "_within_reach": _everyone, "_state": _state_jkr if self.adhesive else _state}


_EVERYWHERE = f"everywhere_{crc32(Path(__file__).read_bytes()):08x}"
"""What was compiled is found again by its name: that tells it from the sum itself, and from other kernels here."""


def _choose(shape: str, adhesion: Adhesion, params: Floats) -> Kernels:
    """The law of a scene, everywhere."""
    law = choose(shape, adhesion, params)
    return _Everywhere(*law._replace(name=f"{law.name}_{_EVERYWHERE}"))


_compute_everywhere = rebuilt(compute, {"choose": _choose}, lambda function: function)

Forced = Callable[[Way], Way]
_HERTZ: dict[str, Forced] = {
    "adhesion": lambda way: way._replace(
        adhesion=Adhesion(_SLIGHT),
        path=LoadingPath.along(
            way.scene.path.separations(way.scene.asperities.sigma), unload=way.scene.path.unload, adhesive=True
        ),
    )
}
_JKR: dict[str, Forced] = {
    "range of adhesion": lambda way: way._replace(adhesion=way.adhesion._replace(model="dugdale"))
}
_BOTH: dict[str, Forced] = {
    "positions": lambda way: way._replace(placed=True),
    "asperities out of reach": lambda way: way._replace(compute=_compute_everywhere),
    "the other default variables": lambda way: way._replace(variables=DEFAULT_VARIABLES),
    "all other variables": lambda way: way._replace(variables=tuple(CURVE_VARIABLES)),
}


def forced(size: Size) -> dict[str, Forced]:
    """What can be forced on in a scene, by the part."""
    return {**(_JKR if size.adhesive else _HERTZ), **_BOTH}
