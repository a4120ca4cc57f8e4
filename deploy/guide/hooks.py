"""What the guide's build does besides: the reference of commands, and formulas that need no script."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path
from typing import Any

import latex2mathml.converter

COMMANDS = "<!-- commands -->"
SHIM = re.compile(r'<script src="https?://[^"]*/iframe-worker/shim"></script>')
"""What the theme adds for sites without a server."""
COLUMNS = 90
"""What a page shows beside its menus."""


def help_of(*words: str) -> str:
    """What the program says of a command."""
    program = os.environ["COGNATE_PROGRAM"]
    environment = {**os.environ, "COLUMNS": str(COLUMNS), "NO_COLOR": "1"}
    run = subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True, env=environment)
    return run.stdout.rstrip()


def commands_in(text: str) -> list[str]:
    """The names below `Commands:` of a help text."""
    listed = text.partition("\nCommands:\n")[2].partition("\n\n")[0]
    names = [re.match(r"  ([a-z][a-z0-9-]*)(?:\s|$)", line) for line in listed.splitlines()]
    return [name[1] for name in names if name and name[1] != "help"]


def reference() -> str:
    """Every command with all that `--help` says, as Markdown."""
    parts: list[str] = []

    def add(words: tuple[str, ...], level: int) -> None:
        text = help_of(*words)
        title = " ".join(["cognate", *words])
        parts.append(f"{'#' * level} `{title}`\n\n```text\n{text}\n```\n")
        for name in commands_in(text):
            add((*words, name), min(level + 1, 3))

    add((), 2)
    return "\n".join(parts)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """The reference of commands stands where a page asks for it."""
    return markdown.replace(COMMANDS, reference()) if COMMANDS in markdown else markdown


def formula(match: re.Match[str]) -> str:
    """A formula as MathML, which browsers show without a script."""
    block = match[1] == "div"
    tex = match[2].strip()[2:-2].replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">")
    made = latex2mathml.converter.convert(tex, display="block" if block else "inline")
    return f'<div class="formula">{made}</div>' if block else str(made)


def on_page_content(html: str, **_: Any) -> str:
    """Formulas between dollars."""
    return re.sub(r'<(span|div) class="arithmatex">(.*?)</\1>', formula, html, flags=re.DOTALL)


def on_post_page(output: str, page: Any, **_: Any) -> str:
    """The search needs no script from a network."""
    return SHIM.sub(f'<script src="{"../" * page.url.count("/")}search_worker.js"></script>', output)


def on_post_template(output_content: str, **_: Any) -> str:
    """The page for wrong addresses stands on servers alone, where the search needs no help."""
    return SHIM.sub("", output_content)


def on_post_build(config: Any) -> None:
    """Leaves out what only people who change the theme read."""
    for file in Path(config.site_dir).rglob("*.map"):
        file.unlink()
