"""Hooks of the guide's build: the reference of commands, and formulas that need no script."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path
from typing import Any

import latex2mathml.converter

COMMANDS = "<!-- commands -->"
SHIM = re.compile(r'<script src="https?://[^"]*/iframe-worker/shim"></script>')
"""A script that the theme adds for sites without a server."""
COLUMNS = 90
"""Columns of text that fit beside a page's menus."""


def help_of(*words: str) -> str:
    """The help text of a command."""
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
    """Every command with its full `--help` text, as Markdown."""
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
    """Inserts the reference of commands at the mark in a page."""
    return markdown.replace(COMMANDS, reference()) if COMMANDS in markdown else markdown


def formula(match: re.Match[str]) -> str:
    """A formula as MathML, which browsers show without a script."""
    block = match[1] == "div"
    tex = match[2].strip()[2:-2].replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">")
    made = latex2mathml.converter.convert(tex, display="block" if block else "inline")
    return f'<div class="formula">{made}</div>' if block else str(made)


def on_page_content(html: str, **_: Any) -> str:
    """Replaces formulas between dollar signs by MathML."""
    return re.sub(r'<(span|div) class="arithmatex">(.*?)</\1>', formula, html, flags=re.DOTALL)


def on_post_page(output: str, page: Any, **_: Any) -> str:
    """Removes the search's script from a network, which is not needed."""
    return SHIM.sub(f'<script src="{"../" * page.url.count("/")}search_worker.js"></script>', output)


def on_post_template(output_content: str, **_: Any) -> str:
    """Removes the same script from the page for wrong addresses. Only servers show that page."""
    return SHIM.sub("", output_content)


def on_post_build(config: Any) -> None:
    """Removes files that only developers of the theme need."""
    for file in Path(config.site_dir).rglob("*.map"):
        file.unlink()
