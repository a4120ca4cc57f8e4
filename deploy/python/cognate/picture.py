"""Pictures that a notebook shows: pages that can be turned by hand, and drawings."""

from __future__ import annotations

import os
from dataclasses import dataclass
from html import escape
from pathlib import Path


@dataclass(frozen=True, repr=False)
class Picture:
    """A page that needs no server, or a drawing; a notebook shows it.

    `html`: the page, or None. `svg`: the drawing, or None. `title`: what it shows.
    """

    title: str
    html: str | None = None
    svg: str | None = None

    def __repr__(self) -> str:
        """What it shows."""
        return f"<Picture: {self.title}>"

    def _repr_html_(self) -> str:
        if self.html is None:
            return self.svg or escape(self.title)
        # A frame of its own: no script of the page reaches the notebook.
        return (
            f'<iframe title="{escape(self.title)}" srcdoc="{escape(self.html)}" sandbox="allow-scripts" '
            'style="width: 100%; height: 46rem; border: 0"></iframe>'
        )

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Writes the page, or the drawing where the name ends with `.svg`; gives the file's path."""
        path = Path(file)
        content = self.svg if path.suffix == ".svg" or self.html is None else self.html
        if content is None:
            raise ValueError(f"{path.name}: this picture has no drawing; name it .html")
        path.write_text(content, encoding="utf-8")
        return path
