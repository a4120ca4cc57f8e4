"""Service: a coordinator with workers, embedded or elsewhere. Job: a problem that the service solves."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from . import program, result
from .command_line import option_words
from .errors import CognateWarning, ServiceError, Unreachable, in_the_users_words, warn
from .options import Options
from .program import Finished, Own, Progress
from .progress import Bar, Wanted
from .result import Result
from .solving import checked, problem_arguments

if TYPE_CHECKING:
    from typing_extensions import Unpack

START_SECONDS = 30.0
"""Seconds that an embedded coordinator has for its start."""

RETRY_SECONDS = 0.3
"""Seconds between two calls while no coordinator answers."""

ENDED = (0, 1, 3, 4)
"""Exit codes of `watch` for a job that has ended."""


class Service:
    """A coordinator that plans and stores jobs, and workers that track paths.

    `Service(workers=2)` starts them here. They end with the block, with `close()` or with the interpreter,
    however that ends. Dead processes are restarted. `folder`: storage of the jobs; the jobs of an earlier
    service in this folder continue. By default it is a temporary folder, which is removed at the end.

    `Service("http://head:7654")` uses a service elsewhere: `http://HOST:PORT`, `https://...`, `unix:PATH`, or
    several addresses with commas between. `token_file`, `tls_ca`, `tls_certificate`, `tls_key`: files, as for the
    command line.

    A call waits up to `patience` seconds for a coordinator that does not answer, for example during a restart.
    Several threads may use one service.

    >>> import cognate as cg
    >>> with cg.Service(workers=1) as service:
    ...     job = service.submit(["x^2 - 2"])
    ...     job.results().counts.real
    2
    """

    def __init__(
        self,
        url: str | None = None,
        *,
        workers: int | None = None,
        threads: int | None = None,
        folder: str | os.PathLike[str] | None = None,
        token_file: str | os.PathLike[str] | None = None,
        tls_ca: str | os.PathLike[str] | None = None,
        tls_certificate: str | os.PathLike[str] | None = None,
        tls_key: str | os.PathLike[str] | None = None,
        patience: float = 60.0,
    ) -> None:
        self.patience = patience
        self._embedded: _Embedded | None = None
        if url is None:
            self._embedded = _Embedded(2 if workers is None else workers, threads, folder)
            url = self._embedded.url
        elif workers is not None or threads is not None or folder is not None:
            raise TypeError("workers, threads and folder are of an embedded service; this one is elsewhere")
        self.url = url
        self._where = option_words(coordinator=url)
        self._where += option_words(
            token_file=token_file, tls_ca=tls_ca, tls_certificate=tls_certificate, tls_key=tls_key
        )

    def __enter__(self) -> Service:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    async def __aenter__(self) -> Service:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await asyncio.to_thread(self.close)

    def close(self) -> None:
        """Ends an embedded service. A service elsewhere continues."""
        if self._embedded is not None:
            self._embedded.close()

    def submit(self, problem: object, **options: Unpack[Options]) -> Job:
        """Submits a problem to the service. `problem` and `options` are those of `solve`."""
        with program.Folder() as folder:
            arguments, own = problem_arguments(problem, options, folder)
            # If the answer is lost and the request is sent again, this id prevents a second job.
            request = ["submit", *option_words(format="json", request_id=uuid.uuid4())]
            finished = self._call([*request, *self._where, *arguments], own=own)
        answer = json.loads(finished.output)
        for warning in answer.get("warnings", []):
            warn(in_the_users_words(warning, own), CognateWarning)
        return Job(self, str(answer["job"]), own)

    async def submit_async(self, problem: object, **options: Unpack[Options]) -> Job:
        """The same as `submit`, for `await`."""
        return await asyncio.to_thread(lambda: self.submit(problem, **options))

    def job(self, job: str) -> Job:
        """The job with this id, for example from another session."""
        return Job(self, job)

    def jobs(self) -> list[dict[str, Any]]:
        """All jobs, newest first, as `cognate jobs --format json` shows them."""
        return self._listing("jobs")

    def workers(self) -> list[dict[str, Any]]:
        """All workers, as `cognate workers --format json` shows them."""
        return self._listing("workers")

    def _listing(self, what: str) -> list[dict[str, Any]]:
        finished = self._call([what, *option_words(format="json"), *self._where])
        found = json.loads(finished.output)[what]
        assert isinstance(found, list), "the program answers with a list"
        return found

    def _call(self, arguments: list[str], own: Own | None = None) -> Finished:
        """Runs a command that may be repeated; waits while no coordinator answers."""
        until = time.monotonic() + self.patience
        while True:
            try:
                return program.run(arguments, own=own)
            except Unreachable:
                self._check()
                if time.monotonic() >= until:
                    raise
            time.sleep(RETRY_SECONDS)

    def _check(self) -> None:
        """Raises if the embedded service has ended for good."""
        if self._embedded is not None:
            self._embedded.check()


class Job:
    """A job of a service. Its `id` stays valid after a restart and from elsewhere."""

    def __init__(self, service: Service, job: str, own: Own | None = None) -> None:
        self.service = service
        self.id = job
        self._own = own or {}

    def __repr__(self) -> str:
        return f"Job({self.id!r}, {self.service.url!r})"

    @property
    def state(self) -> str:
        """`queued`, `running`, `solved`, `failed` or `cancelled`."""
        return str(self.explain()["state"])

    def explain(self) -> dict[str, Any]:
        """The origin of the job's numbers, as `cognate explain --format json` prints it."""
        finished = self.service._call(["explain", *option_words(format="json"), *self._where])
        found = json.loads(finished.output)
        assert isinstance(found, dict), "the program answers with an object"
        return found

    def watch(self) -> Iterator[Progress]:
        """Progress until the job has ended, also across a restart of the coordinator."""
        until = time.monotonic() + self.service.patience
        while True:
            try:
                with program.Run(self._watching) as running:
                    for now in running:
                        until = time.monotonic() + self.service.patience
                        yield now
                    running.finished(ENDED)
                return
            except Unreachable:
                self.service._check()
                if time.monotonic() >= until:
                    raise
            time.sleep(RETRY_SECONDS)

    async def watch_async(self) -> AsyncIterator[Progress]:
        """The same as `watch`, for `async for`."""
        until = time.monotonic() + self.service.patience
        while True:
            try:
                async with program.AsyncRun(self._watching) as running:
                    async for now in running:
                        until = time.monotonic() + self.service.patience
                        yield now
                    await running.finished(ENDED)
                return
            except Unreachable:
                self.service._check()
                if time.monotonic() >= until:
                    raise
            await asyncio.sleep(RETRY_SECONDS)

    def wait(self, *, progress: Wanted = None) -> str:
        """Waits until the job has ended, and returns its state."""
        with Bar(progress) as bar:
            for now in self.watch():
                if bar.watcher is not None:
                    bar.watcher(now)
        return self.state

    async def wait_async(self, *, progress: Wanted = None) -> str:
        """The same as `wait`, for `await`."""
        with Bar(progress) as bar:
            async for now in self.watch_async():
                if bar.watcher is not None:
                    bar.watcher(now)
        return await asyncio.to_thread(lambda: self.state)

    def results(
        self,
        *,
        progress: Wanted = None,
        strict: bool = False,
        output: str | os.PathLike[str] | None = None,
    ) -> Result:
        """Waits for the answer, and returns it. Raises `Cancelled` or `ServiceError` if the job has none.

        `progress`, `strict` and `output` are those of `solve`.
        """
        self.wait(progress=progress)
        return checked(self._read(output), strict)

    async def results_async(
        self,
        *,
        progress: Wanted = None,
        strict: bool = False,
        output: str | os.PathLike[str] | None = None,
    ) -> Result:
        """The same as `results`, for `await`."""
        await self.wait_async(progress=progress)
        return checked(await asyncio.to_thread(self._read, output), strict)

    def cancel(self) -> str:
        """Stops the job, and returns its state. A job that has ended does not change."""
        finished = self.service._call(["cancel", *option_words(format="json"), *self._where])
        return str(json.loads(finished.output)["state"])

    async def cancel_async(self) -> str:
        """The same as `cancel`, for `await`."""
        return await asyncio.to_thread(self.cancel)

    def _read(self, output: str | os.PathLike[str] | None) -> Result:
        kept = None if output is None else Path(output)
        with program.Folder() as folder:
            to = kept or folder.path / "answer"
            self.service._call(["results", *option_words(format="json", output=to), *self._where])
            return result.read(to, output=kept, own=self._own)

    @property
    def _watching(self) -> list[str]:
        return ["watch", *option_words(format="json", progress="json"), *self._where]

    @property
    def _where(self) -> list[str]:
        # After `--` the program reads any text as an id, not as an option.
        return [*self.service._where, "--", self.id]


