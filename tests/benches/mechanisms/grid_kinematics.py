"""Forward kinematics for grid.py, many postures at once, that share nothing with the program that is tried.

Values of joints are arrays of shape (postures, joints) in radians and metres; poses have shape (postures, 4, 4). Gaps and
screws are in radians and in parts of the arm's size.
"""

import numpy as np

# Singular values below this part of the largest count as 0.
SINGULAR = 1e-6
# A tool is at a pose within this.
AT_POSE = 1e-12


class Kinematics:
    """An arm's forward kinematics. `lock` holds a joint by number and value in degrees."""

    def __init__(self, rows, lock=None):
        self.kinds = np.array([kind == "R" for kind, *_ in rows])
        numbers = np.array([row[1:] for row in rows], dtype=float)
        self.theta, self.d, self.a = np.radians(numbers[:, 0]), numbers[:, 1], numbers[:, 2]
        self.twist = [exact_turn(alpha) for alpha in numbers[:, 3]]
        self.size = max(float(np.abs(self.d).sum() + np.abs(self.a).sum()), 1e-3)
        self.free = [k for k in range(len(rows)) if lock is None or k != lock[0]]
        self.lock = lock
        self.names = [f"q{k + 1}" for k in range(len(rows))]

    def with_lock(self, free_values):
        """Values of all joints from those of the free ones."""
        free_values = np.atleast_2d(free_values)
        values = np.zeros((len(free_values), len(self.names)))
        values[:, self.free] = free_values
        if self.lock is not None:
            values[:, self.lock[0]] = np.radians(self.lock[1])
        return values

    def poses(self, values):
        """The tool's poses."""
        return self.screws(values)[1]

    def screws(self, values):
        """The screws of the free joints about the tool's origin, of shape (postures, 6, free joints), and the tool's poses."""
        frame = np.broadcast_to(np.eye(4), (len(values), 4, 4)).copy()
        axes, points = [], []
        for k, is_turn in enumerate(self.kinds):
            axes.append(frame[:, :3, 2].copy())
            points.append(frame[:, :3, 3].copy())
            angle = self.theta[k] + (values[:, k] if is_turn else np.zeros(len(values)))
            shift = self.d[k] + (np.zeros(len(values)) if is_turn else values[:, k])
            frame = frame @ self.row(k, angle, shift)
        tool = frame[:, :3, 3]
        columns = []
        for k in self.free:
            if self.kinds[k]:
                columns.append(np.concatenate([axes[k], cross(axes[k], (tool - points[k]) / self.size)], axis=1))
            else:
                columns.append(np.concatenate([np.zeros_like(axes[k]), axes[k]], axis=1))
        return np.stack(columns, axis=2), frame

    def row(self, k, angle, shift):
        """The motion by joint k and its link."""
        (ca, sa), c, s, a = self.twist[k], np.cos(angle), np.sin(angle), self.a[k]
        motion = np.zeros((len(shift), 4, 4))
        motion[:, 0, 0], motion[:, 0, 1], motion[:, 0, 2], motion[:, 0, 3] = c, -s * ca, s * sa, a * c
        motion[:, 1, 0], motion[:, 1, 1], motion[:, 1, 2], motion[:, 1, 3] = s, c * ca, -c * sa, a * s
        motion[:, 2, 1], motion[:, 2, 2], motion[:, 2, 3], motion[:, 3, 3] = sa, ca, shift, 1.0
        return motion

    def steps(self, free_steps):
        """Steps of all joints, in radians and metres, from those of free ones in parts of the size."""
        steps = np.zeros((len(free_steps), len(self.names)))
        steps[:, self.free] = free_steps * np.where(self.kinds[self.free], 1.0, self.size)
        return steps

    def apart(self, values, others):
        """Differences of values: turns by the shorter way, shifts in parts of the size."""
        differences = np.asarray(values) - np.asarray(others)
        turns = (differences + np.pi) % (2 * np.pi) - np.pi
        return np.abs(np.where(self.kinds, turns, differences / self.size))

    def reach(self, poses, values, steps=60):
        """Brings tools to poses from values (K. Levenberg 1944, D. Marquardt 1963); the values, and the gaps that are left."""
        values = values.copy()
        screws, tools = self.screws(values)
        gaps = gap(tools, poses, self.size)
        damping = np.full(len(values), 1.0)
        identity = np.eye(6)
        for _ in range(steps):
            length = np.linalg.norm(gaps, axis=1)
            if length.max(initial=0.0) < 2e-15:
                break
            weights = np.maximum(damping * length, 4e-15)
            normal = screws @ screws.transpose(0, 2, 1) + weights[:, None, None] * identity
            free_steps = (screws.transpose(0, 2, 1) @ np.linalg.solve(normal, gaps[:, :, None]))[:, :, 0]
            longest = np.abs(free_steps).max(axis=1, initial=0.0)
            free_steps *= np.minimum(1.0, 1.0 / np.maximum(longest, 1e-300))[:, None]
            tried = values + self.steps(free_steps)
            tried_screws, tools = self.screws(tried)
            tried_gaps = gap(tools, poses, self.size)
            better = np.linalg.norm(tried_gaps, axis=1) < length
            values[better], screws[better], gaps[better] = tried[better], tried_screws[better], tried_gaps[better]
            damping = np.where(better, np.maximum(damping / 4.0, 1e-6), np.minimum(damping * 6.0, 1e12))
        return values, np.abs(gaps).max(axis=1)

    def at_rest(self, values):
        """Velocities of the free joints that leave the tool at rest, as rows; and the least part of a singular value."""
        screws, _ = self.screws(values[None])
        _, sizes, rows = np.linalg.svd(screws[0], full_matrices=True)
        rank = int((sizes > SINGULAR * sizes[0]).sum())
        return rows[rank:], sizes[-1] / sizes[0]


