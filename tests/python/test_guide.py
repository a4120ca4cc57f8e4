"""The guide (deploy/guide) and README: every command and output of their pages, their files, links, and the site."""

from __future__ import annotations

import asyncio
import doctest
import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import browser
import pytest

import cognate.program
import guide
from conftest import EXAMPLES, REPOSITORY

FOLDER = REPOSITORY / "deploy" / "guide"
PAGES = FOLDER / "pages"
NAMES = sorted(str(page.relative_to(PAGES)) for page in PAGES.rglob("*.md"))
# Pages whose programs need more Python packages than ours, and the variable that names a Python with these packages.
OTHER_PYTHON = {"tasks/grpc.md": "COGNATE_STRANGER_PYTHON"}
# Pages whose commands need a program from the system's packages.
OTHER_PROGRAM = {"tasks/grpc_cpp.md": "grpc_cpp_plugin"}
FRONT_PAGE = "README.md"
# A line of progress comes after five seconds, which is a matter of the machine.
PROGRESS = re.compile(r"[a-z ]+: [\d,]+ of [\d,]+ [a-z]+, [\d.,]+ [a-z]+/s, [\d.]+ s")
SERVICE = re.compile(r"127\.0\.0\.1:7654")


@pytest.fixture(scope="session")
def machine(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of the pages' commands: `cognate` on the PATH, its own cache, a terminal of 100 columns."""
    home = tmp_path_factory.mktemp("guide")
    (home / "bin").mkdir()
    (home / "bin" / "cognate").symlink_to(Path(cognate.program.find()).resolve())
    return {
        "PATH": f"{home / 'bin'}{os.pathsep}{os.environ['PATH']}",
        "XDG_CACHE_HOME": str(home / "cache"),
        "COLUMNS": "100",
        "NO_COLOR": "1",
    }


@pytest.fixture
def free_port() -> int:
    """A free port of this machine."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@pytest.mark.parametrize("name", [*NAMES, FRONT_PAGE])
def test_commands_and_outputs(
    name: str, machine: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, free_port: int
) -> None:
    page = REPOSITORY / name if name == FRONT_PAGE else PAGES / name
    text = page.read_text()
    (tmp_path / "examples").symlink_to(EXAMPLES)
    (tmp_path / "proto").symlink_to(REPOSITORY / "proto")
    all_commands = []
    for block in guide.blocks(text):
        if block.title and block.title.startswith("examples/"):
            assert guide.shown_file(block, EXAMPLES / block.title.removeprefix("examples/")), block.title
        elif block.title:
            file = tmp_path / block.title
            assert not file.exists(), f"two files {block.title}"
            file.write_text("\n".join(block.lines) + "\n")
        elif block.language == "console":
            all_commands += guide.commands(block)
    environment = dict(machine)
    if name in OTHER_PYTHON:
        python = os.environ.get(OTHER_PYTHON[name], "")
        if not python:
            pytest.skip(f"{OTHER_PYTHON[name]} is not set")
        environment["PATH"] = f"{Path(python).parent}{os.pathsep}{machine['PATH']}"
    if name in OTHER_PROGRAM and shutil.which(OTHER_PROGRAM[name]) is None:
        pytest.skip(f"{OTHER_PROGRAM[name]} is not installed")
    # The page's service gets a free port.
    address = f"127.0.0.1:{free_port}"
    environment["COGNATE_COORDINATOR"] = f"http://{address}"
    for command in all_commands:
        command.text = SERVICE.sub(address, command.text)
    for file in tmp_path.glob("*.py"):
        file.write_text(SERVICE.sub(address, file.read_text()))
    guide.run(all_commands, tmp_path, environment)
    for command in all_commands:
        command.actual = [
            SERVICE.sub("127.0.0.1:7654", line.replace(address, "127.0.0.1:7654"))
            for line in command.actual
            if not PROGRESS.fullmatch(line)
        ]
    if os.environ.get("UPDATE_GOLDEN"):
        page.write_text(guide.rewritten(text, all_commands))
    wrong = []
    for place, command in enumerate(all_commands):
        if not guide.agrees(command.expected, command.actual):
            wrong.append(f"$ {command.text}\n" + "\n".join(command.actual))
        is_asked = all_commands[place + 1 :] and all_commands[place + 1].text == "echo $?"
        if command.status != 0 and not is_asked:
            wrong.append(f"$ {command.text}\nends with exit code {command.status}, and no `$ echo $?` follows")
    assert not wrong, f"{name}: another output than shown\n\n" + "\n\n".join(wrong)

    for key, value in machine.items():
        monkeypatch.setenv(key, value)
    monkeypatch.chdir(tmp_path)
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    failed, _ = doctest.testfile(str(page), module_relative=False, optionflags=options)
    assert failed == 0


def test_pages_are_in_the_menu() -> None:
    menu = (FOLDER / "mkdocs.yml").read_text().partition("\nnav:")[2]
    assert sorted(re.findall(r"[\w/]+\.md", menu)) == NAMES


def test_every_task_shows_a_command() -> None:
    for name in NAMES:
        if name.startswith("tasks/"):
            languages = {block.language for block in guide.blocks((PAGES / name).read_text())}
            assert languages & {"console", "python"}, name


def anchor(heading: str) -> str:
    """The anchor that MkDocs makes from a heading."""
    kept = re.sub(r"[^\w\s-]", "", heading.replace("`", "")).strip().lower()
    return re.sub(r"[-\s]+", "-", kept)


def test_links_lead_somewhere() -> None:
    wrong = []
    for name in NAMES:
        page = PAGES / name
        prose = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
        for link in re.findall(r"\]\(([^)\s]+)\)", prose):
            target, _, place = link.partition("#")
            if "://" in target:
                continue
            file = page if not target else page.parent / target
            if not file.exists():
                wrong.append(f"{name}: {link}")
            elif place and file.suffix == ".md":
                headings = re.findall(r"^#+ (.*)$", file.read_text(), flags=re.MULTILINE)
                if place not in map(anchor, headings):
                    wrong.append(f"{name}: {link}")
    assert not wrong, wrong


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built without a warning."""
    environment = REPOSITORY / "target" / "guide" / "requirements.txt"
    if not environment.exists() or environment.read_text() != (FOLDER / "requirements.txt").read_text():
        pytest.skip("target/guide is not there: tests/run.sh and deploy/guide/build.sh make it")
    folder = tmp_path_factory.mktemp("site")
    program = str(Path(cognate.program.find()).resolve())
    build = subprocess.run(
        [str(FOLDER / "build.sh"), str(folder)],
        env={**os.environ, "COGNATE_PROGRAM": program},
        capture_output=True,
        text=True,
    )
    assert build.returncode == 0, build.stdout + build.stderr
    return folder


def test_the_site_loads_nothing_from_a_network(site: Path) -> None:
    loaded = re.compile(
        r'<(?:script|img|iframe|source)\b[^>]*\bsrc="(?:https?:)?//[^"]*"'
        r'|<link\b[^>]*rel="(?:stylesheet|preconnect|icon|preload)"[^>]*href="(?:https?:)?//[^"]*"'
        r"|@import[^;]*//[^;]*|url\(['\"]?(?:https?:)?//[^)]*\)"
    )
    for file in [*site.rglob("*.html"), *site.rglob("*.css")]:
        assert not loaded.findall(file.read_text()), file


def test_the_site_is_whole(site: Path) -> None:
    for name in NAMES:
        assert (site / name).with_suffix(".html").exists(), name
    commands = (site / "reference" / "commands.html").read_text()
    for words in ["cognate solve", "cognate mechanism inverse", "cognate synthesize nine-point"]:
        assert f"<code>{words}</code>" in commands, words


@pytest.mark.skipif(browser.PROGRAM is None, reason="no Chromium is installed")
def test_the_site_in_a_browser(site: Path) -> None:
    """The site is opened as a folder: the search answers, and no page is wider than its window."""

    async def look() -> None:
        async with browser.Browser() as page:
            for width in (390, 820, 1400):
                await page.size(width, 900)
                for name in ("index", "tasks/arm", "tasks/other_programs", "theory/paths", "reference/python"):
                    await page.go((site / f"{name}.html").as_uri())
                    assert await page.run("document.documentElement.scrollWidth") <= width, (name, width)
                    if pictures := os.environ.get("COGNATE_SCREENSHOTS"):
                        await page.picture(Path(pictures) / f"guide-{name.replace('/', '-')}-{width}.png")
            await page.go((site / "tasks" / "arm.html").as_uri())
            await page.run("document.querySelector('.md-search__input').focus()")
            await page.call("Input.insertText", text="trace test")
            await page.until("document.querySelector('.md-search-result__item a')", 60)
            assert "components.html" in await page.run("document.querySelector('.md-search-result__list').innerHTML")
            assert not page.log, page.log

    asyncio.run(look())


def test_scripts_can_be_read() -> None:
    bash = shutil.which("bash")
    assert bash and subprocess.run([bash, "-n", str(FOLDER / "build.sh")]).returncode == 0


def test_outputs_are_compared() -> None:
    """Outputs that the comparison accepts, and outputs that it rejects."""
    assert guide.agrees(["a", "...", "b  1 ms"], ["a", "x", "y", "b 27.5 s"])
    assert guide.agrees(["seed ...", "  Workers  1  vm-12 4 paths (x)"], ["seed 5", "  Workers 1 other-7 4 paths (x)"])
    assert not guide.agrees(["4 solutions"], ["5 solutions"])
    assert not guide.agrees(["a"], ["a", "b"])
    assert not guide.agrees(["a", ""], ["a"]) and sys.version_info >= (3, 10)
