"""Entries of the gallery: what is run, what must come out, and who says so."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Entry:
    """One page.

    `command`: arguments of the program; `{out}` is a folder of the entry's own. `then`: a second command, which reads
    that folder. `expected`: numbers that must be found, by the path of their field in the JSON answer of the first
    command; those that begin with `then.` in the answer of the second. `picture`: a function of `pictures.py`, and
    `options` what it is told. `small`: it takes about a second.
    """

    name: str
    title: str
    text: str
    command: str
    expected: dict[str, object]
    source: str
    picture: str
    options: dict[str, object] = field(default_factory=dict)
    then: str = ""
    small: bool = False


EXAMPLES = "deploy/examples"
SYSTEMS = "tests/systems"
MECHANISMS = "tests/mechanisms"


def solve(
    name: str, title: str, text: str, file: str, expected: dict[str, object], source: str, **more: object
) -> Entry:
    """Isolated solutions, as points in the plane of a coordinate."""
    options = str(more.pop("arguments", ""))
    plane = more.pop("plane", None)
    command = f"solve {file} {options}".strip() + " --output {out}"
    expected = {"solutions." + key: value for key, value in expected.items()}
    return Entry(name, title, text, command, expected, source, "points", {"plane": plane}, **more)  # type: ignore[arg-type]


def curve(
    name: str, title: str, text: str, axes: list[str], expected: dict[str, object], source: str, **more: object
) -> Entry:
    """The real points of a curve."""
    file = f"{SYSTEMS}/{name}/system.bertini"
    command = f"decompose {file} --output {{out}}/set"
    then = "real-curve {out}/set --output {out}/curve"
    return Entry(name, title, text, command, expected, source, "curve", {"axes": axes}, then, **more)  # type: ignore[arg-type]


def mechanism(
    name: str, title: str, text: str, question: str, expected: dict[str, object], source: str, **more: object
) -> Entry:
    """All positions of a mechanism at its first target."""
    folder, _, rest = question.partition("/")
    verb, _, file = folder.partition(" ")
    parts = rest.split(" ")
    words = [f"{MECHANISMS}/{file}/{parts[0]}"]
    for part in parts[1:]:
        words.append(f"{MECHANISMS}/{file}/{part}" if part.endswith(".json") else part)
    numbers = {f"targets.0.configurations.{key}": value for key, value in expected.items()}
    command = f"mechanism {verb} {' '.join(words)}"
    options = {"file": words[0]}
    return Entry(name, title, text, command, numbers, source, "positions", options, **more)  # type: ignore[arg-type]


def linkages(
    kind: str, title: str, text: str, file: str, expected: dict[str, object], source: str, **more: object
) -> Entry:
    """Four-bar linkages that do what was asked."""
    command = f"synthesize {kind} {EXAMPLES}/{file} --output {{out}}"
    return Entry(f"synthesis-{kind}", title, text, command, expected, source, "linkages", {}, **more)  # type: ignore[arg-type]


ENTRIES: list[Entry] = [
    solve(
        "three_rpr",
        "A planar 3-RPR platform in six ways",
        "Three legs of given lengths. All six positions are real: a solution is real "
        "when t1 and T1, ... are conjugates.",
        f"{EXAMPLES}/three_rpr.bertini",
        {"distinct": 6, "real": 6},
        "Gosselin, Sefrioui, Richard 1992: at most six",
        arguments="--conjugates p~P,t1~T1,t2~T2,t3~T3,g~G",
        plane="t1",
        small=True,
    ),
    solve(
        "dietmaier",
        "Forty real positions of a Stewart-Gough platform",
        "Seven quadrics in P^7, 128 paths; the rest of the paths ends where there is no pose.",
        f"{EXAMPLES}/stewart_gough_dietmaier.bertini",
        {"distinct": 40, "real": 40},
        "Dietmaier 1998",
        plane="x1",
        small=True,
    ),
    solve(
        "cyclic_5",
        "Cyclic 5-roots",
        "Seventy solutions, with the symmetry of a pentagon.",
        f"{EXAMPLES}/cyclic_5.bertini",
        {"distinct": 70},
        "Bjoerck and Froeberg 1991",
        plane="z0",
        small=True,
    ),
    solve(
        "noon_5",
        "Noonburg's neural network with five cells",
        "233 of the 243 paths of the total degree end at solutions.",
        f"{EXAMPLES}/noon_5.bertini",
        {"distinct": 233},
        "Noonburg 1989; Verschelde's data base",
        plane="x1",
    ),
    solve(
        "katsura_10",
        "Katsura-10: magnetism of a spin chain",
        "Ten quadrics and a plane.",
        f"{EXAMPLES}/katsura_10.bertini",
        {"distinct": 1024},
        "Katsura 1990; Boege, Gebauer, Kredel 1986",
        plane="u0",
    ),
    solve(
        "manseur_doty",
        "An arm with sixteen real postures, as polynomials",
        "The equations cannot tell 16 reflected solutions from the postures: 32 in all.",
        f"{EXAMPLES}/six_revolute_manseur_doty.bertini",
        {"distinct": 32},
        "Manseur and Doty 1989",
        small=True,
    ),
    solve(
        "four_bar_line",
        "A four-bar's coupler curve meets a line",
        "The coupler curve is a sextic: six points on a general line.",
        f"{EXAMPLES}/four_bar.bertini",
        {"distinct": 6},
        "Roberts 1876",
        small=True,
    ),
    solve(
        "burmester",
        "Five poses of a body",
        "Four dyads carry it through all five.",
        f"{SYSTEMS}/burmester_five_poses_real4/system.bertini",
        {"distinct": 4},
        "Burmester 1888",
        small=True,
    ),
    curve(
        "viviani",
        "Viviani's window",
        "A sphere meets a cylinder: one figure of eight, with one singular point.",
        ["x", "y", "z"],
        {"decomposition.components.0.degree": 4, "then.components.0.singular_points": 1},
        "Viviani 1692; degree by Bezout",
        small=True,
    ),
    curve(
        "quadrifolium",
        "The four-leaved rose",
        "A sextic whose leaves meet in one point.",
        ["x", "y"],
        {"decomposition.components.0.degree": 6, "then.components.0.singular_points": 1},
        "Loria 1902, rhodonea",
    ),
    curve(
        "real_cubic",
        "A cubic of two parts",
        "A closed loop and an arc to infinity.",
        ["x", "y"],
        {
            "decomposition.components.0.degree": 3,
            "then.components.0.closed_loops": 1,
            "then.components.0.unbounded_arcs": 1,
        },
        "Newton 1704",
    ),
    curve(
        "real_acnode",
        "A cubic with an isolated point",
        "The real origin lies apart from the arc.",
        ["x", "y"],
        {
            "decomposition.components.0.degree": 3,
            "then.components.0.isolated_points": 1,
            "then.components.0.unbounded_arcs": 1,
        },
        "Newton 1704",
    ),
    curve(
        "planar_3r_workspace_boundary",
        "How far a planar arm of three links reaches",
        "Singular positions of the arm with links 2, 3/2, 4/5: four circles of radius 43/10, 27/10, 13/10 and 3/10.",
        ["Rx", "Ry"],
        {"decomposition.by_dimension.1.components": 4},
        "|2 +- 3/2 +- 4/5|",
    ),
    curve(
        "four_bar_sextic",
        "The coupler curve of a four-bar",
        "A sextic with its double points.",
        ["x", "y"],
        {"decomposition.components.0.degree": 6},
        "Roberts 1876",
    ),
    curve(
        "griffis_duffy_typei_full",
        "A platform that moves although it should not",
        "Griffis and Duffy's platform: a curve of degree 28 of motions, and lines.",
        ["x1", "x2", "x3"],
        {"decomposition.by_dimension.1.components": 13},
        "Griffis and Duffy 1993; Husty and Karger 2000",
    ),
    mechanism(
        "arm_generic",
        "An arm of general dimensions",
        "Sixteen complex postures for each pose; two of them are real at the first.",
        "inverse arm_generic/arm.json --poses poses.json",
        {"complex": 16, "real": 2},
        "Primrose 1986; a Raghavan-Roth elimination of its own",
    ),
    mechanism(
        "arm_manseur_doty",
        "Sixteen real postures",
        "As many as there can be.",
        "inverse arm_manseur_doty/arm.json --poses poses.json",
        {"complex": 16, "real": 16},
        "Manseur and Doty 1989",
        small=True,
    ),
    mechanism(
        "arm_puma560",
        "PUMA 560",
        "The axes of its wrist meet: eight postures.",
        "inverse arm_puma560/arm.json --poses poses.json",
        {"complex": 8, "real": 8},
        "EAIK 1.2.2, ikdh 1.2.0",
        small=True,
    ),
    mechanism(
        "arm_ur10e",
        "UR10e from its URDF",
        "Three parallel axes.",
        "inverse arm_ur10e/arm.urdf --poses poses.json",
        {"complex": 8, "real": 8},
        "EAIK 1.2.2, ikdh 1.2.0",
    ),
    mechanism(
        "arm_ur10e_calibrated",
        "UR10e with the errors of its making",
        "A milliradian off, and the closed form is gone: sixteen postures, eight of them near.",
        "inverse arm_ur10e_calibrated/arm.urdf --poses poses.json",
        {"complex": 16, "real": 8},
        "ikdh 1.2.0",
    ),
    mechanism(
        "arm_iiwa",
        "A redundant arm with one joint locked",
        "Seven joints, the third held at 0.3.",
        "inverse arm_7r_iiwa/arm.urdf --poses poses.json --lock joint_3=0.3",
        {"real": 8},
        "Pieper 1968",
    ),
    mechanism(
        "stewart_generic",
        "A Stewart-Gough platform",
        "Forty complex positions for six legs of given lengths.",
        "forward stewart_generic/platform.json --inputs inputs.json",
        {"complex": 40, "real": 4},
        "Raghavan 1993; phc 2.4.86",
    ),
    mechanism(
        "stewart_octahedral",
        "The octahedral platform",
        "Two triangles: sixteen positions.",
        "forward stewart_octahedral/platform.json --inputs inputs.json",
        {"complex": 16, "real": 8},
        "Nanua, Waldron, Murthy 1990; phc 2.4.86",
        small=True,
    ),
    mechanism(
        "platform_3rpr",
        "A planar platform on three legs",
        "Six positions, two of them real.",
        "forward three_rpr/platform.json --inputs inputs.json",
        {"complex": 6, "real": 2},
        "Gosselin, Sefrioui, Richard 1992; phc 2.4.86",
        small=True,
    ),
    mechanism(
        "platform_3rrr",
        "The same with cranks",
        "",
        "forward three_rrr/platform.json --inputs inputs.json",
        {"complex": 6, "real": 4},
        "phc 2.4.86",
    ),
    mechanism(
        "spherical_3rrr",
        "A platform on a sphere",
        "All axes meet in one point.",
        "forward spherical_3rrr/mechanism.json --inputs inputs.json",
        {"complex": 8, "real": 4},
        "Gosselin, Sefrioui, Richard 1994; phc 2.4.86",
    ),
    mechanism(
        "delta",
        "Delta robot",
        "Rods in parallelograms keep its platform level: two positions.",
        "forward delta/platform.json --inputs inputs.json",
        {"complex": 2, "real": 2},
        "closed form: three spheres",
        small=True,
    ),
    mechanism(
        "rssr",
        "A spatial four-bar",
        "The link between the balls spins idly, which is not solved for.",
        "forward rssr/mechanism.json --inputs inputs.json",
        {"complex": 2, "real": 2},
        "closed form",
    ),
    mechanism(
        "stephenson_crank",
        "Stephenson III, its crank driven",
        "A four-bar and a dyad: two times two.",
        "forward stephenson/mechanism.json --input A0 --inputs inputs_A0.json",
        {"complex": 4, "real": 4},
        "phc 2.4.86",
    ),
    mechanism(
        "stephenson_lever",
        "Stephenson III, its lever driven",
        "A triad: six.",
        "forward stephenson/mechanism.json --input D0 --inputs inputs_D0.json",
        {"complex": 6, "real": 2},
        "phc 2.4.86",
    ),
    mechanism(
        "framework_k33",
        "Bars between three and three points",
        "Sixteen realisations of K33, eight of them real.",
        "forward framework_k33/framework.json",
        {"complex": 16, "real": 8},
        "Wunderlich 1977; Capco et al. 2018",
        small=True,
    ),
    linkages(
        "body-guidance",
        "Six linkages that take a body through five poses",
        "Four dyads, all real: every two make a linkage.",
        "five_poses.csv",
        {"solutions.distinct": 4, "solutions.real": 4},
        "Burmester 1888",
        small=True,
    ),
    linkages(
        "path-timing",
        "Five points at five angles of the crank",
        "",
        "five_timed_points.csv",
        {"settled": True},
        "made from a crank-rocker, which is found again",
    ),
    linkages(
        "function-generation",
        "Five pairs of angles",
        "",
        "five_angle_pairs.json",
        {"settled": True},
        "Freudenstein 1955",
    ),
    linkages(
        "poses-and-points",
        "Three poses and four points",
        "",
        "three_poses_four_points.csv",
        {"settled": True},
        "made from a crank-rocker, which is found again",
    ),
    linkages(
        "nine-point",
        "Nine points",
        "1442 classes of linkages, three cognates in each; 64 real curves pass these points.",
        "nine_points.csv",
        {"settled": True},
        "Wampler, Morgan, Sommese 1992",
    ),
]
