"""Cusps of the critical values of arms of three turns, counted by following the singular curve: python cusps.py

The curve det J = 0 is followed on a grid of the second and third turn, with positions by products of
Denavit-Hartenberg rows and derivatives by differences. Where (tangent x kernel) changes its sign along the curve
there is a cusp. The number of postures is that of the real roots of a resultant, by a companion matrix, at random
positions. Needs numpy.
"""

from __future__ import annotations

import numpy as np

# (a, twist in degrees, d) of each row.
Arm = list[tuple[float, float, float]]
CELLS = 700
STEP = 1e-5


def displaced(point, row):
    """The point moved along a row behind its turn."""
    a, twist, d = row
    c, s = np.cos(np.radians(twist)), np.sin(np.radians(twist))
    x, y, z = point
    return x + a, c * y - s * z, s * y + c * z + d


def turned(point, angle):
    """The point turned about z."""
    x, y, z = point
    c, s = np.cos(angle), np.sin(angle)
    return c * x - s * y, s * x + c * y, z


def position(arm: Arm, q2, q3):
    """The point in the frame of the first joint."""
    zero = np.zeros_like(q2 + q3)
    point = turned(displaced((zero, zero, zero), arm[2]), q3)
    return displaced(turned(displaced(point, arm[1]), q2), arm[0])


def image(arm: Arm, q2, q3):
    """The square of the distance from the first axis, and the height."""
    x, y, z = position(arm, q2, q3)
    return np.array([x * x + y * y, z])


def derivatives(arm: Arm, q2, q3):
    """Of the image by each of the turns."""
    by_second = image(arm, q2 + STEP, q3) - image(arm, q2 - STEP, q3)
    by_third = image(arm, q2, q3 + STEP) - image(arm, q2, q3 - STEP)
    return by_second / (2 * STEP), by_third / (2 * STEP)


def determinant(arm: Arm, q2, q3):
    """0 where the arm is singular; of orthogonal arms only where the point is not on the second axis."""
    (d2, first, _), (d3, second, r2), (_, _, r3) = arm
    if (first, second, r3) == (-90, 90, 0):
        return d2 * np.sin(q3) + (d3 * np.sin(q3) - r2 * np.cos(q3)) * np.cos(q2)
    by_second, by_third = derivatives(arm, q2, q3)
    return by_second[0] * by_third[1] - by_third[0] * by_second[1]


def along_curve(arm: Arm, q2, q3):
    """A direction in which the image stands still, and its product with the gradient of the determinant."""
    by_second, by_third = derivatives(arm, q2, q3)
    kernels = [np.array([-by_third[k], by_second[k]]) for k in (0, 1)]
    kernel = np.where((kernels[0] ** 2).sum(0) > (kernels[1] ** 2).sum(0), kernels[0], kernels[1])
    step = 1e-4
    gradient = np.array(
        [
            determinant(arm, q2 + step, q3) - determinant(arm, q2 - step, q3),
            determinant(arm, q2, q3 + step) - determinant(arm, q2, q3 - step),
        ]
    )
    return kernel, (kernel * gradient).sum(0)


def cusps(arm: Arm) -> list[tuple[float, float]]:
    """Distance from the first axis and height of each cusp, to a few parts in a hundred."""
    grid = (np.arange(CELLS + 1) + 0.137) * 2 * np.pi / CELLS
    is_positive = determinant(arm, *np.meshgrid(grid, grid, indexing="ij")) > 0
    crossed, cells = {}, set()
    for axis in (0, 1):
        changes = is_positive[:-1, :] != is_positive[1:, :] if axis == 0 else is_positive[:, :-1] != is_positive[:, 1:]
        for i, j in np.argwhere(changes):
            crossed[axis, i, j] = len(crossed)
            cells |= {(i, j), (i, j - 1) if axis == 0 else (i - 1, j)}
    edges = np.array(list(crossed))
    low = np.array([grid[edges[:, 1]], grid[edges[:, 2]]])
    high = np.array([grid[edges[:, 1] + (edges[:, 0] == 0)], grid[edges[:, 2] + (edges[:, 0] == 1)]])
    begin = determinant(arm, *low)
    for _ in range(45):
        middle = (low + high) / 2
        is_before = determinant(arm, *middle) * begin > 0
        low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
    kernel, product = along_curve(arm, *low)
    places = []
    for i, j in cells:
        ends = [crossed[e] for e in ((0, i, j), (0, i, j + 1), (1, i, j), (1, i + 1, j)) if e in crossed]
        if len(ends) != 2 or not (0 <= i < CELLS and 0 <= j < CELLS):
            continue
        a, b = ends
        side = 1 if kernel[:, a] @ kernel[:, b] > 0 else -1
        if product[a] * product[b] * side < 0:
            square, height = image(arm, *low[:, a])
            places.append((round(float(np.sqrt(square)), 3), round(float(height), 3)))
    return sorted(places)


