"""The live page in a real browser: a job from a dropped file to its results, in two widths and two themes."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import PROGRAM, Browser

import cognate as cg
from cognate import program
from conftest import EXAMPLES, until

MECHANISMS = Path(__file__).parent.parent / "mechanisms"

pytestmark = pytest.mark.skipif(PROGRAM is None and not os.environ.get("CI"), reason="no Chromium is installed")


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder for screenshots: COGNATE_SCREENSHOTS."""
    folder = Path(os.environ.get("COGNATE_SCREENSHOTS") or tmp_path_factory.mktemp("pictures"))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@pytest.fixture(scope="module")
def page(service: tuple[str, str]) -> str:
    """The page's address."""
    return service[0]


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str]]:
    """A coordinator with a page and a worker: the page's address, and the coordinator's address."""
    folder = tmp_path_factory.mktemp("page")
    socket = f"unix:{folder}/c.sock"
    found = program.find()
    places = ["--ledger", f"sqlite:{folder}/ledger.db", "--results", str(folder / "results")]
    # The log is a file, because a full pipe without a reader would block the coordinator.
    log = folder / "log"
    with log.open("w") as stderr:
        coordinator = subprocess.Popen(
            [found, "coordinator", "--listen", socket, "--page", "127.0.0.1:0", *places], stderr=stderr
        )
    worker = None
    try:

        def pages() -> list[str]:
            return [line.split()[-1] for line in log.read_text().splitlines() if line.startswith("page at ")]

        assert until(pages), log.read_text()
        url = pages()[0]
        worker = subprocess.Popen(
            [found, "worker", "--coordinator", socket, "--threads", "1"], stderr=subprocess.DEVNULL
        )
        yield url, socket
    finally:
        for process in filter(None, (worker, coordinator)):
            process.terminate()
            process.wait(30)


def drop(name: str, content: str) -> str:
    """A script that drops a file onto the page."""
    return f"""(() => {{ const data = new DataTransfer();
        data.items.add(new File([{json.dumps(content)}], {json.dumps(name)}));
        dispatchEvent(new DragEvent('drop', {{ dataTransfer: data, bubbles: true, cancelable: true }})); }})()"""


def press(words: str) -> str:
    """A script that presses the button with these words."""
    return f"[...document.querySelectorAll('button')].find(b => b.textContent === {json.dumps(words)}).click()"


def shown(word: str) -> str:
    return f"document.getElementById('main').innerText.includes({json.dumps(word)})"


async def submitted(browser: Browser, file: Path) -> None:
    """Drops an example, and watches its job to the end."""
    await browser.run(drop(file.name, file.read_text()))
    await browser.until("location.hash.startsWith('#job/')")
    await browser.until(shown("Every path is accounted for"), 600)


def test_a_job_from_a_dropped_file_to_its_results(page: str, pictures: Path) -> None:
    async def look() -> None:
        async with Browser() as browser:
            await browser.size(1280, 900)
            await browser.go(page)
            await browser.until(shown("No jobs yet"))
            await submitted(browser, EXAMPLES / "cyclic_5.bertini")
            await browser.until(shown("Solutions 1 to 50"))
            text = await browser.run("document.getElementById('main').innerText")
            for words in ("70", "solutions.jsonl", "Solutions 1 to 50, and more follow", "all 70 solutions"):
                assert words in text, text
            await browser.picture(pictures / "job_wide.png")
            await browser.run("document.getElementById('theme').click()")
            await browser.picture(pictures / "job_wide_other_theme.png")
            await browser.size(420, 900)
            await asyncio.sleep(0.3)
            assert await browser.run("document.documentElement.scrollWidth <= 420"), "nothing sticks out"
            await browser.picture(pictures / "job_narrow.png")
            for view in ("jobs", "workers", "submit"):
                await browser.size(1280, 900)
                await browser.run(f"location.hash = '#{view}'")
                await browser.until(shown({"jobs": "cyclic_5", "workers": "1 workers", "submit": "Drop a file"}[view]))
                await browser.picture(pictures / f"{view}_wide.png")
                await browser.size(420, 900)
                await browser.picture(pictures / f"{view}_narrow.png")
                assert await browser.run("document.documentElement.scrollWidth <= 420"), view
            for number, digits, words in ((4.9e-20, 2, "4.9e-20"), (100, 4, "100"), (1e10, 3, "10000000000")):
                assert await browser.run(f"short({number}, {digits})") == words
            assert browser.log == []

    asyncio.run(look())


