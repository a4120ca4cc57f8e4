"""The live page with 10,000 jobs and a job of 10^6 solutions, in a real browser.

How long lists and pictures take, and how long the page is busy at once. `run.py [--jobs N] [--power P]`;
COGNATE_PROGRAM is the program. Prints a table.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import subprocess
import sys
import tempfile
import time
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2] / "python"))
from browser import Browser

LONGEST = """new Promise(done => { let last = performance.now(), longest = 0; const end = last + %d;
  const look = () => { const now = performance.now(); longest = Math.max(longest, now - last); last = now;
    if (now < end) setTimeout(look, 0); else done(longest); };
  setTimeout(look, 0); })"""
"""The longest that the page was busy at once in so many milliseconds, in milliseconds."""


def got(url: str) -> tuple[float, bytes]:
    """Seconds until an answer was there, and the answer."""
    start = time.monotonic()
    with urllib.request.urlopen(url, timeout=600) as answer:
        content = answer.read()
    return time.monotonic() - start, content


def posted(url: str, content: bytes) -> dict[str, Any]:
    """What the page answers to a file."""
    request = urllib.request.Request(url, data=content, headers={"X-Cognate": "page"}, method="POST")
    with urllib.request.urlopen(request, timeout=600) as answer:
        found: dict[str, Any] = json.load(answer)
        return found


def resident(process: subprocess.Popen[bytes]) -> float:
    """Memory of a process in MB."""
    for line in Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return 0.0


async def of_jobs(url: str, row: Any) -> None:
    """The list of jobs in a browser."""
    async with Browser() as browser:
        start = time.monotonic()
        await browser.go(url)
        await browser.until("document.querySelectorAll('tbody tr').length === 100")
        row("list of jobs is there, in the browser", time.monotonic() - start)
        row("busy at once while it is looked at, at most", await browser.run(LONGEST % 5000) / 1000)
        start = time.monotonic()
        await browser.run("location.hash = '#jobs/9900'")
        await browser.until("document.getElementById('main').innerText.includes('9,901 to')")
        row("the jobs from 9,900 on", time.monotonic() - start)


async def of_solutions(url: str, job: str, row: Any) -> None:
    """A job's solutions in a browser."""
    async with Browser() as browser:
        start = time.monotonic()
        await browser.go(f"{url}#job/{job}")
        await browser.until("document.getElementById('main').innerText.includes('Solutions 1 to 50')", 300)
        row("10^6 solutions: picture and table are there", time.monotonic() - start)
        row("busy at once afterwards, at most", await browser.run(LONGEST % 3000) / 1000)
        start = time.monotonic()
        await browser.run(
            "const s = document.getElementById('coordinate'); s.value = '1'; s.dispatchEvent(new Event('change'))"
        )
        row("the plane of another coordinate", time.monotonic() - start)
        start = time.monotonic()
        await browser.run("[...document.querySelectorAll('button')].find(b => b.textContent === 'After').click()")
        await browser.until("document.getElementById('main').innerText.includes('Solutions 51 to 100')", 60)
        row("the next 50 in the table", time.monotonic() - start)
        heap = await browser.run("performance.memory ? performance.memory.usedJSHeapSize / 1e6 : 0")
        print(f"| memory of the page's script | {heap:.0f} MB |")


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--jobs", type=int, default=10_000)
    parser.add_argument("--power", type=int, default=10, help="the large job has this to the sixth solutions")
    wanted = parser.parse_args()
    program = os.environ["COGNATE_PROGRAM"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        log = folder / "log"
        places = ["--ledger", f"sqlite:{folder}/ledger.db", "--results", str(folder / "results")]
        with log.open("w") as stderr:
            coordinator = subprocess.Popen(
                [program, "coordinator", "--listen", f"unix:{folder}/c", "--page", "127.0.0.1:0", *places],
                stderr=stderr,
            )
        while "page at " not in log.read_text():
            time.sleep(0.1)
        url = next(line.split()[-1] for line in log.read_text().splitlines() if line.startswith("page at "))
        worker = subprocess.Popen([program, "worker", "--coordinator", f"unix:{folder}/c"], stderr=subprocess.DEVNULL)

        def row(what: str, seconds: float) -> None:
            print(f"| {what} | {seconds:.3g} s |", flush=True)

        try:
            start = time.monotonic()
            small = b"variable_group x; function f; f = x^2 - 2; END;"
            with ThreadPoolExecutor(8) as pool:
                list(pool.map(lambda k: posted(f"{url}api/jobs?name=small_{k}", small), range(wanted.jobs)))
            row(f"{wanted.jobs} jobs submitted by the page's address", time.monotonic() - start)
            asyncio.run(of_jobs(url, row))
            names = [f"x{i}" for i in range(6)]
            equations = "".join(f"f{i} = x{i}^{wanted.power} - {i + 2};" for i in range(6))
            functions = ", ".join(f"f{i}" for i in range(6))
            text = f"variable_group {', '.join(names)}; function {functions}; {equations} END;"
            start = time.monotonic()
            job = posted(f"{url}api/jobs?name=large&start=total-degree", text.encode())["job"]
            while json.loads(got(f"{url}api/jobs/{job}/progress")[1])["state"] != "solved":
                time.sleep(1)
            row("the large job is solved, behind the small ones", time.monotonic() - start)
            asyncio.run(of_solutions(url, job, row))
            total = wanted.power**6
            for first in (0, total // 2, total - 50):
                row(
                    f"50 solutions from {first:,} on, the answer",
                    got(f"{url}api/results/{job}/solutions?from={first}&limit=50")[0],
                )
            print(f"| memory of the coordinator | {resident(coordinator):.0f} MB |")
        finally:
            for process in (worker, coordinator):
                process.terminate()
                process.wait(60)


main()
