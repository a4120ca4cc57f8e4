"""Makes the gallery: runs each entry's command, compares its counts, and writes a page for it and an index."""

from __future__ import annotations

import html
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from entries import ENTRIES, Entry
from pictures import PICTURES

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["COGNATE_PROGRAM"]
LONGEST = 900
"""Seconds that a command may take."""

STYLE = """
:root { color-scheme: light dark; --text: #1d2126; --dim: #5b6470; --line: #d9dde2; --back: #fbfbfa; --panel: #fff; --good: #1c6e3a; --bad: #a8241f; }
@media (prefers-color-scheme: dark) { :root { --text: #e4e7eb; --dim: #9aa5b1; --line: #353c46; --back: #14171b; --good: #74ca8f; --bad: #f08a84; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back); margin: 0 auto; max-width: 70rem; padding: 1rem; }
img { width: 100%; background: #fff; border: 1px solid var(--line); border-radius: .5rem; display: block; }
ul.grid { list-style: none; padding: 0; display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: 1.2rem; }
ul.grid a { text-decoration: none; color: inherit; } ul.grid a:hover { text-decoration: underline; }
pre { overflow-x: auto; border: 1px solid var(--line); border-radius: .4rem; padding: .6rem; }
table { border-collapse: collapse; } th, td { text-align: left; border-top: 1px solid var(--line); padding: .3rem .8rem .3rem 0; }
.dim { color: var(--dim); } .good { color: var(--good); } .bad { color: var(--bad); } figure { margin: 1rem 0; max-width: 44rem; }
"""


def page(title: str, body: str) -> str:
    """A page of the gallery."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{html.escape(title)}</title><style>{STYLE}</style></head><body>{body}</body></html>\n"
    )


def run(command: str, out: Path) -> dict[str, Any]:
    """The JSON answer of a command; any exit code but those of an answer ends the gallery's making."""
    words = [word.replace("{out}", str(out)) for word in shlex.split(command)]
    done = subprocess.run(
        [PROGRAM, *words, "--format", "json"], cwd=ROOT, capture_output=True, text=True, timeout=LONGEST, check=False
    )
    if done.returncode not in (0, 1):
        raise SystemExit(f"cognate {command}: exit code {done.returncode}\n{done.stderr}")
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def at(answer: Any, place: str) -> Any:
    """A field of an answer."""
    for step in place.split("."):
        answer = answer[int(step)] if isinstance(answer, list) else answer[step]
    return answer


def make(entry: Entry, folder: Path) -> tuple[bool, str]:
    """Writes the entry's page and picture; whether all counts are as expected, and a phrase with the counts."""
    out = (folder / "data" / entry.name).resolve()
    out.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    answer = run(entry.command, out)
    second = run(entry.then, out) if entry.then else {}
    seconds = time.monotonic() - began
    (out / "answer.json").write_text(json.dumps({"first": answer, "then": second} if second else answer, indent=1))
    picture, said = PICTURES[entry.picture](answer, out, {**entry.options, "root": str(ROOT)})
    (folder / f"{entry.name}.svg").write_text(picture)
    rows, all_well = [], True
    for place, expected in entry.expected.items():
        then = place.startswith("then.")
        found = at(second, place[5:]) if then else at(answer, place)
        well = found == expected
        all_well &= well
        verdict = '<span class="good">as expected</span>' if well else f'<span class="bad">expected {expected}</span>'
        name = " ".join(part.replace("_", " ") for part in place.split(".")[-2:] if not part.isdigit())
        rows.append(f'<tr><th scope="row">{html.escape(name)}</th><td>{found}</td><td>{verdict}</td></tr>')
    settled = bool(answer["settled"]) and bool(second.get("settled", True))
    all_well &= settled
    rows.append(
        '<tr><th scope="row">settled</th><td>'
        + ("yes" if settled else '<span class="bad">no</span>')
        + "</td><td>every path accounted for</td></tr>"
    )
    commands = "\n".join(f"cognate {c.replace('{out}', 'here')}" for c in (entry.command, entry.then) if c)
    (folder / f"{entry.name}.html").write_text(
        page(
            entry.title,
            f'<p><a href="index.html">Gallery</a></p><h1>{html.escape(entry.title)}</h1><p>{html.escape(entry.text)}</p>'
            f'<figure><img src="{entry.name}.svg" alt="{html.escape(said)}"><figcaption class="dim">{html.escape(said)}</figcaption></figure>'
            f"<pre>{html.escape(commands)}</pre><table>{''.join(rows)}</table>"
            f'<p>Source: {html.escape(entry.source)}. <span class="dim">{seconds:.1f} s.</span> '
            f'<a href="data/{entry.name}/answer.json">The answer as JSON</a></p>',
        )
    )
    return all_well, said


def main(arguments: list[str]) -> int:
    """Makes all entries, the small ones, or those that are named."""
    if not arguments or arguments[0].startswith("-"):
        print("usage: deploy/gallery/make.sh OUT [--small | NAME...]", file=sys.stderr)
        return 2
    folder, *names = Path(arguments[0]), *arguments[1:]
    unknown = [name for name in names if name != "--small" and name not in {e.name for e in ENTRIES}]
    if unknown:
        print(f"no entry {unknown[0]}; there are {', '.join(e.name for e in ENTRIES)}", file=sys.stderr)
        return 2
    chosen = [e for e in ENTRIES if not names or e.name in names or ("--small" in names and e.small)]
    folder.mkdir(parents=True, exist_ok=True)
    items, wrong = [], []
    for entry in chosen:
        well, said = make(entry, folder)
        print(f"{'ok   ' if well else 'WRONG'} {entry.name}: {said}", flush=True)
        if not well:
            wrong.append(entry.name)
        mark = "" if well else ' <span class="bad">not as expected</span>'
        items.append(
            f'<li><a href="{entry.name}.html"><img src="{entry.name}.svg" alt="" loading="lazy">'
            f'<strong>{html.escape(entry.title)}</strong></a>{mark}<br><span class="dim">{html.escape(said)}</span></li>'
        )
    body = (
        f"<h1>Cognate: gallery</h1><p>{len(chosen)} problems, each with its command, its count, and who has counted before.</p>"
        f'<ul class="grid">{"".join(items)}</ul>'
    )
    (folder / "index.html").write_text(page("Cognate: gallery", body))
    print(f"{len(chosen) - len(wrong)} of {len(chosen)} as expected: {folder / 'index.html'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
