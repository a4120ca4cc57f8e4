"""Service: submit, watch, results, cancel, async; kills, restarts, tokens and TLS; no process or file remains."""

from __future__ import annotations

import asyncio
import itertools
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import cognate as cg
from cognate import program
from conftest import EXAMPLES, katsura, processes_with, until

# Takes some seconds on two cores, enough time for other calls.
LONG = katsura(12)


def test_submit_watch_results(service: cg.Service) -> None:
    job = service.submit(EXAMPLES / "katsura_10.bertini")
    seen = list(job.watch())
    assert seen and all(a.done <= b.done for a, b in itertools.pairwise(seen))
    assert job.state == "solved"
    found = job.results(strict=True)
    assert found.job == job.id and found.counts.distinct == 1024
    # The answer has the same bits as without a service.
    assert cg.solve(EXAMPLES / "katsura_10.bertini").solutions == found.solutions
    assert job.id in [j["job"] for j in service.jobs()]
    assert len(service.workers()) == 2
    again = service.job(job.id)
    assert again.results().counts == found.counts
    assert again.cancel() == "solved"


def test_many_targets_by_a_service(service: cg.Service) -> None:
    family = cg.System(["x^2 - p"], parameters="p")
    base = service.submit(family, start="monodromy", expect=2).results()
    found = service.submit(family, start=base, targets=[[n] for n in range(1, 30)]).results()
    assert len(found.targets) == 29 and all(t.counts.real == 2 for t in found.targets)


def test_cancel(service: cg.Service) -> None:
    job = service.submit(LONG)
    assert job.cancel() == "cancelled"
    assert job.wait() == "cancelled"
    with pytest.raises(cg.Cancelled):
        job.results()


def test_errors_of_a_service(service: cg.Service) -> None:
    with pytest.raises(cg.InputError, match="there is no job"):
        service.job("0123456789abcdef").results()
    with pytest.raises(cg.InputError) as raised:
        service.submit(["x + "])
    assert raised.value.field == "equations[0]"
    with pytest.raises(TypeError, match="elsewhere"):
        cg.Service("http://127.0.0.1:1", workers=2)
    with cg.Service("http://127.0.0.1:1", patience=0.1) as nobody:
        with pytest.raises(cg.Unreachable, match="127.0.0.1:1"):
            nobody.jobs()


def test_async(service: cg.Service) -> None:
    async def several() -> list[int]:
        jobs = await asyncio.gather(*(service.submit_async([f"x^{n} - 2"]) for n in (2, 3, 4)))
        found = await asyncio.gather(*(job.results_async() for job in jobs))
        cancelled = await service.submit_async(LONG)
        await cancelled.cancel_async()
        assert all([now.failed == 0 async for now in cancelled.watch_async()])
        assert await cancelled.wait_async() == "cancelled"
        return [r.counts.distinct for r in found]

    assert asyncio.run(several()) == [2, 3, 4]


def test_a_watch_that_is_left_ends(service: cg.Service) -> None:
    job = service.submit(LONG)
    for _ in job.watch():
        break
    assert until(lambda: not processes_with(f"-- {job.id}"))
    job.cancel()


def test_nothing_is_lost_when_the_coordinator_is_killed(tmp_path: Path) -> None:
    """Several threads make 200 calls while a job runs; kill -9 ends the coordinator and a worker in the middle."""
    with cg.Service(workers=2, threads=1, folder=tmp_path) as service:
        long = service.submit(LONG)
        answers: dict[int, list[int | None]] = {}

        def client(number: int) -> None:
            answers[number] = []
            for i in range(12):
                job = service.submit([f"x^2 - {number + 2}", f"y - {i}"])
                found = job.results()
                assert round(found.solutions[0]["y"].real) == i
                answers[number].append(found.counts.real)
                assert job.id in [j["job"] for j in service.jobs()]

        clients = [threading.Thread(target=client, args=(n,)) for n in range(4)]
        for c in clients:
            c.start()
        for name in ("coordinator", "worker-1", "coordinator"):
            time.sleep(1.0)
            os.kill(int((tmp_path / f"{name}.pid").read_text()), signal.SIGKILL)
        for c in clients:
            c.join(120)
        # 4 threads, 12 rounds, each of submit, watch, explain, results and jobs: 240 calls.
        assert answers == {n: [2] * 12 for n in range(4)}
        listed = service.jobs()
        assert len(listed) == 4 * 12 + 1
        found = long.results()
        assert found.counts.distinct == 4096
        job = long.id
    # The folder stores the job, so the next service has it.
    with cg.Service(workers=1, folder=tmp_path) as service:
        assert service.job(job).results().solutions == found.solutions
        assert len(service.jobs()) == len(listed)


