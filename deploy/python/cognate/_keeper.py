"""Keeper: a process that holds a coordinator and workers, and ends them when its standard input ends.

A script of its own: it is started by `Service` and outlives neither it nor the interpreter, however that ends.
What dies is started again; the coordinator remembers everything in its ledger, so jobs go on.
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
"""Between two looks at the processes."""

STOP_SECONDS = 5.0
"""How long they may take to end."""

SHORT_LIFE_SECONDS = 2.0
"""A process that ended sooner after its start did not come up."""

MOST_SHORT_LIVES = 5
"""So many short lives in a row, and the keeper gives up."""

ORPHAN_SECONDS = 60
"""A worker ends after so many seconds without a coordinator: the keeper is gone, too."""

PR_SET_PDEATHSIG = 1
"""Of prctl (Linux): the signal that a process gets when its parent dies."""


class Kept:
    """One process and how often it did not come up."""

    def __init__(self, name: str, command: list[str], folder: Path) -> None:
        self.name = name
        self.command = command
        self.log = folder / f"{name}.log"
        self.process: subprocess.Popen[bytes] | None = None
        self.short_lives = 0
        self.started = 0.0

    def look(self, now: float) -> bool:
        """Starts the process where it does not run; False where that has been in vain too often."""
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
                # This process has one thread, so that the parent that dies is the keeper.
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
    """On Linux: this process ends with its parent."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def main() -> int:
    """Keeps the processes until standard input ends."""
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
    # Paths are pure: a worker need not finish what it holds.
    for k in reversed(kept):
        k.terminate()
    until = time.monotonic() + STOP_SECONDS
    for k in reversed(kept):
        k.wait(until)
    if exit_code == 0:
        # The folder of the socket is a temporary one, whose maker may have been killed. After a failure its logs
        # are still to be read.
        shutil.rmtree(Path(socket).parent, ignore_errors=True)
    return exit_code


if __name__ == "__main__":
    sys.exit(main())
