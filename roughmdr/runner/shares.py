"""Shares of a batch: each is computed by itself, on any machine, and all are joined to one result."""

import shlex
from contextlib import ExitStack
from pathlib import Path

from roughmdr.batch.choose import plan_scene
from roughmdr.batch.plan import Plan
from roughmdr.batch.resume.kept import read_kept
from roughmdr.batch.resume.keys import versions
from roughmdr.batch.resume.share import Share
from roughmdr.batch.resume.store import CheckpointStore, locked_store
from roughmdr.batch.rounds import Rounds
from roughmdr.errors import SceneError, StoreError
from roughmdr.runner.backend import Backend
from roughmdr.runner.batch import Beginning, at_work, begun
from roughmdr.scene import read
from roughmdr.schema.toml_text import parse_toml
from roughmdr.storage.files import destination
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import FAILED

_NAMED = 8  # most shares that a message names


def compute_share(
    plan: Plan, target: Path, share: Share, backend: Backend, *, resume: bool, quiet: bool, command: str
) -> None:
    """Compute a share of the runs of a plan, and keep their results beside ``target``, which is not written.

    SceneError where the runs depend on results, StoreError where the results cannot be kept.
    """
    if plan.scene.accuracy is not None:
        raise SceneError("accuracy: how many runs there are follows from their results; a part of them cannot be told")
    backend.check()
    with begun(plan, target, share, resume=resume) as beginning:
        ranges = share.of(beginning.rounds.begin())
        if ranges:
            with at_work(beginning, backend, command, resume=resume, quiet=quiet, assembled=False) as batch:
                batch.keep(ranges, quiet=quiet)


def join(target: Path, backend: Backend, *, quiet: bool, command: str) -> Labelled:
    """Write the result of shares that are kept beside ``target``, and remove them; runs that failed are tried again.

    StoreError where a share is missing, is not done, or is of another batch.
    """
    backend.check()
    target = destination(target)
    shares = Share.all_beside(target)
    if not shares:
        raise StoreError(f"{target}: no part of it is here; expected folders such as {Share(1, 8).folder(target)}")
    if len(counts := {share.total for share in shares}) > 1:
        raise StoreError(f"{target}: there are parts of {' and of '.join(map(str, sorted(counts)))}; remove the others")
    with ExitStack() as stack:
        stores = [stack.enter_context(locked_store(share.beside(target))) for share in shares]
        plan = plan_scene(read(parse_toml(_common_scene(stores))))
        with begun(plan, target, resume=True) as beginning:
            if beginning.finished and beginning.old is not None:
                result = beginning.old
            else:
                for store in stores:
                    for reader in store.readers():
                        beginning.reusable.add(reader)
                _check_complete(beginning, target, shares[0].total, stores)
                with at_work(beginning, backend, command, resume=True, quiet=quiet) as batch:
                    result = batch.run(quiet=quiet)
        if not (result.variables["status"].values == FAILED).any():
            for store in stores:
                store.clear()
    return result


def _common_scene(stores: list[CheckpointStore]) -> str:
    """Return the scene of all shares; StoreError where they have several, or other versions made one."""
    for store in stores:
        if store.scene and store.versions != versions():
            raise StoreError(f"{store.folder}: was made with {store.versions}; this is {versions()}")
    scenes = {store.scene: store.folder for store in stores if store.scene}
    if len(scenes) > 1:
        raise StoreError(f"{' and '.join(map(str, scenes.values()))}: are parts of different scenes; remove the others")
    for scene in scenes:
        return scene
    raise StoreError(f"{stores[0].folder}: keeps nothing yet")


def _check_complete(beginning: Beginning, target: Path, count: int, stores: list[CheckpointStore]) -> None:
    """Raise StoreError, which names the shares and how they are computed, unless all runs are there or have failed."""
    kept = [read_kept(store.folder) for store in stores]
    failed = set[tuple[str, int]]().union(*(each.failed for each in kept))
    ranges, unfinished, runs = Rounds(beginning.plan).begin(), list[Share](), 0
    for share in (Share(number, count) for number in range(1, count + 1)):
        missing = beginning.missing(share.of(ranges), [])
        lacking = {(one.key, run) for one in missing for run in range(one.first, one.last)} - failed
        if lacking:
            unfinished.append(share)
            runs += len(lacking)
    if unfinished:
        named = ", ".join(f"{share.number}/{count}" for share in unfinished[:_NAMED])
        more = f" and {len(unfinished) - _NAMED} more" if len(unfinished) > _NAMED else ""
        remedy = f"roughmdr run SCENE -o {shlex.quote(str(target))} --part {unfinished[0].number}/{count}"
        raise StoreError(f"{target}: {runs} runs of the parts {named}{more} are not done; compute them by: {remedy}")
