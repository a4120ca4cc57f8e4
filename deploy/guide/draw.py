"""Draws all pictures of the guide again: `python3 deploy/guide/draw.py`, with the program as COGNATE_PROGRAM.

The solved files are the files of the pages. The gallery draws positions, linkages and curves.
"""

from __future__ import annotations

import cmath
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "deploy" / "gallery"))

import pictures as gallery  # noqa: E402
from pictures import BOX, GROUND, HEIGHT, INK, SOFT, WIDTH, Frame, axes, dot, path, svg, words  # noqa: E402

ORANGE = "#c2570c"
Points = Sequence[Sequence[float]]


def program(*arguments: str, folder: Path) -> str:
    """The output of the program in a folder."""
    command = [os.environ["COGNATE_PROGRAM"], *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def file_of(page: str, title: str, folder: Path) -> Path:
    """Writes the file that a page shows."""
    text = (HERE / "pages" / page).read_text()
    block = re.search(rf'```\w+ title="{re.escape(title)}"\n(.*?)```', text, flags=re.DOTALL)
    assert block, f"{page} shows no file {title}"
    file = folder / title
    file.write_text(block[1])
    return file


def answer(*arguments: str, folder: Path) -> Any:
    """An answer in JSON."""
    return json.loads(program(*arguments, "--format", "json", folder=folder))


def arm(folder: Path) -> str:
    """All postures of the arm of the first task."""
    file_of("tasks/arm.md", "ur5e.csv", folder)
    pose = "-0.4 -0.15 0.35 0 1 0 0"
    targets = answer("mechanism", "inverse", "ur5e.csv", "--pose", pose, folder=folder)["targets"]
    shown = targets[0]["solutions"]
    chains = [[[0.0, 0.0, 0.0], *(pose["position"] for pose in one["links"].values())] for one in shown]
    parts = []
    wide, tall = WIDTH / 4, HEIGHT / 2
    every = [point for chain in chains for point in chain] + [[x, y, 0.0] for x in (-0.55, 0.2) for y in (-0.3, 0.2)]
    for number, chain in enumerate(chains):
        box = (number % 4 * wide + 6, number // 4 * tall + 6, wide - 12, tall - 12)
        frame = Frame(every, box)
        corners = [(-0.55, -0.3), (0.2, -0.3), (0.2, 0.2), (-0.55, 0.2)]
        parts.append(path([frame((x, y, 0.0)) for x, y in corners], "#b9c0c8", 0.8, closed=True))
        # The shadow on the floor tells front from back.
        parts.append(path([frame((p[0], p[1], 0.0)) for p in chain], "#c9ced4", 2.5))
        parts.append(path([frame(p) for p in chain], INK, 3.4))
        parts += [dot(frame(p), 2.6, GROUND) for p in chain[:-1]]
        parts.append(dot(frame(chain[-1]), 4.2, ORANGE))
        parts.append(words((box[0] + 8, box[1] + 16), str(number + 1), "start"))
    return svg(parts, f"{len(chains)} postures of an arm at one pose of its tool")


def platform(folder: Path) -> str:
    """The assemblies of the platform of the second task."""
    file = file_of("tasks/platform.md", "platform.json", folder)
    lengths = ("--set", "L1=1.1", "--set", "L2=1.3", "--set", "L3=1.2")
    shown = answer("mechanism", "forward", file.name, *lengths, folder=folder)
    return gallery.positions(shown, folder, {"root": str(folder), "file": file.name})[0]


def motion(folder: Path) -> str:
    """A four-bar linkage in one position of each circuit, and the curves of its coupler point."""
    file = file_of("tasks/motion.md", "four_bar.json", folder)
    degrees = [str(k) for k in range(0, 360, 2)]
    (folder / "inputs.csv").write_text("A0\n" + "\n".join(degrees) + "\n")
    targets = answer("mechanism", "forward", file.name, "--inputs", "inputs.csv", folder=folder)["targets"]
    data = json.loads(file.read_text())
    traced = [
        gallery.turned(one["links"]["coupler"], data["output"]["point"])
        for target in targets
        for one in target["solutions"]
    ]
    at_thirty = targets[15]["solutions"]
    home = {joint["name"]: joint["point"] for joint in data["joints"]}
    drawn = []
    for one in at_thirty:
        a, b = (gallery.turned(one["links"]["coupler"], home[name]) for name in ("A", "B"))
        tip = gallery.turned(one["links"]["coupler"], data["output"]["point"])
        drawn.append((a, b, tip))
    frame = Frame([*traced, *home.values(), *(p for one in drawn for p in one)], BOX)
    parts = [dot(frame(p), 1.3, ORANGE) for p in traced]
    for (a, b, tip), colour in zip(drawn, (INK, "#3d8a4f"), strict=False):
        parts.append(path([frame(home["A0"]), frame(a)], colour, 4))
        parts.append(path([frame(home["B0"]), frame(b)], colour, 4))
        parts.append(path([frame(a), frame(b), frame(tip)], colour, 2, closed=True))
        parts += [dot(frame(p), 3.5, colour) for p in (a, b)] + [dot(frame(tip), 5, ORANGE)]
    parts += [dot(frame(home[name]), 6, GROUND, filled=False) for name in ("A0", "B0")]
    return svg(parts, "A four-bar linkage in two positions, and the two parts of its coupler curve")


def four_bar(frame: Frame, joints: Sequence[complex], colour: str, width: float) -> list[str]:
    """The three moving links of a four-bar: pivot, joint, joint, pivot."""
    return [path([frame((z.real, z.imag)) for z in joints], colour, width)]


def modes(folder: Path) -> str:
    """A parallelogram in its two modes, and the common positions."""
    file = file_of("tasks/motion.md", "parallelogram.json", folder)
    degrees = [*range(15, 180, 30), *range(195, 360, 30)]
    (folder / "inputs.csv").write_text("A0\n" + "\n".join(map(str, degrees)) + "\n")
    targets = answer("mechanism", "forward", file.name, "--inputs", "inputs.csv", folder=folder)["targets"]
    home = {joint["name"]: joint["point"] for joint in json.loads(file.read_text())["joints"]}
    modes_of: list[list[list[complex]]] = [[], []]
    for target in targets:
        for one in target["solutions"]:
            pose = one["links"]["coupler"]
            a, b = (complex(*gallery.turned(pose, home[name])) for name in ("A", "B"))
            turns = abs(cmath.exp(1j * pose["angle"]) - 1) > 1e-6
            modes_of[turns].append([complex(*home["A0"]), a, b, complex(*home["B0"])])
    flat = [[0j, 1 + 0j, 5 + 0j, 4 + 0j]]
    every = [(z.real, z.imag) for positions in modes_of for joints in positions for z in joints]
    parts = []
    shown = ((modes_of[0], 1, "parallelogram"), (flat, 0, "both"), (modes_of[1], 1, "antiparallelogram"))
    for row, (positions, chosen, name) in enumerate(shown):
        frame = Frame([*every, (5, 1.2), (-1, -1.2)], (10, row * HEIGHT / 3 + 4, WIDTH - 160, HEIGHT / 3 - 8))
        for joints in positions:
            parts += four_bar(frame, joints, SOFT + "66", 2)
        parts += four_bar(frame, positions[chosen], ORANGE if name == "both" else INK, 4)
        parts += [dot(frame(place), 6, GROUND, filled=False) for place in (home["A0"], home["B0"])]
        parts += [dot(frame((z.real, z.imag)), 3.5) for z in positions[chosen][1:3]]
        parts.append(words((WIDTH - 80, (row + 0.5) * HEIGHT / 3), name))
    return svg(parts, "A parallelogram in its two modes, and a position that both have")


def singularities(folder: Path) -> str:
    """The dead centres of a four-bar with a driven rocker."""
    file = file_of("tasks/motion.md", "four_bar.json", folder)
    options = ("--inputs", "--input", "B0", "--angles", "rad")
    shown = answer("mechanism", "singularities", file.name, *options, folder=folder)["solutions"]
    place = {joint["name"]: complex(*joint["point"]) for joint in json.loads(file.read_text())["joints"]}
    drawn = []
    for one in shown:
        a, b = (
            place[pivot] + cmath.exp(1j * one["joints"][pivot]) * (place[joint] - place[pivot])
            for pivot, joint in (("A0", "A"), ("B0", "B"))
        )
        drawn.append([place["A0"], a, b, place["B0"]])
    every = [(z.real, z.imag) for joints in drawn for z in joints]
    parts = []
    for number, joints in enumerate(drawn):
        box = (number % 2 * WIDTH / 2 + 10, number // 2 * HEIGHT / 2 + 10, WIDTH / 2 - 20, HEIGHT / 2 - 20)
        frame = Frame(every, box)
        parts += four_bar(frame, joints[:3], ORANGE, 4)
        parts += four_bar(frame, joints[2:], INK, 4)
        parts += [dot(frame((z.real, z.imag)), 6, GROUND, filled=False) for z in (joints[0], joints[3])]
        parts += [dot(frame((z.real, z.imag)), 3.5) for z in joints[1:3]]
    return svg(parts, "Four dead centres: crank and coupler, in orange, are on one line, and the rocker cannot drive")


def workspace(folder: Path) -> str:
    """A section of an arm's workspace, coloured by the number of postures; 18,000 points take some minutes."""
    file = file_of("tasks/motion.md", "arm_3r.csv", folder)
    wide, tall, edge = 150, 120, 5.0
    columns = [edge * (i + 0.5) / wide for i in range(wide)]
    rows = [4.0 - 8.0 * (j + 0.5) / tall for j in range(tall)]
    (folder / "grid.json").write_text(json.dumps([[x, 0, z] for z in rows for x in columns]))
    found = answer("mechanism", "workspace", file.name, "--points", "grid.json", folder=folder)["points"]
    frame = Frame([(0, -4), (edge, 4)], BOX, False)
    shades = {2: "#b8cde6", 4: INK}
    parts = []
    for j, z in enumerate(rows):
        numbers = [found[j * wide + i]["postures"] for i in range(wide)]
        start = 0
        for i in range(1, wide + 1):
            if i < wide and numbers[i] == numbers[start]:
                continue
            if colour := shades.get(numbers[start]):
                left, right = frame((edge * start / wide, z + 4 / tall)), frame((edge * i / wide, z - 4 / tall))
                size = f'width="{right[0] - left[0] + 0.4:.1f}" height="{right[1] - left[1] + 0.4:.1f}"'
                parts.append(f'<rect x="{left[0]:.1f}" y="{left[1]:.1f}" {size} fill="{colour}"/>')
            start = i
    parts += axes(frame, [(0, -4), (edge, 4)], ("distance from the first axis", "height"))
    return svg(parts, "A section of an arm's workspace: light with two postures, dark with four")


def exceptional(folder: Path) -> str:
    """Two equal triangles with three equal cranks between them, in many positions."""
    triangle = [0j, 2 + 0j, 0.5 + 1.5j]
    positions = [[corner + cmath.exp(1j * math.radians(turn)) for corner in triangle] for turn in range(0, 360, 20)]
    every = [(z.real, z.imag) for corners in [*positions, triangle] for z in corners]
    frame = Frame(every, (20, 20, WIDTH - 40, HEIGHT - 40))

    def drawn(corners: Sequence[complex], colour: str, width: float, closed: bool = True) -> str:
        return path([frame((z.real, z.imag)) for z in corners], colour, width, closed=closed)

    parts = [drawn([*corners, corners[0]], SOFT + "55", 1.2, False) for corners in positions]
    parts.append(drawn(triangle, GROUND, 2))
    chosen = positions[3]
    parts.append(drawn(chosen, INK, 3))
    parts += [drawn(ends, ORANGE, 4, False) for ends in zip(triangle, chosen, strict=True)]
    parts += [dot(frame((z.real, z.imag)), 5, GROUND, filled=False) for z in triangle]
    parts += [dot(frame((z.real, z.imag)), 3.5) for z in chosen]
    return svg(
        parts, "Two equal triangles joined by three equal cranks: the upper one moves on circles without turning"
    )


def approximate(folder: Path) -> str:
    """The four-bar with the least known error of its coupler curve for twelve points."""
    known = json.loads((ROOT / "tests" / "motions" / "twelve_points" / "meta.json").read_text())
    points = json.loads((ROOT / "tests" / "motions" / "twelve_points" / "points.json").read_text())
    place = {name: complex(*known["expected"]["reference"][name]) for name in ("A0", "A", "B", "B0", "P")}
    arm = (place["P"] - place["A"]) / (place["B"] - place["A"])
    crank, coupler, rocker = (abs(place[p] - place[q]) for p, q in (("A", "A0"), ("B", "A"), ("B", "B0")))
    arcs: list[list[tuple[float, float]]] = []
    for side in (1, -1):
        arcs.append([])
        for k in range(721):
            a = place["A0"] + cmath.rect(crank, math.radians(k / 2))
            across = place["B0"] - a
            along = (abs(across) ** 2 + coupler**2 - rocker**2) / (2 * abs(across))
            if abs(along) > coupler:
                arcs.append([])
                continue
            b = a + across / abs(across) * complex(along, side * math.sqrt(coupler**2 - along**2))
            p = a + arm * (b - a)
            arcs[-1].append((p.real, p.imag))
    joints = [place[name] for name in ("A0", "A", "B", "B0")]
    frame = Frame([*points, *(p for arc in arcs for p in arc), *((z.real, z.imag) for z in joints)], BOX)
    parts = [path([frame(p) for p in arc], SOFT, 2) for arc in arcs if len(arc) > 1]
    parts += four_bar(frame, joints, INK, 3)
    triangle = (place["A"], place["B"], place["P"])
    parts.append(path([frame((z.real, z.imag)) for z in triangle], INK, 1.5, closed=True))
    parts += [dot(frame((z.real, z.imag)), 6, GROUND, filled=False) for z in (place["A0"], place["B0"])]
    parts += [dot(frame(p), 4.5, ORANGE) for p in points]
    return svg(parts, "Twelve points, and the coupler curve of a four-bar linkage that passes near all of them")


def synthesis(folder: Path) -> str:
    """The linkages through five poses."""
    poses = ROOT / "deploy" / "examples" / "five_poses.csv"
    shown = answer("synthesize", "body-guidance", str(poses), folder=folder)
    return gallery.linkages(shown, folder, {})[0]


def graph(points: Points, names: tuple[str, str], equal: bool, draw: Callable[[Frame], Iterable[str]]) -> list[str]:
    """Axes, and the drawing between them."""
    frame = Frame(points, BOX, equal)
    return [*axes(frame, points, names), *draw(frame)]


def equations(folder: Path) -> str:
    """The two curves of the equations, and their common points."""
    file_of("tasks/equations.md", "circles.txt", folder)
    lines = program("solve", "circles.txt", "--format", "jsonl", folder=folder).splitlines()
    common = [[value[0] for value in json.loads(line)["variables"].values()] for line in lines]
    turns = [2 * math.pi * k / 200 for k in range(201)]
    circle = [[2 * math.cos(t), 2 * math.sin(t)] for t in turns]
    ellipse = [[1 + math.sqrt(20) * math.cos(t), math.sqrt(5 / 3) * math.sin(t)] for t in turns]

    def draw(frame: Frame) -> Iterable[str]:
        yield path([frame(p) for p in circle], INK, 2.2)
        yield path([frame(p) for p in ellipse], "#3d8a4f", 2.2)
        yield from (dot(frame(p), 5.5, ORANGE) for p in common)

    return svg(graph([*circle, *ellipse], ("x", "y"), True, draw), "A circle, an ellipse and their four common points")


def family(folder: Path) -> str:
    """The amplitudes of an oscillator, plotted over its frequency."""
    file_of("tasks/families.md", "oscillator.txt", folder)
    targets = ("--targets", "w=linspace(0.4, 2.2, 181)", "--targets", "d=0.1")
    program("solve", "oscillator.txt", *targets, "--output", "sweep", folder=folder)
    shown = []
    for line in (folder / "sweep" / "solutions.jsonl").read_text().splitlines():
        solution = json.loads(line)
        if solution["real"]:
            values = [value[0] for value in solution["variables"].values()]
            shown.append([0.4 + 0.01 * solution["target"], math.hypot(*values)])

    def draw(frame: Frame) -> Iterable[str]:
        return (dot(frame(p), 1.9) for p in shown)

    return svg(
        graph(shown, ("frequency w", "amplitude"), False, draw), "A resonance curve that bends: one or three amplitudes"
    )


def components(folder: Path) -> str:
    """The real points of a cubic with two parts."""
    program("decompose", "-e", "x^3 - x = y^2", "--output", "set", folder=folder)
    program("real-curve", "set", "--output", "curve", folder=folder)
    arcs = []
    for curve in json.loads((folder / "curve" / "curve.json").read_text()):
        for edge in curve["edges"]:
            ends = [curve["vertices"][k]["point"] for k in edge["ends"] if k is not None]
            between = [*ends[:1], *edge["samples"], *ends[1:]]
            arcs.append([[x[0], y[0]] for x, y in between if abs(y[0]) < 3])

    def draw(frame: Frame) -> Iterable[str]:
        return (path([frame(p) for p in arc], INK, 2.4) for arc in arcs)

    every = [p for arc in arcs for p in arc]
    return svg(graph(every, ("x", "y"), True, draw), "x^3 - x = y^2: a closed loop, and an arc that goes to infinity")


def paths(folder: Path) -> str:
    """Paths from the fifth roots of unity to the roots of a quintic. This function tracks them."""
    ends = [1, -1.2, 0.3, 0.1, -1.4, 0.8]  # coefficients from x^5 down
    twist = cmath.exp(1.1j)

    def value(x: complex, t: float) -> tuple[complex, complex]:
        target, slope = 0j, 0j
        for coefficient in ends:
            target, slope = target * x + coefficient, slope * x + target
        return (
            t * twist * (x**5 - 1) + (1 - t) * target,
            t * twist * 5 * x**4 + (1 - t) * slope,
        )

    lines = []
    for k in range(5):
        x = cmath.exp(2j * math.pi * k / 5)
        line = [[x.real, x.imag]]
        for step in range(2000, -1, -1):
            for _ in range(3):
                height, slope = value(x, step / 2000)
                x -= height / slope
            if step % 20 == 0:
                line.append([x.real, x.imag])
        lines.append(line)

    def draw(frame: Frame) -> Iterable[str]:
        for line in lines:
            yield path([frame(p) for p in line], SOFT, 2)
            yield dot(frame(line[0]), 5, INK, filled=False)
            yield dot(frame(line[-1]), 5.5, ORANGE)

    every = [p for line in lines for p in line]
    title = "Five paths: from the solutions of x^5 = 1 (rings) to those of a quintic (dots)"
    return svg(graph(every, ("real part", "imaginary part"), True, draw), title)


def service(folder: Path) -> str:
    """The connections between client, coordinator and workers."""

    def box(x: float, y: float, title: str, below: str, colour: str = INK) -> str:
        return (
            f'<rect x="{x - 75}" y="{y - 34}" width="150" height="68" rx="8" '
            f'fill="{colour}18" stroke="{colour}" stroke-width="1.5"/>'
            f'<text x="{x}" y="{y - 4}" text-anchor="middle" font-size="16" fill="{colour}">{title}</text>'
            + words((x, y + 17), below)
        )

    def arrow(x1: float, y1: float, x2: float, y2: float, text: str, dy: float = -8) -> str:
        middle = ((x1 + x2) / 2, (y1 + y2) / 2 + dy)
        return (
            f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{GROUND}" stroke-width="1.5" marker-end="url(#a)"/>'
            + words(middle, text)
        )

    parts = [
        '<defs><marker id="a" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" '
        'orient="auto-start-reverse">'
        f'<path d="M0 0L10 5L0 10z" fill="{GROUND}"/></marker></defs>',
        box(90, 200, "client", "submit, watch, results"),
        box(320, 200, "coordinator", "plans, decides"),
        box(550, 80, "worker", "follows paths"),
        box(550, 200, "worker", "follows paths"),
        box(550, 320, "worker", "follows paths"),
        box(150, 370, "ledger", "SQLite or PostgreSQL", GROUND),
        box(345, 370, "results", "a folder or S3", GROUND),
        arrow(165, 200, 243, 200, "system"),
        arrow(395, 185, 473, 95, "paths", -14),
        arrow(473, 212, 397, 212, "ends", 18),
        arrow(395, 190, 473, 190, ""),
        arrow(395, 220, 473, 305, "", 20),
        arrow(290, 234, 180, 334, "", 0),
        arrow(328, 234, 342, 334, "", 0),
    ]
    return svg(
        parts, "A client gives a system to the coordinator, which gives paths to workers and keeps a ledger and results"
    )


GAP, CAPTION = 60, 70
"""Space between pictures side by side, and space below each picture for its caption."""


def beside(pictures: dict[str, str], title: str) -> str:
    """One picture of several pictures side by side, each with its caption."""
    parts = []
    for k, (caption, picture) in enumerate(pictures.items()):
        left = k * (WIDTH + GAP)
        inner = re.sub(r"^<svg [^>]*>", f'<svg x="{left}" width="{WIDTH}" height="{HEIGHT}">', picture)
        parts.append(re.sub(r"<title>.*?</title>", "", inner).strip())
        place = f'x="{left + WIDTH / 2}" y="{HEIGHT + 48}"'
        parts.append(f'<text {place} text-anchor="middle" font-size="38" fill="{SOFT}">{caption}</text>')
    size = f"0 0 {len(pictures) * (WIDTH + GAP) - GAP} {HEIGHT + CAPTION}"
    return svg(parts, title).replace(f"0 0 {WIDTH} {HEIGHT}", size, 1)


def front(folder: Path) -> str:
    """The picture of README: postures of an arm, modes of a linkage, linkages through nine points."""
    points = ROOT / "deploy" / "examples" / "nine_points.csv"
    shown = answer("synthesize", "nine-point", str(points), folder=folder)
    pictures = {
        "all postures of an arm": arm(folder),
        "all ways to move": modes(folder),
        "linkages through nine points": gallery.linkages(shown, folder, {})[0],
    }
    return beside(pictures, "Postures of an arm, modes of a parallelogram, linkages through nine points")


PICTURES = [
    front,
    arm,
    platform,
    motion,
    modes,
    singularities,
    workspace,
    exceptional,
    synthesis,
    approximate,
    equations,
    family,
    components,
    paths,
    service,
]


def main() -> None:
    """Writes all pictures, or only the named pictures."""
    chosen = set(sys.argv[1:])
    for picture in PICTURES:
        if not chosen or picture.__name__ in chosen:
            with tempfile.TemporaryDirectory() as folder:
                (HERE / "pages" / "pictures" / f"{picture.__name__}.svg").write_text(picture(Path(folder)))


if __name__ == "__main__":
    main()
