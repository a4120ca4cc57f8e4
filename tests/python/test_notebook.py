"""The tour in a notebook's kernel: its cells run, and its tables are tables."""

from __future__ import annotations

import warnings
from typing import Any

import pytest

from conftest import REPOSITORY


@pytest.fixture(scope="module")
def tour() -> Any:
    with warnings.catch_warnings():
        # Warnings of the kernel's own packages are ignored.
        warnings.simplefilter("ignore")
        import nbclient
        import nbformat

        notebook = nbformat.read(REPOSITORY / "deploy" / "python" / "tour.ipynb", as_version=4)
        nbclient.NotebookClient(notebook, timeout=900, kernel_name="python3").execute()
    return notebook


def outputs(tour: Any) -> list[Any]:
    return [output for cell in tour.cells if cell.cell_type == "code" for output in cell.outputs]


def test_results_are_tables(tour: Any) -> None:
    pages = [o.data["text/html"] for o in outputs(tour) if "text/html" in o.get("data", {})]
    assert len(pages) == 5
    assert "4 solutions, 4 real" in pages[0] and "<caption>Paths</caption>" in pages[0]
    assert "6 proved" in pages[1]
    assert "dataframe" in pages[2]


def test_curves_and_mechanisms_are_pictures(tour: Any) -> None:
    pages = [o.data["text/html"] for o in outputs(tour) if "text/html" in o.get("data", {})]
    assert pages[3].startswith("<svg") and pages[3].count("<path") + pages[3].count("<polyline") >= 2
    assert pages[4].startswith("<iframe") and 'sandbox="allow-scripts"' in pages[4]
    assert "branch 2" in pages[4] and "showMechanism" in pages[4]


def test_answers_of_the_tour(tour: Any) -> None:
    printed = "".join(o.text for o in outputs(tour) if o.output_type == "stream" and o.name == "stdout")
    assert "real assemblies, proved:" in printed and "[2, 3, 4]" in printed
    values = [o.data["text/plain"] for o in outputs(tour) if o.output_type == "execute_result"]
    assert "[0, 2, 4, 4, 4, 4, 4]" in values or any(v.startswith("[") for v in values)


def test_nothing_but_bars_on_standard_error(tour: Any) -> None:
    said = [o.text for o in outputs(tour) if o.output_type == "stream" and o.name == "stderr"]
    assert all("Warning" not in text and "Traceback" not in text for text in said), said