def test_an_interpreter_that_is_killed_leaves_nothing(tmp_path: Path) -> None:
    folder = tmp_path / f"killed-{os.getpid()}"
    script = (
        f"import cognate as cg, time; s = cg.Service(folder={str(folder)!r}); print('up', flush=True); time.sleep(60)"
    )
    temporary = tmp_path / "t"
    temporary.mkdir()
    environment = {**os.environ, "TMPDIR": str(temporary)}
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=environment)
    assert child.stdout is not None and child.stdout.readline() == "up\n"
    assert until(lambda: len(list(folder.glob("*.pid"))) == 3)
    pids = [int(p.read_text()) for p in folder.glob("*.pid")]
    child.kill()
    child.wait()
    child.stdout.close()
    assert until(lambda: not any(_runs(pid) for pid in pids))
    assert until(lambda: not list(temporary.iterdir()))


def test_a_keeper_that_is_killed_leaves_nothing(tmp_path: Path) -> None:
    service = cg.Service(folder=tmp_path, patience=1)
    assert service._embedded is not None
    pids = [int(p.read_text()) for p in tmp_path.glob("*.pid")]
    service._embedded._keeper.kill()
    if sys.platform == "linux":
        assert until(lambda: not any(_runs(pid) for pid in pids))
    with pytest.raises(cg.ServiceError):
        service.jobs()
    service.close()
    service.close()


def test_a_service_that_does_not_come_up_says_why(tmp_path: Path) -> None:
    (tmp_path / "ledger.db").write_text("no database at all, but long enough to be taken for a broken one" * 20)
    with pytest.raises(cg.ServiceError, match="(?s)embedded service has ended.*ledger"):
        cg.Service(folder=tmp_path)


def _runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


@pytest.fixture
def elsewhere(tmp_path: Path) -> Iterator[tuple[str, Path, Path]]:
    """A coordinator with tokens and TLS, and a worker: its URL, the client's token and the authority."""
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("openssl makes the certificate, and is not here")
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    command = [openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
    command += ["-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1"]
    command += ["-addext", "basicConstraints=critical,CA:FALSE"]
    subprocess.run([*command, "-keyout", key, "-out", certificate], check=True, capture_output=True)
    tokens, mine, workers = tmp_path / "tokens", tmp_path / "mine", tmp_path / "workers"
    secret = "a-secret-of-thirty-two-characters-"
    tokens.write_text(f"client {secret}1\nworker {secret}2\n")
    mine.write_text(f"{secret}1\n")
    workers.write_text(f"{secret}2\n")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    url = f"https://localhost:{port}"
    log = (tmp_path / "log").open("wb")
    started = []
    for arguments in (
        [
            *["coordinator", "--listen", f"127.0.0.1:{port}", "--ledger", f"sqlite:{tmp_path / 'ledger.db'}"],
            *["--results", tmp_path / "results", "--token-file", tokens],
            *["--tls-certificate", certificate, "--tls-key", key],
        ],
        ["worker", "--coordinator", url, "--token-file", workers, "--tls-ca", certificate, "--threads", "1"],
    ):
        command = [program.find(), *map(str, arguments)]
        started.append(subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL))
    yield url, mine, certificate
    for process in reversed(started):
        process.terminate()
        process.wait(20)
    log.close()


def test_a_token_and_tls(elsewhere: tuple[str, Path, Path]) -> None:
    url, token, authority = elsewhere
    with cg.Service(url, token_file=token, tls_ca=authority) as service:
        assert service.submit(["x^2 - 2"]).results().counts.real == 2
    with (
        cg.Service(url, tls_ca=authority, patience=1) as without,
        pytest.raises(cg.CognateError, match="token"),
    ):
        without.jobs()
    with cg.Service(url, token_file=token, patience=1) as unchecked, pytest.raises(cg.CognateError):
        unchecked.jobs()
