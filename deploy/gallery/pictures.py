"""Pictures of answers as SVG: points of planes, real curves, positions of mechanisms, linkages."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

WIDTH, HEIGHT, EDGE = 640, 440, 46
MOST_SHOWN = 12
INK, SOFT, GROUND = "#2563a8", "#8aa4c0", "#5b6470"

Vector = Sequence[float]


def flat(point: Vector) -> tuple[float, float]:
    """A point of space as it is drawn: from the side and a little from above."""
    if len(point) == 2:
        return point[0], point[1]
    x, y, z = point[:3]
    return x * 0.87 - y * 0.5, z + x * 0.25 + y * 0.43


class Frame:
    """A rectangle of the picture that shows a rectangle of the plane, round ones round."""

    def __init__(self, points: Iterable[Vector], box: tuple[float, float, float, float], equal: bool = True) -> None:
        self.box = box
        shown = [flat(p) for p in points] or [(0.0, 0.0)]
        left, right = min(p[0] for p in shown), max(p[0] for p in shown)
        low, high = min(p[1] for p in shown), max(p[1] for p in shown)
        wide, tall = (right - left) or 1.0, (high - low) or 1.0
        _, _, width, height = box
        self.scale = (0.9 * width / wide, 0.9 * height / tall)
        if equal:
            self.scale = (min(self.scale),) * 2
        self.middle = ((left + right) / 2, (low + high) / 2)

    def __call__(self, point: Vector) -> tuple[float, float]:
        x, y = flat(point)
        left, top, width, height = self.box
        return (
            left + width / 2 + (x - self.middle[0]) * self.scale[0],
            top + height / 2 - (y - self.middle[1]) * self.scale[1],
        )


def path(points: Iterable[tuple[float, float]], colour: str = INK, width: float = 1.6, closed: bool = False) -> str:
    """A broken line."""
    places = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    fill = colour + "22" if closed else "none"
    end = "Z" if closed else ""
    return f'<path d="M{places}{end}" fill="{fill}" stroke="{colour}" stroke-width="{width}" stroke-linejoin="round"/>'


def dot(place: tuple[float, float], radius: float, colour: str = INK, filled: bool = True) -> str:
    """A point, hollow where it is not real."""
    fill = colour if filled else "none"
    return f'<circle cx="{place[0]:.1f}" cy="{place[1]:.1f}" r="{radius}" fill="{fill}" stroke="{colour}" stroke-width="1.3"/>'


def words(place: tuple[float, float], text: str, anchor: str = "middle") -> str:
    """A label."""
    return f'<text x="{place[0]:.1f}" y="{place[1]:.1f}" text-anchor="{anchor}" font-size="12" fill="{GROUND}">{text}</text>'


def svg(parts: Iterable[str], title: str) -> str:
    """A whole picture."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" font-family="sans-serif">'
        f"<title>{title}</title>" + "".join(parts) + "</svg>\n"
    )