def test_mistakes_are_shown_where_they_are_made(page: str) -> None:
    async def look() -> None:
        async with Browser() as browser:
            await browser.go(page + "#submit")
            await browser.until(shown("Drop a file"))
            await browser.run(drop("wrong.bertini", "variable_group x; function f;\nf = x^2 - ;\nEND;\n"))
            await browser.until(shown("wrong.bertini:2:11"))
            await browser.run(drop("<img src=x onerror=alert(1)>.bertini", "nothing"))
            await browser.until(shown("<img src=x onerror"))
            assert await browser.run("document.querySelector('img') === null"), "names are no HTML"

    asyncio.run(look())


def test_the_page_is_used_by_keyboard_and_read_aloud(page: str) -> None:
    async def look() -> None:
        async with Browser() as browser:
            await browser.go(page)
            await browser.until("document.querySelectorAll('tbody tr').length > 0")
            reached: list[str] = []
            for _ in range(12):
                for kind in ("keyDown", "keyUp"):
                    await browser.call(
                        "Input.dispatchKeyEvent", type=kind, key="Tab", code="Tab", windowsVirtualKeyCode=9
                    )
                reached.append(await browser.run("document.activeElement.textContent.trim().slice(0, 30)"))
            for name in ("To the content", "Jobs", "Workers", "Submit", "cyclic_5.bertini"):
                assert name in reached, reached
            tree = await browser.call("Accessibility.getFullAXTree")
            roles: dict[str, int] = {}
            for node in tree["nodes"]:
                role = node.get("role", {}).get("value", "")
                roles[role] = roles.get(role, 0) + 1
                if role in ("button", "link", "progressbar", "textbox", "combobox", "image"):
                    assert node["name"]["value"], f"a {role} without a name"
            for role in ("main", "navigation", "table", "columnheader", "progressbar", "heading", "status"):
                assert roles.get(role), roles

    asyncio.run(look())


def test_a_browser_that_does_not_start_is_started_again(tmp_path: Path) -> None:
    program = tmp_path / "browser"
    program.write_text(f"""#!/bin/sh
if ! [ -e {tmp_path}/started ]; then touch {tmp_path}/started; exit 1; fi
exec {PROGRAM} "$@"
""")
    program.chmod(0o755)

    async def look() -> None:
        async with Browser(str(program)) as browser:
            assert await browser.run("1 + 1") == 2

    asyncio.run(look())


def test_long_lists_come_in_pages(page: str) -> None:
    async def look() -> None:
        content = b"variable_group x; function f; f = x - 1; END;"
        for k in range(250):
            request = urllib.request.Request(
                f"{page}api/jobs?name=many_{k}", data=content, headers={"X-Cognate": "page"}, method="POST"
            )
            with urllib.request.urlopen(request, timeout=600) as answer:
                assert answer.status == 200
        async with Browser() as browser:
            await browser.go(page)
            await browser.until("document.querySelectorAll('tbody tr').length === 100")
            for name in ("many_149", "many_0"):
                await browser.run(
                    "[...document.querySelectorAll('button')].find(b => b.textContent === 'Older').click()"
                )
                await browser.until(shown(name))
            assert await browser.run(
                "[...document.querySelectorAll('button')].find(b => b.textContent === 'Older').disabled"
            )

    asyncio.run(look())