def most_postures(arm: Arm, positions: int = 400) -> int:
    """The largest number of postures of the places of random positions."""
    count = 17
    turns = 2 * np.pi * np.arange(count) / count
    most = 0
    for q in np.random.default_rng(1).uniform(0, 2 * np.pi, (positions, 2)):
        place = np.array(coordinates(arm, *q))[:, None]
        values = [np.array(coordinates(arm, np.full(count, at), turns)) for at in (0, np.pi / 2, np.pi)]
        constant = (values[0] + values[2]) / 2
        (b0, b1), (d0, d1), (u0, u1) = values[0] - constant, values[1] - constant, place - constant
        resultant = (u0 * d1 - u1 * d0) ** 2 + (b0 * u1 - b1 * u0) ** 2 - (b0 * d1 - b1 * d0) ** 2
        series = np.fft.fft(resultant) / count
        series = np.concatenate([series[-8:], series[:9]])
        series[abs(series) < 1e-13 * abs(series).max()] = 0
        angles = [np.angle(z) for z in np.roots(series[::-1]) if abs(abs(z) - 1) < 1e-6]
        postures = set()
        for angle in angles:
            k = [np.array(coordinates(arm, at, np.array(angle))) for at in (0, np.pi / 2, np.pi)]
            middle = (k[0] + k[2]) / 2
            matrix = np.array([k[0] - middle, k[1] - middle]).T
            if abs(np.linalg.det(matrix)) > 1e-9:
                turn = np.linalg.solve(matrix, place[:, 0] - middle)
                if abs(turn @ turn - 1) < 1e-5:
                    postures.add(round(float(angle), 4))
        most = max(most, len(postures))
    return most


def coordinates(arm: Arm, q2, q3):
    """The square of the distance from the origin, and the height: linear in cosine and sine of the second turn."""
    x, y, z = position(arm, q2, q3)
    return x * x + y * y + z * z, z


def orthogonal(d3: float, d4: float, r2: float) -> Arm:
    """Neighbouring axes at right angles, first length 1."""
    return [(1, -90, 0), (d3, 90, r2), (d4, 0, 0)]


ARMS = [
    orthogonal(2, 1.5, 1),
    orthogonal(0.5, 0.3, 0.2),
    orthogonal(2, 0.5, 0.5),
    orthogonal(2, 0.3, 2),
    orthogonal(3, 2, 1),
    orthogonal(0.3, 1.5, 0.2),
    orthogonal(0.5, 2.5, 0.3),
    orthogonal(0.5, 0.7, 0.4),
    orthogonal(0.2, 0.3, 1.5),
    orthogonal(1.5, 2.5, 0.5),
    orthogonal(2, 3, 0.3),
    [(1.36, 52, 0), (1.83, 62, 0.75), (1.62, 0, -0.99)],
    [(1.7, 62, 0), (1.66, 59, -0.49), (1.1, 0, -0.11)],
    [(1.16, 131, 0), (1.24, 107, 0.98), (1.99, 0, -0.57)],
    [(0.57, 25, 0), (1.34, 92, -0.07), (0.37, 0, 0.83)],
    [(1.37, 55, 0), (1.17, 22, -0.62), (1.14, 0, 0.38)],
    [(0.64, 136, 0), (0.93, 42, -0.46), (0.31, 0, 0.76)],
    [(1.17, 124, 0), (1.74, 33, 0.08), (1.39, 0, 0.02)],
    [(1.78, 28, 0), (0.91, 74, -0.35), (1.32, 0, -0.7)],
]

if __name__ == "__main__":
    for arm in ARMS:
        places = cusps(arm)
        print(arm, len(places), "cusps", places, "postures", most_postures(arm), flush=True)