def axes(frame: Frame, points: Sequence[Vector], names: tuple[str, str]) -> list[str]:
    """Numbers at the ends of both axes, and their names."""
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    left, top, width, height = frame.box
    bottom = top + height
    parts = [f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#d9dde2"/>']
    for x in (min(xs), max(xs)):
        parts.append(words((frame((x, 0))[0], bottom + 15), f"{x:.3g}"))
    for y in (min(ys), max(ys)):
        parts.append(words((left - 6, frame((0, y))[1] + 4), f"{y:.3g}", "end"))
    parts.append(words((left + width / 2, bottom + 30), names[0]))
    parts.append(words((left + 4, top - 6), names[1], "start"))
    return parts


BOX = (EDGE + 10, EDGE / 2, WIDTH - EDGE - 20, HEIGHT - 1.5 * EDGE)


def points(answer: dict[str, Any], out: Path, options: dict[str, Any]) -> tuple[str, str]:
    """All solutions in the plane of one coordinate; where all of them are real, in two coordinates."""
    lines = [json.loads(line) for line in (out / "solutions.jsonl").read_text().splitlines()]
    names = list(lines[0]["variables"])
    plane = options.get("plane") or names[0]
    places = [[float(part) for part in line["variables"][plane]] for line in lines]
    across, up = f"re {plane}", f"im {plane}"
    if max(abs(y) for _, y in places) < 1e-9:
        second = names[(names.index(plane) + 1) % len(names)]
        places = [[x, float(line["variables"][second][0])] for (x, _), line in zip(places, lines, strict=True)]
        across, up = plane, second
    frame = Frame(places, BOX)
    parts = axes(frame, places, (across, up))
    radius = 3 if len(lines) > 300 else 4.5
    for place, line in zip(places, lines, strict=True):
        parts.append(dot(frame(place), radius, filled=bool(line["real"])))
    real = sum(bool(line["real"]) for line in lines)
    said = f"{len(lines)} solutions, {real} of them real (filled): {up} over {across}"
    return svg(parts, said), said


def curve(answer: dict[str, Any], out: Path, options: dict[str, Any]) -> tuple[str, str]:
    """The real points of all curves, in two or three of the variables."""
    curves = json.loads((out / "curve" / "curve.json").read_text())
    variables = json.loads((out / "set" / "system.json").read_text())["variables"]
    chosen = [variables.index(name) for name in options["axes"]]

    def place(point: Any) -> list[float]:
        return [point[k][0] for k in chosen]

    arcs = []
    for found in curves:
        ends = [place(v["point"]) for v in found["vertices"]]
        for edge in found["edges"]:
            first, last = ([] if k is None else [ends[k]] for k in edge["ends"])
            arcs.append([*first, *(place(p) for p in edge["samples"]), *last])
    marks = [(v["kind"], place(v["point"])) for found in curves for v in found["vertices"]]
    shown = [p for arc in arcs for p in arc] + [p for _, p in marks]
    if not shown:
        return svg([words((WIDTH / 2, HEIGHT / 2), "no real points")], "no real points"), "no real points"
    # Arcs to infinity are cut where most of the picture is.
    sizes = sorted(max(abs(x) for x in p) for p in shown)
    reach = 3 * sizes[len(sizes) // 2] + 1e-9
    inside = [p for p in shown if max(abs(x) for x in p) <= reach]
    for arc in arcs:
        for here, there in (*zip(arc, arc[1:], strict=False), *zip(arc[1:], arc, strict=False)):
            size = max(abs(x) for x in there)
            if max(abs(x) for x in here) <= reach < size:
                # About where the arc leaves the picture.
                inside.append([x * reach / size for x in there])
    frame = Frame(inside, BOX)
    parts = [
        f'<clipPath id="c"><rect x="{BOX[0]}" y="{BOX[1]}" width="{BOX[2]}" height="{BOX[3]}"/></clipPath><g clip-path="url(#c)">'
    ]
    parts += [path([frame(p) for p in arc], width=2) for arc in arcs]
    special = [(kind, p) for kind, p in marks if kind not in ("critical", "regular")]
    parts += [dot(frame(p), 4.5, "#8f5200", filled=False) for _, p in special]
    parts.append("</g>")
    if len(chosen) == 2:
        parts += axes(frame, [flat(p) for p in inside], (options["axes"][0], options["axes"][1]))
    cut = sum(max(abs(x) for x in p) > reach for p in shown)
    said = f"Real points in {', '.join(options['axes'])}: {len(arcs)} arcs" + (
        f"; {cut} samples lie outside of the picture" if cut else ""
    )
    kinds = sorted({kind for kind, _ in special})
    said += f"; circles: {', '.join(kinds)}" if kinds else ""
    return svg(parts, said), said


def turned(pose: dict[str, Any], point: Vector) -> list[float]:
    """A point of a link where the link is."""
    at = pose["position"]
    if "angle" in pose:
        c, s = math.cos(pose["angle"]), math.sin(pose["angle"])
        return [at[0] + c * point[0] - s * point[1], at[1] + s * point[0] + c * point[1]]
    w, x, y, z = pose["quaternion"]
    a, b, c = (float(p) for p in point)
    return [
        at[0] + (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c,
        at[1] + 2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c,
        at[2] + 2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c,
    ]


def number(value: Any) -> float:
    """A number of a mechanism's file, which may be a fraction or a root."""
    if isinstance(value, str):
        top, _, bottom = value.partition("/")
        root = top.startswith("sqrt(")
        whole = math.sqrt(float(top[5:-1])) if root else float(top)
        return whole / float(bottom or 1)
    return float(value)


Bodies = list[tuple[str, list[list[float]]]]


def foot(leg: dict[str, Any], base: dict[str, list[float]], inputs: dict[str, float]) -> list[list[float]]:
    """The points of a leg before the platform: its foot, and the end of its crank."""
    if "crank" not in leg:
        return [base[leg["from"]]]
    crank = leg["crank"]
    center = base[crank["center"]]
    zero = [number(x) for x in crank.get("zero", [1.0] + [0.0] * (len(center) - 1))]
    size = math.hypot(*zero)
    x = [part / size for part in zero]
    if len(center) == 2:
        y = [-x[1], x[0]]
    else:
        axis = [number(part) for part in crank["axis"]]
        size = math.hypot(*axis)
        a, b, c = (part / size for part in axis)
        y = [b * x[2] - c * x[1], c * x[0] - a * x[2], a * x[1] - b * x[0]]
    angle, length = inputs[leg["name"]], number(crank["length"])
    c, s = length * math.cos(angle), length * math.sin(angle)
    return [center, [p + c * u + s * v for p, u, v in zip(center, x, y, strict=True)]]


def bodies(file: Path, position: dict[str, Any]) -> Bodies:
    """What is drawn of one position: `ground`, `body` or `leg`, and the points of each."""
    links = position["links"]
    data = json.loads(file.read_text()) if file.suffix == ".json" else {"serial": {}}

    def vector(point: Any) -> list[float]:
        return [number(x) for x in point]

    if "framework" in data:
        bars = data["framework"]["bars"]
        return [("leg", [links[name]["position"] for name in bar["between"]]) for bar in bars]
    if "platform" in data:
        platform = data["platform"]
        base = {name: vector(p) for name, p in platform["base"].items()}
        pose = next(iter(pose for name, pose in links.items() if name != "base"))
        moving = {name: turned(pose, vector(p)) for name, p in platform["moving"].items()}
        inputs = position["inputs"]
        legs: Bodies = [("leg", [*foot(leg, base, inputs), moving[leg["to"]]]) for leg in platform["legs"]]
        return [("ground", list(base.values())), *legs, ("body", list(moving.values()))]
    if "joints" in data:
        home = {j["name"]: vector(j.get("point") or j["axis"]) for j in data["joints"]}
        places: dict[str, list[float]] = {}
        of_link: dict[str, list[str]] = {}
        for joint in data["joints"]:
            known = [name for name in joint["links"] if name in links]
            for name in joint["links"]:
                of_link.setdefault(name, []).append(joint["name"])
            if known:
                places[joint["name"]] = turned(links[known[-1]], home[joint["name"]])
        ground = data.get("ground") or data["links"][0]
        return [
            ("ground" if name == ground else "body", [places[j] for j in joints if j in places])
            for name, joints in of_link.items()
        ]
    chain = [[0.0, 0.0, 0.0]] + [pose["position"] for pose in links.values()]
    return [("leg", chain)]


def positions(answer: dict[str, Any], out: Path, options: dict[str, Any]) -> tuple[str, str]:
    """The real positions at the first target, side by side on one scale."""
    file = Path(options["root"]) / options["file"]
    found = answer["targets"][0]["solutions"]
    drawn = [bodies(file, position) for position in found[:MOST_SHOWN]]
    columns = min(4, max(1, math.ceil(math.sqrt(len(drawn)))))
    rows = max(1, math.ceil(len(drawn) / columns))
    every = [p for shown in drawn for _, body in shown for p in body]
    wide, tall = WIDTH / columns, HEIGHT / rows
    parts = []
    for k, shown in enumerate(drawn):
        box = (k % columns * wide + 8, k // columns * tall + 8, wide - 16, tall - 16)
        frame = Frame(every, box)
        for kind, body in shown:
            places = [frame(p) for p in body]
            colour = {"ground": GROUND, "leg": SOFT, "body": INK}[kind]
            if len(shown) == 1:
                colour = INK
            parts.append(path(places, colour, 2.2, closed=kind != "leg" and len(places) > 2))
            parts += [dot(p, 2.6, colour) for p in places]
        parts.append(words((box[0] + 4, box[1] + 10), str(k + 1), "start"))
    more = len(found) - len(drawn)
    said = f"{len(found)} real positions" + (f"; the first {len(drawn)} are drawn" if more else "")
    return svg(parts, said), said


def linkages(answer: dict[str, Any], out: Path, options: dict[str, Any]) -> tuple[str, str]:
    """The real linkages side by side: ground, two arms, and the triangle of the coupler."""
    found = answer.get("linkages")
    if found is None:
        found = [linkage for one in answer.get("curves") or [] for linkage in one["linkages"]]
    shown = found[:MOST_SHOWN]
    columns = min(4, max(1, math.ceil(math.sqrt(len(shown)))))
    rows = max(1, math.ceil(len(shown) / columns))
    wide, tall = WIDTH / columns, HEIGHT / rows
    parts = []
    for k, linkage in enumerate(shown):
        (a, b), (c, d) = linkage["pivots"], linkage["joints"]
        box = (k % columns * wide + 8, k // columns * tall + 8, wide - 16, tall - 16)
        frame = Frame([a, b, c, d, linkage["coupler_point"]], box)
        parts.append(path([frame(a), frame(b)], GROUND, 1.2))
        parts += [path([frame(p), frame(q)], SOFT, 2.4) for p, q in ((a, c), (b, d))]
        parts.append(path([frame(p) for p in (c, d, linkage["coupler_point"])], INK, 1.8, closed=True))
        parts += [dot(frame(p), 3, GROUND, False) for p in (a, b)] + [dot(frame(p), 2.6) for p in (c, d)]
        parts.append(words((box[0] + 4, box[1] + 10), linkage["name"], "start"))
    more = len(found) - len(shown)
    said = f"{len(found)} linkages" + (f"; the first {len(shown)} are drawn" if more > 0 else "")
    return svg(parts, said), said


PICTURES: dict[str, Callable[[dict[str, Any], Path, dict[str, Any]], tuple[str, str]]] = {
    "points": points,
    "curve": curve,
    "positions": positions,
    "linkages": linkages,
}
