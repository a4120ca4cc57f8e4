"""Pictures for notebooks: pages with a view that the mouse turns, and drawings."""

from __future__ import annotations

import os
from dataclasses import dataclass
from html import escape
from pathlib import Path


@dataclass(frozen=True, repr=False)
class Picture:
    """A page that needs no server, or a drawing; a notebook shows it.

    `html`: the page, or None. `svg`: the drawing, or None. `title`: the subject of the picture.
    """

    title: str
    html: str | None = None
    svg: str | None = None

    def __repr__(self) -> str:
        """The title."""
        return f"<Picture: {self.title}>"

    def _repr_html_(self) -> str:
        if self.html is None:
            return self.svg or escape(self.title)
        # The page has its own frame, so its scripts cannot reach the notebook.
        return (
            f'<iframe title="{escape(self.title)}" srcdoc="{escape(self.html)}" sandbox="allow-scripts" '
            'style="width: 100%; height: 46rem; border: 0"></iframe>'
        )

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Writes the page, or the drawing if the name ends with `.svg`; returns the file's path."""
        path = Path(file)
        content = self.svg if path.suffix == ".svg" or self.html is None else self.html
        if content is None:
            raise ValueError(f"{path.name}: this picture has no drawing; name it .html")
        path.write_text(content, encoding="utf-8")
        return path
