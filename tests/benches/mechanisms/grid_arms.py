"""Arms of vendors and textbooks for grid.py: rows of standard Denavit-Hartenberg tables, lengths in metres, angles in degrees.

A row is (type, theta, d, a, alpha): R turns by theta plus the joint's value, P shifts by d plus it. `lock` holds a joint of a
redundant arm: its number from 0, and its value in degrees.
"""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Arm:
    """An arm with its table."""

    name: str
    rows: tuple
    lock: tuple | None = None


def turning(*rows):
    """Rows (d, a, alpha) of joints that turn."""
    return tuple(("R", 0.0, float(d), float(a), float(alpha)) for d, a, alpha in rows)


def reversed_rows(rows):
    """The arm as it is seen from its hand: the same axes in the other order, behind a link of 0.2 and before one of 0.1."""
    first = ("R", 0.0, 0.2, rows[4][3], rows[4][4])
    middle = [("R", 0.0, rows[5 - k][2], rows[4 - k][3], rows[4 - k][4]) for k in range(1, 5)]
    return (first, *middle, ("R", 0.0, 0.1, 0.0, 0.0))


def reflected_rows(rows):
    """The arm in a mirror: twists and offsets along axes change their signs."""
    return tuple((kind, -theta, -d, a, -alpha) for kind, theta, d, a, alpha in rows)


