"""Programs that stay open between solves: threads, forks, Ctrl-C, killed programs; same answers as new processes."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import textwrap
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import cognate as cg
from cognate import kept
from conftest import katsura, until

SMALL = ["x^2 + y^2 - 4", "x*y - 1"]


@pytest.fixture(autouse=True)
def no_program_before() -> Iterator[None]:
    """Starts each test without an open program."""
    kept.close()
    yield
    kept.close()


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """The opened programs, in their order."""
    opened: list[subprocess.Popen[bytes]] = []

    class Counted(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            if "serve" in arguments[0]:
                opened.append(self)

    monkeypatch.setattr(subprocess, "Popen", Counted)
    return opened


def same(one: cg.Result, other: cg.Result) -> bool:
    """True if two answers are the same except names and times."""
    left_out = ("job", "seconds", "summary", "output")
    fields = [field.name for field in dataclasses.fields(cg.Result) if field.name not in left_out]
    varying = ("job", "time", "workers")
    summaries = [{k: v for k, v in answer.summary.items() if k not in varying} for answer in (one, other)]
    return summaries[0] == summaries[1] and all(getattr(one, name) == getattr(other, name) for name in fields)


CASES: list[tuple[Any, dict[str, Any]]] = [
    (SMALL, {}),
    (SMALL, {"certify": True, "digits": 30}),
    (["x^3 - 3*x + 1", "y^2 - x"], {"where": "x > 0", "sort": "-y"}),
    (["x^2 + 3*y^2 = 1"], {"minimize": "(x - 2)^2 + y^2", "real": True}),
    (["(x - 1)^2*(x + 2)", "y - x"], {}),
    (["sqrt(x + 3) = x", "y = x"], {}),
    ("x^2 = 2; y = 3 - x*y", {"seed": 5, "preset": "careful"}),
    (cg.System(["x^2 + y^2 - p", "x*y - q"], parameters="p q"), {"start": "monodromy", "expect": 4}),
]


@pytest.mark.parametrize("problem, options", CASES)
def test_an_answer_is_that_of_a_process_of_its_own(
    problem: Any, options: dict[str, Any], tmp_path: Path, started: list[Any]
) -> None:
    # A solve with an output folder runs in a new process.
    alone = cg.solve(problem, output=tmp_path / "alone", **options)
    assert not started
    twice = [cg.solve(problem, **options) for _ in range(2)]
    assert len(started) == 1
    assert all(same(one, alone) for one in twice)


@pytest.mark.parametrize(
    "problem, options",
    [
        (["x^2 - 1", "x + $"], {}),
        (["x^2 - 1"], {"start": "nonsense"}),
        (["x^2 - 1"], {"idle_loops": 3}),
        (Path("no_such_file.bertini"), {}),
        (["x + y"], {}),
    ],
)
def test_a_mistake_is_refused_in_the_same_words(problem: Any, options: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(cg.InputError) as alone:
        cg.solve(problem, output=tmp_path, **options)
    with pytest.raises(cg.InputError) as here:
        cg.solve(problem, **options)
    for name in ("args", "file", "line", "column", "field", "reason"):
        assert getattr(here.value, name) == getattr(alone.value, name), name
    # The program stays open for the next solve.
    assert len(cg.solve(SMALL)) == 4


def test_many_systems_take_one_program(started: list[Any]) -> None:
    for k in range(100):
        (solution,) = cg.solve([f"3*x - {k}"])
        assert abs(solution["x"] - k / 3) < 1e-12
    assert len(started) == 1


def test_another_folder_and_another_environment_take_another_program(
    started: list[Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "system.txt").write_text("x^2 = 2\n")
    cg.solve(SMALL)
    monkeypatch.chdir(tmp_path)
    assert len(cg.solve(Path("system.txt"))) == 2
    assert len(started) == 2
    monkeypatch.setenv("COGNATE_TEST", "1")
    cg.solve(SMALL)
    assert len(started) == 3
    # The programs of the other folder and of the other environment have ended.
    assert [one.poll() is None for one in started] == [False, False, True]


def test_threads_have_a_program_each(started: list[Any]) -> None:
    failed: list[BaseException] = []
    together = threading.Barrier(4)

    def work(k: int) -> None:
        try:
            together.wait()
            for j in range(20):
                (solution,) = cg.solve([f"x - {100 * k + j}"])
                assert solution["x"] == 100 * k + j
        except BaseException as e:
            failed.append(e)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    # Warning filters belong to the process, so the threads share the test's filters.
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed, failed
    assert 1 <= len(started) <= 4


def test_a_child_of_fork_has_programs_of_its_own() -> None:
    cg.solve(SMALL)
    (ours,) = kept.open_processes()
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        # No code of pytest may run here.
        code = 1
        try:
            theirs = [len(cg.solve([f"x^2 - {k + 2}"])) for k in range(3)]
            other = kept.open_processes()
            if theirs == [2, 2, 2] and len(other) == 1 and other[0] != ours:
                os.write(write, b"right")
                code = 0
            kept.close()
        finally:
            os._exit(code)
    os.close(write)
    counts = [len(cg.solve([f"x^3 - {k + 2}"])) for k in range(3)]
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0 and os.read(read, 100) == b"right"
    os.close(read)
    assert counts == [3, 3, 3] and kept.open_processes() == (ours,)


def test_a_child_of_fork_keeps_no_program_of_its_parent_alive() -> None:
    script = """
        import os, sys, time
        import cognate as cg
        from cognate import kept
        cg.solve(["x^2 - 2"])
        (program,) = kept.open_processes()
        if os.fork() == 0:
            sys.stdin.read()
            os._exit(0)
        print(program, flush=True)
        os._exit(0)          # without a farewell, as where the interpreter is killed
    """
    python = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert python.stdin is not None and python.stdout is not None
    program = int(python.stdout.readline())
    assert python.wait() == 0
    # The child still waits, and the program has ended.
    assert until(lambda: not os.path.exists(f"/proc/{program}") or " Z " in Path(f"/proc/{program}/stat").read_text())
    python.stdin.close()
    python.stdout.close()


def children(process: int) -> list[int]:
    """Process ids of the children of a process."""
    listed = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process)], capture_output=True, text=True)
    return [int(pid) for pid in listed.stdout.split()]


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Makes Ctrl-C raise KeyboardInterrupt, also in a background job of a shell, which ignores it by default."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_the_solve_and_nothing_else(started: list[Any]) -> None:
    begun = threading.Event()
    workers: list[int] = []

    def interrupt() -> None:
        begun.wait()
        # A long solve has workers.
        until(lambda: len(children(started[0].pid)) >= 2)
        workers.extend(children(started[0].pid))
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        cg.solve(katsura(14), progress=lambda now: begun.set())
    thread.join()
    assert len(workers) == 2
    assert started[0].poll() is not None, "what was interrupted has ended"
    assert until(lambda: not any(os.path.exists(f"/proc/{worker}") for worker in workers))
    assert len(cg.solve(SMALL)) == 4
    assert len(started) == 2


def test_a_program_that_was_killed_is_opened_again(started: list[Any]) -> None:
    cg.solve(SMALL)
    started[0].kill()
    started[0].wait()
    assert len(cg.solve(SMALL)) == 4
    assert len(started) == 2


def test_a_program_that_is_killed_while_it_solves(started: list[Any]) -> None:
    """A killed program that has answered before is replaced. A killed new program raises an error."""

    def kill_first(now: object) -> None:
        started[0].kill()

    with pytest.raises(cg.ServiceError, match=r"exit code -9"):
        cg.solve(katsura(11), progress=kill_first)
    assert len(started) == 1

    cg.solve(SMALL)
    assert len(started) == 2

    def kill_second(now: object) -> None:
        started[1].kill()

    found = cg.solve(katsura(9), progress=kill_second)
    assert len(found) == 512 and len(started) == 3


def test_a_program_ends_with_the_interpreter() -> None:
    script = "import cognate as cg; from cognate import kept; cg.solve(['x^2 - 2']); print(*kept.open_processes())"
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    program = int(ended.stdout)
    assert ended.stderr == "" and not os.path.exists(f"/proc/{program}")