def exact_turn(degrees):
    """Cosine and sine of an angle, exact for right angles."""
    right = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), -90.0: (0.0, -1.0), 180.0: (-1.0, 0.0), -180.0: (-1.0, 0.0)}
    return right.get(degrees, (np.cos(np.radians(degrees)), np.sin(np.radians(degrees))))


def cross(a, b):
    """Products of vectors, in a fifth of numpy's time."""
    return np.stack([a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1], a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2], a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]], 1)


def gap(tools, poses, size):
    """What turns and shifts tools to poses: the axis of the turn times twice the sine of half the angle, and shifts."""
    between = poses[:, :3, :3] @ tools[:, :3, :3].transpose(0, 2, 1)
    vector = np.stack(
        [between[:, 2, 1] - between[:, 1, 2], between[:, 0, 2] - between[:, 2, 0], between[:, 1, 0] - between[:, 0, 1]], axis=1
    )
    trace = np.trace(between, axis1=1, axis2=2)
    # 2 sin(h) times the axis, from sin(2h) times the axis twice; at half turns the axis is read off the symmetric part.
    half = np.sqrt(np.maximum((1.0 + trace) / 4.0, 0.0))
    turned = np.where(half[:, None] > 0.1, vector / np.maximum(2.0 * half, 1e-9)[:, None], half_turn(between, vector))
    return np.concatenate([turned, (poses[:, :3, 3] - tools[:, :3, 3]) / size], axis=1)


def half_turn(between, vector):
    """The same for turns by nearly 180 degrees."""
    symmetric = (between + between.transpose(0, 2, 1)) / 2.0 + np.eye(3)
    column = np.argmax(np.einsum("kii->ki", symmetric), axis=1)
    axis = np.take_along_axis(symmetric, column[:, None, None], axis=2)[:, :, 0]
    axis = axis / np.maximum(np.linalg.norm(axis, axis=1), 1e-300)[:, None]
    sign = np.where(np.einsum("ki,ki->k", axis, vector) < 0.0, -1.0, 1.0)
    return 2.0 * axis * sign[:, None]


def quaternion(rotation):
    """w, x, y, z of a rotation."""
    r = rotation
    candidates = [
        [1 + r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[0, 2] + r[2, 0]],
        [r[0, 2] - r[2, 0], r[1, 0] + r[0, 1], 1 - r[0, 0] + r[1, 1] - r[2, 2], r[2, 1] + r[1, 2]],
        [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[2, 1] + r[1, 2], 1 - r[0, 0] - r[1, 1] + r[2, 2]],
    ]
    longest = np.array(max(candidates, key=lambda c: np.dot(c, c)))
    return longest / np.linalg.norm(longest)


# Step along a curve of postures: radians and parts of the size.
STEP = 0.05
# Steps along a curve at most, in each direction: a turn and a half of two joints.
MOST_STEPS = 270


def curves(arm, poses, starts):
    """Postures along the curves through postures of poses along which tools stay at rest, in both directions; of shape
    (starts, postures, joints), and nan where a curve could not be followed or is none."""
    rest, sizes = rests(arm, starts)
    velocities = np.concatenate([rest[:, -1], -rest[:, -1]])
    goals, values = np.concatenate([poses, poses]), np.concatenate([starts, starts])
    alive = np.concatenate([sizes, sizes])[:, -1] < SINGULAR
    samples = [np.where(alive[:, None], values, np.nan)]
    for _ in range(MOST_STEPS):
        if not alive.any():
            break
        values[alive], left = arm.reach(goals[alive], values[alive] + arm.steps(STEP * velocities[alive]), 5)
        rest, sizes = rests(arm, values[alive])
        free = (sizes < SINGULAR).astype(float)
        along = np.einsum("kij,ki->kj", rest, free * np.einsum("kij,kj->ki", rest, velocities[alive]))
        length = np.linalg.norm(along, axis=1)
        velocities[alive] = along / np.maximum(length, 1e-300)[:, None]
        alive[np.nonzero(alive)[0][(left > 1e-6) | (length < 0.3)]] = False
        samples.append(np.where(alive[:, None], values, np.nan))
    samples = np.stack(samples, axis=1)
    return np.concatenate(np.split(samples, 2), axis=1)


def rests(arm, values):
    """Velocities of the free joints as rows, by how little they move the tool, and the singular values as parts of the largest."""
    screws, _ = arm.screws(values)
    _, sizes, rows = np.linalg.svd(screws, full_matrices=True)
    padded = np.zeros((len(values), rows.shape[1]))
    padded[:, : sizes.shape[1]] = sizes / sizes[:, :1]
    return rows, padded


def slides_to(arm, pose, start, goal, accuracy, steps=150):
    """Whether an arm that keeps its tool at a pose slides from one posture to another, down the distance between them."""
    values = start[None].copy()
    for _ in range(steps):
        difference = goal - values[0]
        turns = (difference + np.pi) % (2 * np.pi) - np.pi
        difference = np.where(arm.kinds, turns, difference / arm.size)[arm.free]
        rest, _ = arm.at_rest(values[0])
        along = rest.T @ (rest @ difference)
        length = np.abs(along).max(initial=0.0)
        if length < accuracy / 10:
            break
        values, left = arm.reach(pose[None], values + arm.steps(along[None] * min(1.0, 0.1 / length)), 6)
        if left[0] > 1e-9:
            return False
    return bool(arm.apart(values[0], goal).max() < accuracy)