class _Embedded:
    """A coordinator and workers of this process, run by a keeper (see `_keeper.py`)."""

    def __init__(self, workers: int, threads: int | None, folder: str | os.PathLike[str] | None) -> None:
        if workers < 1:
            raise ValueError(f"expected at least one worker, found {workers}")
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        self._temporary = Path(tempfile.mkdtemp(prefix="cognate-"))
        self._folder = self._temporary if folder is None else Path(folder).absolute()
        self._folder.mkdir(parents=True, exist_ok=True)
        # The path of a socket must be short. The path of a user's folder may be too long.
        self.socket = self._temporary / "coordinator.sock"
        self.url = f"unix:{self.socket}"
        (self._folder / "given_up").unlink(missing_ok=True)
        keeper = Path(__file__).with_name("_keeper.py")
        each = threads if threads is not None else max(1, cores // workers)
        command = [sys.executable, str(keeper), str(self._folder), str(self.socket), program.find()]
        self._keeper = subprocess.Popen(
            [*command, str(workers), str(each)],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            # Ctrl-C goes only to the interpreter, which then ends or keeps the service.
            start_new_session=True,
        )
        try:
            self._wait()
        except BaseException:
            self.close()
            raise

    def _wait(self) -> None:
        until = time.monotonic() + START_SECONDS
        while True:
            self.check()
            # The socket exists before the ledger is open, so only an answer shows that the start is complete.
            if self.socket.exists():
                try:
                    program.run(["workers", *option_words(format="json", coordinator=self.url)])
                    return
                except Unreachable:
                    pass
            if time.monotonic() > until:
                raise ServiceError(f"the coordinator does not answer after {START_SECONDS:.0f} s{self._log()}")
            time.sleep(0.02)

    def check(self) -> None:
        """Raises if the keeper has ended."""
        if self._keeper.poll() is not None:
            raise ServiceError(f"the embedded service has ended{self._log()}")

    def _log(self) -> str:
        """The end of the log of the process that did not start."""
        given_up = self._folder / "given_up"
        name = given_up.read_text() if given_up.exists() else "coordinator"
        log = self._folder / f"{name}.log"
        lines = log.read_text(errors="replace").splitlines()[-12:] if log.exists() else []
        return "".join(f"\n  {line}" for line in lines)

    def close(self) -> None:
        """Ends the keeper; the keeper ends the other processes. A second call is allowed."""
        if self._keeper.stdin is not None and not self._keeper.stdin.closed:
            self._keeper.stdin.close()
        self._keeper.wait()
        shutil.rmtree(self._temporary, ignore_errors=True)