def test_parts_of_a_list_are_those_of_the_whole_over_all_targets(service: tuple[str, str]) -> None:
    url, socket = service
    family = cg.System(["x^2 + y^2 - p", "x*y - q"], parameters="p q")
    with cg.Service(socket) as known:
        base = cg.solve(family, start="monodromy", expect=4)
        job = known.submit(family, start=base, targets=[[4, 1], [5, 0.5], [1, 2]])
        assert len(job.results().targets) == 3

    def read(path: str) -> bytes:
        with urllib.request.urlopen(f"{url}api/results/{job.id}/{path}", timeout=600) as answer:
            content: bytes = answer.read()
            return content

    whole = [json.loads(line) for line in read("solutions.jsonl").splitlines()]
    assert [s["target"] for s in whole] == [k // 4 for k in range(12)]
    for first in range(14):
        part = json.loads(read(f"solutions?from={first}&limit=5"))
        assert part["solutions"] == whole[first : first + 5], first
        assert part["more"] == (first + 5 < 12)


def test_mechanisms_move(page: str, pictures: Path) -> None:
    async def look() -> None:
        async with Browser() as browser:
            await browser.size(1280, 1100)
            await browser.go(page)
            await browser.until("!document.getElementById('to-mechanism').hidden")
            arm = MECHANISMS / "arm_puma560" / "arm.json"
            await browser.run("location.hash = '#mechanism'")
            await browser.until(shown("Drop a mechanism here"))
            await browser.run(drop("arm.json", arm.read_text()))
            await browser.until(shown("poses of its output"))
            await browser.run("document.getElementById('prove').click()")
            await browser.run(press("Show its positions"))
            await browser.until(shown("Position 1.1, real and proved"), 600)
            assert await browser.run(shown("8 complex, 8 real, 8 proved real"))
            await browser.run("document.getElementById('ghosts').click()")
            await browser.picture(pictures / "mechanism_arm.png")
            before = await browser.run("document.querySelector('canvas').toDataURL()")
            await browser.run(press("1.3"))
            assert before != await browser.run("document.querySelector('canvas').toDataURL()"), "another position"
            # An input with a full turn: the page shows branches, and a slider for each branch.
            linkage = MECHANISMS / "stephenson" / "mechanism.json"
            await browser.run(drop("mechanism.json", linkage.read_text()))
            await browser.until("document.getElementById('targets')?.value.startsWith('A0')")
            await browser.run("document.getElementById('targets').value = 'A0\\n0\\n3\\n6\\n'")
            await browser.run("document.getElementById('follow').click()")
            await browser.run(press("Show its positions"))
            await browser.until(shown("branch 4"), 600)
            await browser.run(press("branch 2"))
            await browser.run(press("Play"))
            await browser.until("Number(document.querySelector('input[type=range]').value) > 5")
            await browser.run(press("Stop"))
            await browser.size(420, 1100)
            assert await browser.run("document.documentElement.scrollWidth <= 420"), "nothing sticks out"
            await browser.picture(pictures / "mechanism_branches.png")
            # A cancelled solve ends, so the next solve can start.
            await browser.run(press("Show its positions") + ";" + press("Cancel"))
            await browser.until(shown("Cancelled."))
            await browser.run(press("Show its positions"))
            await browser.until(shown("branch 4"), 600)
            await browser.run(drop("wrong.urdf", "<robot"))
            await browser.until(shown("wrong.urdf:1"))
            assert browser.log == [] or all("400" in line for line in browser.log), browser.log

    asyncio.run(look())


def test_real_curves_are_drawn(service: tuple[str, str], pictures: Path, tmp_path: Path) -> None:
    url, socket = service
    file = tmp_path / "curve.bertini"
    file.write_text("variable_group x, y, z; function f, g; f = x^2 + y^2 + z^2 - 4; g = (x - 1)^2 + y^2 - 1; END;")

    def ask(*words: str) -> dict[str, Any]:
        answer = subprocess.run(
            [program.find(), *words, "--format", "json"], capture_output=True, text=True, check=True
        )
        found: dict[str, Any] = json.loads(answer.stdout)
        return found

    ask("decompose", str(file), "--output", str(tmp_path / "set"))
    ask("real-curve", str(tmp_path / "set"), "--coordinator", socket)

    async def look() -> None:
        async with Browser() as browser:
            await browser.size(1280, 1100)
            await browser.go(url)
            await browser.until("[...document.querySelectorAll('tbody a')].some(a => a.textContent.includes('curve'))")
            await browser.run(
                "[...document.querySelectorAll('tbody a')].find(a => a.textContent.includes('curve')).click()"
            )
            await browser.until(shown("Real part"))
            await asyncio.sleep(0.3)
            await browser.picture(pictures / "real_curve.png")
            empty = await browser.run(
                """(() => { const c = document.querySelector('canvas');
                   const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
                   return !d.some((x, k) => k % 4 === 0 && x > 150 && d[k + 1] < 80); })()"""
            )
            assert not empty, "the curve is drawn in red"
            assert browser.log == []

    asyncio.run(look())


def test_a_solve_has_a_page(tmp_path: Path) -> None:
    solve = subprocess.Popen(
        [program.find(), "solve", str(EXAMPLES / "three_rpr.bertini"), "--workers", "1", "--page", "--format", "json"],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert solve.stderr is not None
        url = next(line.split()[-1] for line in solve.stderr if line.startswith("page at "))

        async def look() -> None:
            async with Browser() as browser:
                await browser.go(url)
                await browser.until(shown("three_rpr"))
                await browser.until(shown("solved"))

        asyncio.run(look())
    finally:
        time.sleep(0.2)
        solve.send_signal(2)
        output, _ = solve.communicate(timeout=600)
    assert json.loads(output)["solutions"]["distinct"] == 6
    assert solve.returncode == 0
