"""Keeper: a process that runs a coordinator and workers, and ends them when its standard input ends.

`Service` starts this script. The keeper ends with the `Service` and with the interpreter, however they end.
It restarts dead processes. The coordinator's ledger stores everything, so jobs continue.
Usage: _keeper.py FOLDER SOCKET PROGRAM WORKERS THREADS
"""

from __future__ import annotations

import ctypes
import os
import select
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import IO

LOOK_SECONDS = 0.1
"""Seconds between two checks of the processes."""

STOP_SECONDS = 5.0
"""Seconds that the processes have for their end before a kill."""

SHORT_LIFE_SECONDS = 2.0
"""Seconds of life below which a start counts as failed."""

MOST_SHORT_LIVES = 5
"""Failed starts in a row after which the keeper gives up."""

ORPHAN_SECONDS = 60
"""Seconds without a coordinator after which a worker ends; the keeper has then ended too."""

PR_SET_PDEATHSIG = 1
"""Option of prctl (Linux) that sets the signal for a process whose parent dies."""


class Kept:
    """One process, with the number of its failed starts in a row."""

    def __init__(self, name: str, command: list[str], folder: Path) -> None:
        self.name = name
        self.command = command
        self.log = folder / f"{name}.log"
        self.process: subprocess.Popen[bytes] | None = None
        self.short_lives = 0
        self.started = 0.0

    def look(self, now: float) -> bool:
        """Starts the process if it does not run. False after `MOST_SHORT_LIVES` failed starts."""
        if self.process is not None and self.process.poll() is None:
            return True
        if self.process is not None:
            lived = now - self.started
            self.short_lives = self.short_lives + 1 if lived < SHORT_LIFE_SECONDS else 0
        if self.short_lives >= MOST_SHORT_LIVES:
            return False
        log: IO[bytes]
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(
                self.command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                # The keeper has one thread, so the signal comes only when the whole keeper dies.
                preexec_fn=die_with_parent,
            )
        self.started = now
        pid = self.log.with_suffix(".pid")
        pid.write_text(str(self.process.pid))
        return True

    def terminate(self) -> None:
        if self.process is not None and self.process.poll() is None:
            self.process.terminate()

    def wait(self, until: float) -> None:
        if self.process is None:
            return
        try:
            self.process.wait(max(0.0, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def die_with_parent() -> None:
    """On Linux: makes this process end with its parent."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def main() -> int:
    """Runs the processes until standard input ends."""
    folder, socket, program = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    workers, threads = int(sys.argv[4]), int(sys.argv[5])
    coordinator = [program, "coordinator", "--listen", f"unix:{socket}"]
    coordinator += ["--ledger", f"sqlite:{folder / 'ledger.db'}", "--results", str(folder / "results")]
    worker = [program, "worker", "--coordinator", f"unix:{socket}", "--threads", str(threads)]
    worker += ["--give-up-after", str(ORPHAN_SECONDS)]
    kept = [Kept("coordinator", coordinator, folder)]
    kept += [Kept(f"worker-{i + 1}", worker, folder) for i in range(workers)]
    exit_code = 0
    while True:
        now = time.monotonic()
        lost = [k for k in kept if not k.look(now)]
        if lost:
            (folder / "given_up").write_text(lost[0].name)
            exit_code = 1
            break
        ready, _, _ = select.select([sys.stdin.fileno()], [], [], LOOK_SECONDS)
        if ready and not os.read(sys.stdin.fileno(), 1024):
            break
    # A path gives the same result anywhere, so a worker may drop its chunks.
    for k in reversed(kept):
        k.terminate()
    until = time.monotonic() + STOP_SECONDS
    for k in reversed(kept):
        k.wait(until)
    if exit_code == 0:
        # The folder of the socket is temporary, and its creator may be dead. After a failure the folder stays,
        # because its logs are still needed.
        shutil.rmtree(Path(socket).parent, ignore_errors=True)
    return exit_code


if __name__ == "__main__":
    sys.exit(main())
