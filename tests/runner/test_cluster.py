"""Batches over a dask cluster on this machine, of real processes that come, go and die."""

import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import psutil
import pytest
import xarray as xr
from batches import (
    CURVES,
    PATIENCE,
    RUNS,
    STATISTICS,
    Batch,
    assert_result,
    assert_same,
    kept,
    running,
    until,
    write_scene,
)
from command import roughmdr
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.estimate import suits_processes
from roughmdr.batch.plan import make_plan
from roughmdr.errors import RoughmdrError
from roughmdr.runner import backend as cluster
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read


class Dask:
    """A scheduler and workers, as the commands ``dask scheduler`` and ``dask worker`` start them."""

    def __init__(self, folder: Path, stack: ExitStack, *options: str) -> None:
        self._folder, self._stack, self._options = folder, stack, options
        self.scheduler = self._started("scheduler", "--port", "0", "--no-jupyter")
        until(lambda: b"Scheduler at" in self.log.read_bytes() or self.scheduler.poll() is not None)
        line = next(line for line in self.log.read_text().splitlines() if "Scheduler at" in line)
        self.address = line.split("Scheduler at:")[1].strip()
        self.workers: list[subprocess.Popen[bytes]] = []

    @property
    def log(self) -> Path:
        return self._folder / "scheduler.log"

    def _started(self, what: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", "--host", "127.0.0.1", "--no-dashboard"]
        with (self._folder / f"{what}.log").open("ab") as log:
            process = subprocess.Popen([*command, *arguments, *self._options], cwd=self._folder, stdout=log, stderr=log)
        self._stack.callback(self._end, process)
        return process

    @staticmethod
    def _end(process: subprocess.Popen[bytes]) -> None:
        process.kill()
        process.wait()

    def add_worker(self) -> subprocess.Popen[bytes]:
        self.workers.append(self._started("worker", self.address, "--nthreads", "1", "--no-nanny"))
        return self.workers[-1]

    def wait_for_workers(self, count: int) -> None:
        until(lambda: self.log.read_text().count("Register worker") >= count, pause=0.05)


@contextmanager
def dask(folder: Path, workers: int, *options: str) -> Iterator[Dask]:
    with ExitStack() as stack:
        cluster = Dask(folder, stack, *options)
        for _ in range(workers):
            cluster.add_worker()
        cluster.wait_for_workers(workers)
        yield cluster


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Dask]:
    """A cluster that nothing happens to."""
    with dask(tmp_path_factory.mktemp("dask"), 2) as cluster:
        yield cluster


@pytest.mark.large
@pytest.mark.parametrize("runs_per_task", [large(1), 7, large(64)])
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_the_same_bits_from_a_cluster(two: Dask, keep: str, runs_per_task: int, request: pytest.FixtureRequest) -> None:
    plan = make_plan(read(CURVES if keep == "curves" else STATISTICS))
    assert_same(
        execute(plan, None, Backend(two.address, runs_per_task=runs_per_task)).to_xarray(),
        request.getfixturevalue(keep),
    )


@pytest.mark.parametrize(("scheduler", "workers"), [("processes", 2), large("processes", 3), large("threads", 3)])
@pytest.mark.parametrize(("keep", "runs_per_task"), [("curves", 7), large("statistics", 64), large("statistics", 1)])
def test_the_same_bits_from_threads_and_processes(
    scheduler: str, workers: int, keep: str, runs_per_task: int, request: pytest.FixtureRequest
) -> None:
    plan = make_plan(read(CURVES if keep == "curves" else STATISTICS))
    assert_same(
        execute(plan, None, Backend(scheduler, workers, None, runs_per_task)).to_xarray(), request.getfixturevalue(keep)
    )


@pytest.mark.large
def test_the_command_computes_long_runs_in_pairs_in_processes_to_the_same_bits(tmp_path: Path) -> None:
    path = {"separation": {"start": "4 sigma", "stop": "1.5 sigma", "steps": 20}, "unload": True}
    asperities = {**ASPERITIES, "count": 150, "radius": "10 um"}
    pairs = scene(asperities=asperities, interaction={"model": "pairwise"}, path=path, batch={"realizations": 12})
    assert suits_processes(make_plan(read(pairs)), 2)
    write_scene(tmp_path, pairs)
    roughmdr("run", tmp_path / "scene.toml", "-o", tmp_path / "out.nc")
    with xr.open_dataset(tmp_path / "out.nc") as by_command:
        assert_same(by_command, rm.run(pairs))


