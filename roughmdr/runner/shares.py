"""Shares of a batch: each is computed by itself, on any machine, and all are joined to one result."""

import shlex
from contextlib import ExitStack
from pathlib import Path

from roughmdr.batch.choose import plan_scene
from roughmdr.batch.plan import Plan
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

_NAMED = 8  # most shares that a message names


def compute_share(
    plan: Plan, target: Path, share: Share, backend: Backend, *, resume: bool, quiet: bool, command: str
) -> tuple[Path | None, list[str]]:
    """Compute a share of the runs of a plan, and keep their results beside ``target``, which is not looked at.

    Return the folder of these results, None where the share has no runs, and for each run that failed the reason.
    SceneError where the runs depend on results, StoreError where the results cannot be kept.
    """
    if plan.scene.accuracy is not None:
        raise SceneError("accuracy: how many runs there are follows from their results; a part of them cannot be told")
    backend.check()
    with begun(plan, target, share, resume=resume) as beginning:
        ranges = share.of(beginning.rounds.begin())
        with at_work(beginning, backend, command, resume=resume, quiet=quiet, assembled=False) as batch:
            failures = batch.keep(ranges, quiet=quiet)  # also without runs: an earlier scene may have had some
            return share.folder(destination(target)) if ranges else None, failures


def join(target: Path, backend: Backend, *, fresh: bool = False, quiet: bool, command: str) -> Labelled:
    """Write the result of shares that are kept beside ``target``, and remove them; runs that failed are tried again.

    StoreError where a share is missing, is not done, or is of another batch, or where ``target`` holds another result
    and is not replaced by a ``fresh`` one.
    """
    backend.check()
    target = destination(target)
    shares = Share.all_beside(target)
    if not shares:
        written = ", and the file is there: is it joined already?" if target.exists() else ""
        expected = f"expected folders such as {Share(1, 8).folder(target)}"
        raise StoreError(f"{target}: no part of it is here{written or '; ' + expected}")
    if len(folders := {share.total: share.folder(target) for share in shares}) > 1:
        raise StoreError(f"{' and '.join(map(str, folders.values()))}: are of other numbers of parts; remove one kind")
    with ExitStack() as stack:
        stores = [stack.enter_context(locked_store(share.beside(target), of_share=True)) for share in shares]
        plan = plan_scene(read(parse_toml(_common_scene(stores))))
        with begun(plan, target, resume=not fresh) as beginning:
            for reader in (reader for store in stores for reader in store.readers()):
                beginning.reusable.add(reader)
            if beginning.finished and beginning.old is not None:  # the join that wrote it was killed before its end
                cells = [(method.key, method.realizations) for method in beginning.rounds.methods]
                for store in [] if beginning.reusable.has_unused(cells) else stores:
                    store.clear()
                return beginning.old
            beginning.writer.joined = stores
            _check_complete(beginning, target, shares[0].total, stores)
            with at_work(beginning, backend, command, resume=not fresh, quiet=quiet) as batch:
                return batch.run(quiet=quiet)


def _common_scene(stores: list[CheckpointStore]) -> str:
    """Return the scene of all shares; StoreError where they have several, or other versions made one."""
    for store in stores:
        if store.scene and store.versions != versions():
            remedy = f"this is {versions()}; compute it again with --fresh, or join it with the former"
            raise StoreError(f"{store.folder}: was made with {store.versions}; {remedy}")
    scenes = {store.scene: store.folder for store in stores if store.scene}
    if len(scenes) > 1:
        folders = " and ".join(map(str, scenes.values()))
        raise StoreError(f"{folders}: are parts of different scenes; compute one kind again")
    for scene in scenes:
        return scene
    raise StoreError(f"{stores[0].folder}: no run of this part, nor of another, is kept yet")


def _check_complete(beginning: Beginning, target: Path, total: int, stores: list[CheckpointStore]) -> None:
    """Raise StoreError, which names the shares and how they are computed, unless all runs are there or have failed."""
    failed = set[tuple[str, int]]().union(*(store.failed for store in stores))
    ranges = Rounds(beginning.plan).begin()
    missing = beginning.reusable.missing(ranges, [])
    lacking = {(each.key, run) for each in missing for run in range(each.first, each.last)} - failed
    if not lacking:
        return
    unfinished = [
        share
        for share in (Share(number, total) for number in range(1, total + 1))
        if any((each.key, run) in lacking for each in share.of(ranges) for run in range(each.first, each.last))
    ]
    named = ", ".join(f"{share.number}/{total}" for share in unfinished[:_NAMED])
    more = f" and {len(unfinished) - _NAMED} more" if len(unfinished) > _NAMED else ""
    runs = f"{len(lacking)} run{'s' * (len(lacking) > 1)} of part{'s' * (len(unfinished) > 1)} {named}{more}"
    remedy = f"roughmdr run SCENE -o {shlex.quote(str(target))} --part {unfinished[0].number}/{total}"
    raise StoreError(f"{target}: {runs} not done; compute by: {remedy}")