UR3 = turning((0.1519, 0, 90), (0, -0.24365, 0), (0, -0.21325, 0), (0.11235, 0, 90), (0.08535, 0, -90), (0.0819, 0, 0))
UR5E = turning((0.1625, 0, 90), (0, -0.425, 0), (0, -0.3922, 0), (0.1333, 0, 90), (0.0997, 0, -90), (0.0996, 0, 0))
UR10E = turning((0.1807, 0, 90), (0, -0.6127, 0), (0, -0.57155, 0), (0.17415, 0, 90), (0.11985, 0, -90), (0.11655, 0, 0))
KR6 = turning((0.4, 0.025, -90), (0, 0.455, 0), (0, 0.035, -90), (0.42, 0, 90), (0, 0, -90), (0.08, 0, 0))
KR6_R900 = turning((-0.4, 0.025, 90), (0, 0.455, 0), (0, 0.035, 90), (-0.42, 0, -90), (0, 0, 90), (-0.08, 0, 180))
IRB140 = turning((0.352, 0.07, -90), (0, 0.36, 0), (0, 0, -90), (0.38, 0, 90), (0, 0, -90), (0.065, 0, 0))
IRB1600 = turning((0.4865, 0.15, -90), (0, 0.475, 0), (0, 0, -90), (0.6, 0, 90), (0, 0, -90), (0.065, 0, 0))
PUMA = turning((0, 0, 90), (0, 0.4318, 0), (0.15, 0.0203, -90), (0.4318, 0, 90), (0, 0, -90), (0, 0, 0))
STANFORD = (
    ("R", 0.0, 0.412, 0.0, -90.0),
    ("R", 0.0, 0.154, 0.0, 90.0),
    ("P", 0.0, 0.3, 0.0, 0.0),
    ("R", 0.0, 0.0, 0.0, -90.0),
    ("R", 0.0, 0.0, 0.0, 90.0),
    ("R", 0.0, 0.263, 0.0, 0.0),
)
CRX = turning((0, 0, -90), (0, 0.54, 0), (0, 0, -90), (0.54, 0, 90), (-0.15, 0, -90), (0.16, 0, 0))
XARM6 = turning((0.267, 0, -90), (0, 0.28949, 0), (0, 0.0775, -90), (0.3425, 0, 90), (0, 0.076, -90), (0.097, 0, 0))
PIPER = turning((0.123, 0, -90), (0, 0.28503, 0), (0, -0.02198, 90), (0.25075, 0, -90), (0, 0, 90), (0.091, 0, 0))
JACO = turning((0.2755, 0, 90), (0, 0.41, 180), (-0.0098, 0, 90), (-0.2501, 0, 60), (-0.0856, 0, 60), (-0.2028, 0, 180))
JACO_SPHERICAL = turning((0.2755, 0, 90), (0, 0.41, 180), (-0.0098, 0, 90), (-0.3111, 0, 90), (0, 0, 90), (-0.2638, 0, 180))
PANDA = turning(
    (0.333, 0, -90), (0, 0, 90), (0.316, 0.0825, 90), (0, -0.0825, -90), (0.384, 0, 90), (0, 0.088, 90), (0.107, 0, 0)
)
IIWA = turning((0.36, 0, -90), (0, 0, 90), (0.42, 0, 90), (0, 0, -90), (0.4, 0, -90), (0, 0, 90), (0.126, 0, 0))
GEN3 = turning(
    (-0.2848, 0, 90),
    (-0.0118, 0, 90),
    (-0.4208, 0, 90),
    (-0.0128, 0, 90),
    (-0.3143, 0, 90),
    (0, 0, 90),
    (-0.1674, 0, 180),
)
TX90 = (
    ("R", 0.0, 0.478, 0.05, -90.0),
    ("R", -90.0, 0.0, 0.425, 0.0),
    ("R", 90.0, 0.05, 0.0, 90.0),
    ("R", 0.0, 0.425, 0.0, -90.0),
    ("R", 0.0, 0.0, 0.0, 90.0),
    ("R", 0.0, 0.1, 0.0, 0.0),
)
HC10 = turning((0.275, 0, 90), (0, 0.7, 0), (0, 0, 90), (0.5, 0, -90), (0.162, 0, 90), (0.13, 0, 0))
DOOSAN = turning((0.135, 0, -90), (0.0062, 0.411, 0), (0, 0, 90), (0.368, 0, -90), (0, 0, 90), (0.121, 0, 0))
LR_MATE = turning((0, 0.05, -90), (0, 0.33, 180), (0, 0.035, -90), (-0.335, 0, 90), (0, 0, -90), (-0.08, 0, 180))
YOUBOT = turning((0.147, 0.033, 90), (0, 0.155, 0), (0, 0.135, 0), (0, 0, 90), (0.2175, 0, 0))
SCARA = (
    ("R", 0.0, 0.4, 0.225, 0.0),
    ("R", 0.0, 0.0, 0.275, 180.0),
    ("P", 0.0, 0.0, 0.0, 0.0),
    ("R", 0.0, 0.05, 0.0, 0.0),
)

ARMS = [
    Arm("UR3", UR3),
    Arm("UR5e", UR5E),
    Arm("UR10e", UR10E),
    Arm("KR 6", KR6),
    Arm("KR 6 R900", KR6_R900),
    Arm("KR 6, from its hand", reversed_rows(KR6)),
    Arm("KR 6, in a mirror", reflected_rows(KR6)),
    Arm("IRB 140", IRB140),
    Arm("IRB 1600", IRB1600),
    Arm("PUMA 560", PUMA),
    Arm("Stanford", STANFORD),
    Arm("CRX-10iA", CRX),
    Arm("xArm6", XARM6),
    Arm("PiPER", PIPER),
    Arm("Jaco, spherical wrist", JACO_SPHERICAL),
    Arm("Jaco, 60 degrees", JACO),
    Arm("Panda, q7 held", PANDA, (6, 45.0)),
    Arm("iiwa 14, q3 held", IIWA, (2, 30.0)),
    Arm("Gen3, q3 held", GEN3, (2, 0.0)),
    Arm("Staubli TX90", TX90),
    Arm("Motoman HC10", HC10),
    Arm("Doosan M0609", DOOSAN),
    Arm("LR Mate 200iD", LR_MATE),
    Arm("youBot (5R)", YOUBOT),
    Arm("SCARA", SCARA),
]