@pytest.mark.large
def test_few_tasks_are_in_flight(two: Dask) -> None:
    """Two for each thread, so that no heap of results waits for the writer."""
    from distributed import Client

    plan, over, seen = make_plan(read(CURVES)), threading.Event(), list[int]()

    def watch() -> None:
        def in_flight(dask_scheduler: Any) -> int:
            return sum(str(key).startswith("roughmdr-") for key in dask_scheduler.tasks)

        with Client(two.address, set_as_default=False) as client:
            while not over.is_set():
                seen.append(client.run_on_scheduler(in_flight))
                time.sleep(0.005)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        until(lambda: len(seen) > 0)
        execute(plan, None, Backend(two.address, runs_per_task=1))
    finally:
        over.set()
        watcher.join()
    assert sum(count > 0 for count in seen) > 5
    assert max(seen) <= 2 * 2 + 1  # one that is done may not be forgotten yet


@pytest.mark.large
def test_an_interrupt_lets_the_tasks_in_flight_end(two: Dask, folder: Path, curves: xr.Dataset) -> None:
    with running(Batch(folder, "--scheduler", two.address)) as batch:
        batch.wait_for_lines(5)
        batch.signal_group(signal.SIGINT)
        said = batch.fail(130)
    assert "interrupted; what is finished is kept in out.nc.parts" in said
    held = kept(folder)
    assert 20 <= held < RUNS
    with running(Batch(folder, "--scheduler", two.address)) as batch:
        assert batch.succeed() == RUNS - held
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_workers_that_die_and_workers_that_come(tmp_path: Path, folder: Path, curves: xr.Dataset) -> None:
    """One of two dies: the other goes on. That one too: the batch waits. A new one comes: it goes on."""
    with dask(tmp_path, 2) as cluster, running(Batch(folder, "--scheduler", cluster.address)) as batch:
        batch.wait_for_lines(3)
        cluster.workers[0].kill()
        before = kept(folder)
        until(lambda: kept(folder) >= before + 20)
        cluster.workers[1].kill()
        cluster.workers[1].wait()
        time.sleep(1.0)
        before = kept(folder)
        assert before < RUNS
        time.sleep(1.5)
        assert kept(folder) == before
        assert batch.process.poll() is None
        cluster.add_worker()
        assert batch.succeed() == RUNS
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_without_workers_two_interrupts_end_it(tmp_path: Path, folder: Path) -> None:
    with dask(tmp_path, 0) as cluster, running(Batch(folder, "--scheduler", cluster.address)) as batch:
        until((folder / "out.nc.parts" / "manifest.jsonl").exists)
        time.sleep(0.5)
        for _ in range(2):
            batch.signal_group(signal.SIGINT)
            time.sleep(0.5)
        until(lambda: batch.process.poll() is not None, 10.0)
        batch.fail(130)


@pytest.mark.large
def test_a_scheduler_that_dies_is_told_of_and_threads_go_on(tmp_path: Path, folder: Path, curves: xr.Dataset) -> None:
    with dask(tmp_path, 1) as cluster, running(Batch(folder, "--scheduler", cluster.address)) as batch:
        batch.wait_for_lines(5)
        cluster.scheduler.kill()
        until(lambda: batch.process.poll() is not None, 20.0)
        said = batch.fail(1)
    assert "the cluster is lost: " in said
    assert "; what is finished is kept in out.nc.parts; the same command goes on from there" in said
    assert len(said.splitlines()) <= 2, said
    held = kept(folder)
    assert 20 <= held < RUNS
    with running(Batch(folder)) as batch:
        assert batch.succeed() == RUNS - held
    assert_result(folder, curves, alone=True)


@pytest.mark.large
def test_no_scheduler_there_is_said_at_once(folder: Path) -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))  # nobody listens
        for address in (
            f"tcp://127.0.0.1:{unused.getsockname()[1]}",
            "tcp://127.0.0.1",
            "tcp://no.such.host.invalid:1",
        ):
            with running(Batch(folder, "--scheduler", address)) as batch:
                until(lambda batch=batch: batch.process.poll() is not None, 15.0)
                said = batch.fail(2)
            assert f"scheduler is {address!r}: no dask scheduler answers there" in said
            assert [path.name for path in folder.iterdir()] == ["scene.toml"]


