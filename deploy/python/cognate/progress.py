"""One progress bar: tqdm's if it is installed, else a line of text. No bar without a terminal or notebook."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from types import TracebackType
from typing import Any, Protocol

from .program import Progress, Watcher

PLAIN_WIDTH = 100
"""Most characters of the line of text."""


class _Display(Protocol):
    def show(self, now: Progress) -> None: ...

    def close(self) -> None: ...


class _Plain:
    """A line of text that is overwritten at each update."""

    def __init__(self) -> None:
        self._written = False

    def show(self, now: Progress) -> None:
        line = f"{now.phase}: {now.done:,} of {now.total:,} {now.unit}s"
        if now.failed:
            line += f", {now.failed:,} failed"
        print("\r" + line[:PLAIN_WIDTH].ljust(PLAIN_WIDTH), end="", file=sys.stderr, flush=True)
        self._written = True

    def close(self) -> None:
        if self._written:
            print("\r" + " " * PLAIN_WIDTH + "\r", end="", file=sys.stderr, flush=True)


class _Tqdm:
    """tqdm's bar; a widget in notebooks that support widgets."""

    def __init__(self, notebook: bool, first: Progress) -> None:
        widgets = notebook and importlib.util.find_spec("ipywidgets") is not None
        bars: Any = importlib.import_module("tqdm.notebook" if widgets else "tqdm.std")
        self._bar: Any = bars.tqdm(
            desc=first.phase,
            initial=first.done,
            total=first.total,
            unit=first.unit,
            leave=False,
            file=None if widgets else sys.stderr,
        )

    def show(self, now: Progress) -> None:
        self._bar.total = now.total
        self._bar.n = now.done
        self._bar.unit = now.unit
        self._bar.set_description_str(now.phase, refresh=False)
        if now.failed:
            self._bar.set_postfix_str(f"{now.failed:,} failed", refresh=False)
        self._bar.refresh()

    def close(self) -> None:
        self._bar.close()


def in_notebook() -> bool:
    """True in a notebook's kernel."""
    ipython = sys.modules.get("IPython")
    if ipython is None:
        return False
    shell = ipython.get_ipython()
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"


Wanted = bool | Watcher | None
"""None: a bar on a terminal and in notebooks. True: always. False: never. A function receives the progress instead."""


class Bar:
    """A bar for one job, from its first progress to the end of the block. It appears after `DELAY_SECONDS`."""

    # A very short solve needs no bar.
    DELAY_SECONDS = 0.3

    def __init__(self, wanted: Wanted) -> None:
        self._notebook = in_notebook()
        self._told = wanted if callable(wanted) else None
        looked_at = self._notebook or sys.stderr.isatty()
        self._shown = wanted is True or (wanted is None and looked_at)
        self._display: _Display | None = None

    @property
    def watcher(self) -> Watcher | None:
        """The function that receives progress; None if no progress is wanted."""
        if self._told is not None:
            return self._told
        return self._show if self._shown else None

    def _show(self, now: Progress) -> None:
        if self._display is None:
            if now.seconds < self.DELAY_SECONDS:
                return
            has_tqdm = importlib.util.find_spec("tqdm") is not None
            self._display = _Tqdm(self._notebook, now) if has_tqdm else _Plain()
        self._display.show(now)

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._display is not None:
            self._display.close()
