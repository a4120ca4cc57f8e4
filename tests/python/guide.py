"""Runs the guide's pages: reads file blocks and command blocks, runs the commands, and compares their output.

A block ```` ```console ```` has lines `$ command` with the output beneath, both streams in one. A block with a title is
a file in the folder of its page's commands; `examples/NAME` is a file of deploy/examples, shown whole or with
`...`. Commands of a page run one after another in one shell. In an output, `...` on its own line matches any lines, and
within a line any characters. Times, rates and workers are not compared. `$ echo $?` follows a command that fails.
`UPDATE_GOLDEN=1` writes the outputs that differ into the pages; read the difference before you commit it.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

OPENING = re.compile(r'^( *)```(\w*)(?: .*?title="([^"]+)")?')
MARK = "@@guide@@"
SECONDS = 300
"""Time limit of a page's commands in seconds. Only a hang reaches it."""

VARYING = [
    (re.compile(r"\b\d[\d,.]*(?:e[+-]?\d+)? (?:ns|µs|us|ms|s|min|h)\b"), "TIME"),
    (re.compile(r"\b\d[\d,.]* paths/s"), "RATE"),
    # The workers and their shares of the work depend on the machine.
    (re.compile(r"^( *Workers +).*"), r"\1WORKERS"),
    # The output has this suffix if another page has prepared the mechanism.
    (re.compile(r" prepared before$"), ""),
    (re.compile(r"\s+"), " "),
]
MORE_WORKERS = re.compile(r" {20,}\S+-\d+ [\d,]+ paths? \(")


@dataclass
class Block:
    """A fenced block: `first` is the number of its first line, from 0."""

    language: str
    title: str | None
    first: int
    lines: list[str]


@dataclass
class Command:
    """A command, the output in its page, and the page's lines of that output."""

    text: str
    first: int
    expected: list[str] = field(default_factory=list)
    actual: list[str] = field(default_factory=list)
    status: int = 0


def blocks(text: str) -> list[Block]:
    """All fenced blocks of a page."""
    result: list[Block] = []
    inside: Block | None = None
    indent = ""
    for number, line in enumerate(text.splitlines()):
        if inside is not None:
            if line.strip() == "```":
                inside = None
            else:
                inside.lines.append(line.removeprefix(indent))
        elif opening := OPENING.match(line):
            indent = opening[1]
            inside = Block(opening[2], opening[3], number + 1, [])
            result.append(inside)
    assert inside is None, "a block is not closed"
    return result


def commands(block: Block) -> list[Command]:
    """The commands of a console block."""
    result: list[Command] = []
    goes_on = False
    for number, line in enumerate(block.lines, block.first):
        if goes_on:
            result[-1].text += "\n" + line
            result[-1].first = number + 1
        elif line.startswith("$ "):
            result.append(Command(line[2:], number + 1))
        else:
            assert result, f"line {number + 1}: an output without a command"
            result[-1].expected.append(line)
        goes_on = (goes_on or line.startswith("$ ")) and line.endswith("\\")
    return result


def run(all_commands: list[Command], folder: Path, environment: dict[str, str]) -> None:
    """Runs commands in one shell, and records the output and exit code of each."""
    script = ["exec 2>&1"]
    for command in all_commands:
        script += [command.text, f"status=$?; printf '\\n{MARK} %s\\n' $status; (exit $status)"]
    script += ["kill $(jobs -p) 2>/dev/null; wait"]
    shell = subprocess.Popen(
        ["bash", "-c", "\n".join(script)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        cwd=folder,
        env={**os.environ, **environment},
        text=True,
        start_new_session=True,
    )
    try:
        output, _ = shell.communicate(timeout=SECONDS)
    except subprocess.TimeoutExpired:
        # Ends also the services that the page has started.
        os.killpg(shell.pid, signal.SIGKILL)
        output, _ = shell.communicate()
    lines: list[str] = []
    rest = iter(all_commands)
    for line in output.splitlines():
        if line.startswith(MARK):
            command = next(rest)
            command.status = int(line.split()[1])
            # The mark follows an empty line, or it ends the last line.
            command.actual = lines[:-1] if lines and not lines[-1] else lines
            lines = []
        else:
            lines.append(line.rstrip())
    left = next(rest, None)
    assert left is None, f"the shell ended at: {left and left.text}\n" + "\n".join(lines)


def plain(line: str) -> str:
    """A line, with fixed words for the parts that differ between machines and runs."""
    for pattern, name in VARYING:
        line = pattern.sub(name, line)
    return line.rstrip()


def comparable(lines: list[str]) -> list[str]:
    """Lines without the parts that differ between machines and runs. Workers may fill several lines."""
    return [plain(line) for line in lines if not MORE_WORKERS.match(line)]


def agrees(expected: list[str], actual: list[str]) -> bool:
    """True if an output agrees with the page."""
    pattern = ""
    for line in comparable(expected):
        if line.strip() == "...":
            pattern += r"(?:[^\n]*\n)*?"
        else:
            parts = (re.escape(part) for part in line.split("..."))
            pattern += r"[^\n]*?".join(parts) + r"\n"
    return re.fullmatch(pattern, "".join(line + "\n" for line in comparable(actual))) is not None


def shown_file(block: Block, path: Path) -> bool:
    """True if a block shows a file of the examples, whole or with `...`."""
    return agrees(block.lines, path.read_text().splitlines())


def rewritten(text: str, all_commands: list[Command]) -> str:
    """The page, with the new outputs of its commands where they differ."""
    lines = text.splitlines()
    for command in reversed(all_commands):
        if not agrees(command.expected, command.actual):
            lines[command.first : command.first + len(command.expected)] = command.actual
    return "\n".join(lines) + "\n"
