"""JSON schemas of our problems and mechanisms: input that the program reads is valid, misspelt input is not."""

from __future__ import annotations

import json
import re
import subprocess
from typing import Any

import jsonschema
import pytest

import cognate as cg
from cognate import program
from conftest import EXAMPLES, REPOSITORY


def ran(*arguments: str) -> str:
    return subprocess.run([program.find(), *arguments], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(ran("convert", "--schema"))
    jsonschema.Draft202012Validator.check_schema(found)
    return found


SYSTEMS = [*sorted(EXAMPLES.glob("*.bertini")), *sorted(REPOSITORY.glob("tests/systems/*/system.bertini"))]


@pytest.mark.parametrize("file", SYSTEMS, ids=lambda p: p.parent.name + p.stem)
def test_what_the_program_writes_is_valid(schema: dict[str, Any], file: Any) -> None:
    jsonschema.validate(json.loads(ran("convert", str(file), "--to", "json")), schema)


def test_everything_that_can_be_said_is_valid(schema: dict[str, Any]) -> None:
    system = cg.System(
        ["x*y - t", "x^2 - q"],
        "x y",
        parameters="t q",
        groups=[["y"], ["x"]],
        homogeneous=[True, False],
        definitions={"b": "x + 1"},
        conjugates=[("x", "y")],
        degenerate={"a": {"nonzero": "x"}, "c": {"equations": ["x", "y"]}},
        symmetry=[{"permutation": {"x": "y", "y": "x"}}, {"map": {"x": "1/x"}}],
        path_variable="t",
    )
    jsonschema.validate(json.loads(system.to_json()), schema)


@pytest.mark.parametrize(
    "problem",
    [
        {"variables": ["x"]},
        {"variables": [], "equations": ["x"]},
        {"variables": ["x"], "equations": ["x"], "paramters": ["p"]},
        {"variables": ["2x"], "equations": ["x"]},
        {"variables": ["x"], "equations": [["x"]]},
        {"variables": ["x"], "equations": ["x"], "conjugates": [["x"]]},
        {"variables": ["x"], "equations": ["x"], "degenerate": {"a": {}}},
    ],
)
def test_mistakes_are_not(schema: dict[str, Any], problem: dict[str, Any]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(problem, schema)
    with pytest.raises(cg.InputError):
        cg.solve(problem)


@pytest.fixture(scope="module")
def mechanism_schema() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(ran("mechanism", "schema"))
    jsonschema.Draft202012Validator.check_schema(found)
    return found


PAGE = (REPOSITORY / "common/kinematics/mechanism_file.md").read_text(encoding="utf-8")
MECHANISMS = [
    *(json.loads(block) for block in re.findall(r"```json\n(.*?)```", PAGE, re.DOTALL)),
    *(
        json.loads(path.read_text())
        for path in sorted(REPOSITORY.glob("tests/mechanisms/*/mechanism.json"))
        if path.parent.name != "helical"
    ),
    *(json.loads(path.read_text()) for path in sorted(REPOSITORY.glob("tests/mechanisms/*/platform.json"))),
    *(json.loads(path.read_text()) for path in (EXAMPLES / "arm_6r.json", EXAMPLES / "stephenson.json")),
]


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=lambda m: str(m.get("name")))
def test_mechanisms_of_the_page_and_of_the_tests_are_valid(
    mechanism_schema: dict[str, Any], mechanism: dict[str, Any]
) -> None:
    jsonschema.validate(mechanism, mechanism_schema)


def test_what_the_program_writes_of_a_mechanism_is_valid(mechanism_schema: dict[str, Any]) -> None:
    file = str(EXAMPLES / "hexapod.toml")
    jsonschema.validate(json.loads(ran("mechanism", "convert", file, "--to", "mechanism.json")), mechanism_schema)


@pytest.mark.parametrize(
    "mechanism",
    [
        {"name": "no body"},
        {"serial": {"joints": []}},
        {"serial": {"joints": [{"name": "a", "alfa": 1}]}},
        {"serial": {"joints": [{"name": "a"}]}, "loop": {"joints": [{"name": "a"}]}},
        {"serial": {"joints": [{"name": "a", "type": "S"}]}},
        {"serial": {"joints": [{"name": "a"}]}, "limits": {"a": [1]}},
        {"serial": {"joints": [{"name": "a"}]}, "angles": "grad"},
        {"links": ["g", "k"], "joints": [{"name": "a", "type": "H", "links": ["g", "k"]}]},
        {"platform": {"base": {}, "moving": {}, "legs": [{"name": "a", "type": "SPR", "to": "P"}]}},
    ],
)
def test_mistakes_in_mechanisms_are_not(mechanism_schema: dict[str, Any], mechanism: dict[str, Any]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(mechanism, mechanism_schema)
    with pytest.raises(cg.InputError):
        cg.Mechanism.from_json(mechanism).info()