@pytest.mark.parametrize(
    "says", [None, b"", b"SSH-2.0-OpenSSH_9.6\r\n", b"HTTP/1.1 400 Bad Request\r\n\r\n", b"\xff" * 9999]
)
def test_a_server_that_is_no_scheduler_is_told(says: bytes | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Silent ones are left after a while, others at once; None stands for one that hangs up."""
    monkeypatch.setattr(cluster, "_GREETING_TIMEOUT", 0.3)
    with ExitStack() as stack:
        server = stack.enter_context(socket.create_server(("127.0.0.1", 0)))

        def serve() -> None:
            connection = stack.enter_context(server.accept()[0])
            connection.close() if says is None else connection.sendall(says)

        thread = threading.Thread(target=serve)
        thread.start()
        with pytest.raises(RoughmdrError, match="no dask scheduler answers there"), ExitStack() as opened:
            opened.enter_context(cluster.connected(f"tcp://127.0.0.1:{server.getsockname()[1]}", None))
        thread.join()


@pytest.mark.large
def test_a_run_over_a_cluster_does_not_listen(two: Dask, folder: Path) -> None:
    with running(Batch(folder, "--scheduler", two.address)) as batch:
        batch.wait_for_lines(2)
        found = psutil.Process(batch.pid).net_connections("inet")
    assert found
    assert not [connection for connection in found if connection.status == psutil.CONN_LISTEN]
    assert {connection.raddr.ip for connection in found if connection.raddr} == {"127.0.0.1"}


def certified(folder: Path) -> list[str]:
    """An authority that lives for a day, and a certificate from it: the options that name them."""

    def openssl(*arguments: str) -> None:
        subprocess.run(["openssl", *arguments], cwd=folder, check=True, capture_output=True, timeout=PATIENCE)

    curve = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    openssl("req", "-x509", *curve, "-days", "1", "-subj", "/CN=authority", "-keyout", "ca.key", "-out", "ca.pem")
    openssl("req", *curve, "-subj", "/CN=localhost", "-keyout", "key.pem", "-out", "request.pem")
    signed = ("-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "1")
    openssl("x509", "-req", "-in", "request.pem", *signed, "-out", "cert.pem")
    names = {"ca": "ca.pem", "cert": "cert.pem", "key": "key.pem"}
    return [text for option, name in names.items() for text in (f"--tls-{option}", str(folder / name))]


@pytest.mark.large
@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificates")
def test_encrypted(tmp_path: Path, folder: Path, curves: xr.Dataset) -> None:
    options = certified(tmp_path)
    ca, *others = options
    with dask(tmp_path, 1, f"{ca}-file", *others, "--protocol", "tls") as cluster:
        assert cluster.address.startswith("tls://127.0.0.1:")
        with running(Batch(folder, "--scheduler", cluster.address, *options)) as batch:
            assert batch.succeed() == RUNS
    assert_result(folder, curves, alone=True)


@pytest.mark.large
@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificates")
def test_who_may_not_connect_is_told_why(tmp_path: Path, folder: Path) -> None:
    options = certified(tmp_path)
    ca, *others = options
    with dask(tmp_path, 1, f"{ca}-file", *others, "--protocol", "tls") as cluster:
        without_key = [*options[:-1], str(tmp_path / "none.pem")]
        strangers = tmp_path / "strangers"
        strangers.mkdir()
        plain = cluster.address.replace("tls", "tcp")
        for address, wrong, says in (
            (cluster.address, [], "it needs --tls-ca, --tls-cert and --tls-key"),
            (cluster.address, without_key, "No such file or directory"),
            (cluster.address, certified(strangers), "no dask scheduler answers there"),
            (plain, options, "with certificates it must be tls://HOST:PORT"),
        ):
            with running(Batch(folder, "--scheduler", address, *wrong)) as batch:
                said = batch.fail(2)
            assert says in said
        with running(Batch(folder, "--scheduler", cluster.address, *options[:2])) as batch:
            said = batch.fail(2)
        assert "--tls-ca, --tls-cert and --tls-key must be given together" in said
