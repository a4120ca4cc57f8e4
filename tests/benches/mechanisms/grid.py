"""The grid: does `cognate mechanism inverse` answer the postures of real arms at every pose, also at special ones?

    python3 grid.py [PROGRAM] [--poses N] [--arms NAME,..] [--kinds KIND,..] [--searches N] [--record FILE]

Poses are made by joint values with a forward kinematics of this folder's own: joints at -90, 0 and 90 degrees, at random,
stretched elbows and aligned wrists, straight lines of the tool. Of each pose it is seen whether the posture that made it is
among the answers, or on a set that is answered; whether postures that a search from values at random reaches are there, too;
whether every answer leads to the pose within 1e-9, and none is listed twice. A settled answer that lacks a posture is wrong.
`--poses` limits the poses of a kind; 800 are all. `--record` writes every pose that is not right and settled as a line of JSON.
The exit code is 1 where a settled answer is wrong.
"""

import argparse
import collections
import itertools
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from grid_arms import ARMS
from grid_kinematics import AT_POSE, STEP, Kinematics, curves, quaternion, slides_to

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
KINDS = ["right angles", "random", "aligned", "lines"]
# Poses that the program is asked for at a time.
BATCH = 150
# A batch has hung after this.
LIMIT_SECONDS = 300
# Answers lead to the pose within this: metres, and entries of the rotation.
CLOSES = 1e-9
# A regular posture is answered within this, a singular one within the second: the pose's 16 digits say no more of a fourfold one.
NEAR = 1e-6
NEAR_SINGULAR = 1e-3
# Straight lines, and postures of each.
LINES, LINE = 50, 100

Case = collections.namedtuple("Case", "values pose")


def right_angles(arm, most):
    """Free joints at -90, 0 and 90 degrees; of shifts the values are 0, 0.1 and 0.2."""
    digits = np.array(list(itertools.product([-90.0, 0.0, 90.0], repeat=len(arm.free))))
    if len(digits) > most:
        digits = digits[np.random.default_rng(1).choice(len(digits), most, replace=False)]
    kinds = arm.kinds[arm.free]
    return arm.with_lock(np.where(kinds, np.radians(digits), 0.1 + digits / 900.0))


def random_values(arm, number, seed):
    """Joints at random, shifts within the arm's size."""
    values = np.random.default_rng(seed).uniform(-1.0, 1.0, (number, len(arm.free)))
    return arm.with_lock(values * np.where(arm.kinds[arm.free], np.pi, 0.5 * arm.size))


def aligned(arm, most):
    """One joint of random postures, or of those at right angles, is turned until the screws of all depend."""
    generator = np.random.default_rng(3)
    candidates = random_values(arm, 4 * most, 4)
    made = []
    for count, values in enumerate(candidates):
        if count % 3 == 2:
            values[:2] = np.radians(generator.choice([-90.0, 0.0, 90.0], 2))
        joint = [2, 4, 1, 3][count % 4] % len(arm.names)
        turned = dependent(arm, values, joint)
        if turned is not None:
            made.append(turned)
        if len(made) == most:
            break
    return np.array(made) if made else np.zeros((0, len(arm.names)))


def dependent(arm, values, joint):
    """The values with a joint turned to where the screws depend: a zero of their determinant; `None` where there is none."""
    if joint not in arm.free or len(arm.free) != 6:
        return None

    def determinants(angles):
        turned = np.repeat(values[None], len(angles), axis=0)
        turned[:, joint] = angles
        return np.linalg.det(arm.screws(turned)[0])

    angles = np.linspace(-3.1, 3.1, 40)
    signs = np.sign(determinants(angles))
    changes = np.nonzero(signs[1:] * signs[:-1] < 0)[0]
    if not len(changes):
        return None
    low, high = angles[changes[0]], angles[changes[0] + 1]
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sign(determinants([middle])[0]) == signs[changes[0]] else (low, middle)
    turned = values.copy()
    turned[joint] = 0.0 if abs(low) < 1e-12 else low
    return turned


def lines(arm, most):
    """Postures along straight lines of the tool, each reached from the one before it."""
    if len(arm.free) < 6:
        return np.zeros((0, len(arm.names)))
    directions = np.random.default_rng(6).normal(size=(LINES, 3))
    values = random_values(arm, LINES, 5)
    poses, made = arm.poses(values), [values]
    poses = poses.copy()
    for _ in range(LINE - 1):
        poses[:, :3, 3] += 0.3 * arm.size / LINE * directions / np.linalg.norm(directions, axis=1)[:, None]
        values, _ = arm.reach(poses, values, 8)
        made.append(values)
    # Where a line leaves the arm's reach the posture makes another pose, which is as good.
    made = np.concatenate(made)
    return made[:: max(1, len(made) // most)][:most]


def made_by(arm, kind, most):
    """Values of a kind."""
    if kind == "right angles":
        return right_angles(arm, most)
    if kind == "random":
        return random_values(arm, most, 2)
    return aligned(arm, most) if kind == "aligned" else lines(arm, most)


def write_table(arm, path):
    """The arm's file."""
    with open(path, "w", encoding="utf-8") as file:
        file.write("# convention: standard\n# angles: deg\ntype,theta,d,a,alpha\n")
        for kind, theta, d, a, alpha in arm.rows:
            file.write(f"{kind},{theta!r},{d!r},{a!r},{alpha!r}\n")


def write_poses(poses, path):
    """The poses' file."""
    with open(path, "w", encoding="utf-8") as file:
        file.write("x,y,z,qw,qx,qy,qz\n")
        for pose in poses:
            numbers = [*pose[:3, 3], *quaternion(pose[:3, :3])]
            file.write(",".join(repr(float(x)) for x in numbers) + "\n")


class Program:
    """The program that is tried, with a folder of its own."""

    def __init__(self, path, folder):
        self.path, self.folder = path, folder

    def answers(self, arm, poses):
        """The answers to poses, the CPU seconds, and what is wrong with the run as a whole; no answers where it refuses."""
        table, file = os.path.join(self.folder, "arm.csv"), os.path.join(self.folder, "poses.csv")
        write_table(arm, table)
        write_poses(poses, file)
        lock = [] if arm.lock is None else ["--lock", f"q{arm.lock[0] + 1}={arm.lock[1]}"]
        command = [self.path, "mechanism", "inverse", table, "--poses", file, "--format", "json", *lock]
        command += ["--cache", os.path.join(self.folder, "cache")]
        start = time.monotonic()
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return None, time.monotonic() - start, f"no answer in {LIMIT_SECONDS} s"
        if done.returncode not in (0, 1):
            return None, time.monotonic() - start, f"exit {done.returncode}: {done.stderr.strip()[:200]}"
        answer = json.loads(done.stdout)
        settled = all(target["settled"] for target in answer["targets"])
        fault = None
        if done.returncode == 0 and not (settled and answer["settled"]):
            fault = "exit 0 and not settled"
        if len(answer["targets"]) != len(poses):
            return None, answer["time"]["cpu_seconds"], f"{len(answer['targets'])} answers to {len(poses)} poses"
        return answer["targets"], answer["time"]["cpu_seconds"], fault


def values_of(arm, posture):
    """Values of all joints of an answered posture."""
    values = np.zeros(len(arm.names))
    if arm.lock is not None:
        values[arm.lock[0]] = np.radians(arm.lock[1])
    for k in arm.free:
        values[k] = posture["inputs"][arm.names[k]]
    return values


class Judge:
    """What is wrong with the answer at a pose."""

    def __init__(self, arm, target, pose, along):
        self.arm, self.pose, self.target, self.along = arm, pose, target, along
        real = [solution for solution in target["solutions"] if solution["real"]]
        self.values = np.array([values_of(arm, solution) for solution in real]).reshape(len(real), len(arm.names))
        self.is_singular = np.array([solution["singular"] for solution in real], dtype=bool)
        self.set_values = [values_of(arm, answered["posture"]) for answered in target["sets"]]

    def has(self, values):
        """Whether a posture is among the answers, near a singular one, or on a set."""
        near = NEAR
        _, least = self.arm.at_rest(values)
        if least < 1e-2:
            # Digits of a nearly singular posture are lost where it is searched for, and where it is answered.
            near = min(NEAR_SINGULAR, max(NEAR, 1e-13 / max(least, 1e-12) ** 2))
        if len(self.values):
            apart = self.arm.apart(self.values, values).max(axis=1)
            if (apart < np.where(self.is_singular, NEAR_SINGULAR, near)).any():
                return True
        # Postures of sets are singular.
        if least > 1e-4 or not self.set_values:
            return False
        with np.errstate(invalid="ignore"):
            if len(self.along) and (self.arm.apart(self.along, values).max(axis=1) < STEP).any():
                return True
        return any(slides_to(self.arm, self.pose, start, values, NEAR_SINGULAR) for start in self.set_values)

    def misses(self):
        """Answers that do not lead to the pose, or that are listed twice; in words."""
        faults = []
        if len(self.values):
            left = np.abs(self.arm.poses(self.values) - self.pose).max()
            if not left < CLOSES:
                faults.append(f"an answer is off by {left:.1e}")
        regular = self.values[~self.is_singular]
        for k in range(1, len(regular)):
            if self.arm.apart(regular[:k], regular[k]).max(axis=1).min() < 1e-9:
                faults.append("a regular posture is listed twice")
                break
        return faults


def searched(arm, poses, number):
    """Postures of each pose that are reached from values at random."""
    if number == 0 or not len(poses):
        return [[] for _ in poses]
    starts = random_values(arm, number * len(poses), 7)
    many = np.repeat(poses, number, axis=0)
    reached, left = arm.reach(many, starts)
    good = (left < AT_POSE).reshape(len(poses), number)
    reached = reached.reshape(len(poses), number, -1)
    return [reached[k][good[k]] for k in range(len(poses))]


def along_sets(arm, targets, poses):
    """Postures along the answered curves of each pose."""
    starts = [(k, values_of(arm, answered["posture"])) for k, target in enumerate(targets) for answered in target["sets"]]
    along = [np.zeros((0, len(arm.names))) for _ in targets]
    if starts:
        places = [k for k, _ in starts]
        traced = curves(arm, poses[places], np.array([values for _, values in starts]))
        for place, samples in zip(places, traced):
            along[place] = np.concatenate([along[place], samples])
    return along


def judged(arm, case, target, others, along):
    """The class of an answer, and why."""
    judge = Judge(arm, target, case.pose, along)
    faults = judge.misses()
    is_there = judge.has(case.values)
    if is_there and not faults:
        lacking = [values for values in others if not judge.has(values)]
        if lacking:
            faults.append(f"{len(lacking)} searched postures are missing: {np.degrees(lacking[0]).round(4).tolist()}")
    if not is_there:
        faults.insert(0, "the posture that made the pose is missing")
    if target["settled"]:
        return ("settled and wrong", faults) if faults else ("right and settled", [])
    if not is_there:
        return "in doubt and missing", faults + target["warnings"]
    return ("in doubt, another missing", faults + target["warnings"]) if faults else ("right and in doubt", target["warnings"])


CLASSES = [
    "poses",
    "right and settled",
    "right and in doubt",
    "in doubt, another missing",
    "in doubt and missing",
    "settled and wrong",
    "refused",
    "CPU s",
]


def tried(program, table, kinds, options, record):
    """A row of the table: numbers of poses of an arm by class, and its reasons."""
    arm = Kinematics(table.rows, table.lock)
    arm.rows = table.rows
    row, reasons = collections.Counter(), collections.Counter()
    for kind in kinds:
        values = made_by(arm, kind, options.poses)
        for first in range(0, len(values), BATCH):
            part = values[first : first + BATCH]
            poses = arm.poses(part)
            targets, seconds, fault = program.answers(arm, poses)
            row["poses"] += len(part)
            row["CPU s"] += seconds
            if targets is None:
                row["refused"] += len(part)
                reasons[fault] += len(part)
                continue
            if fault:
                reasons[fault] += 1
                row["settled and wrong"] += 1
            searches, along = searched(arm, poses, options.searches), along_sets(arm, targets, poses)
            for k, target in enumerate(targets):
                case = Case(part[k], poses[k])
                verdict, faults = judged(arm, case, target, searches[k], along[k])
                row[verdict] += 1
                if verdict == "right and settled":
                    continue
                reasons[f"{verdict}, {kind}: {'; '.join(faults)[:140]}"] += 1
                if record:
                    said = {"arm": table.name, "kind": kind, "verdict": verdict, "faults": faults, "route": target["route"]}
                    said |= {"degrees": np.degrees(case.values).tolist(), "values": case.values.tolist()}
                    said |= {"counts": target["configurations"], "sets": len(target["sets"])}
                    record.write(json.dumps(said) + "\n")
                    record.flush()
    return row, reasons


def line(name, row):
    """A row of the printed table."""
    numbers = [f"{row[key]:.1f}" if key == "CPU s" else str(row[key]) for key in CLASSES]
    return "| " + " | ".join([name, *numbers]) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", nargs="?", default=os.environ.get("COGNATE", os.path.join(ROOT, "target/release/cognate")))
    parser.add_argument("--poses", type=int, default=25, help="poses of a kind at most")
    parser.add_argument("--arms", help="names, or parts of them, with commas")
    parser.add_argument("--kinds", help=f"of {', '.join(KINDS)}")
    parser.add_argument("--searches", type=int, default=6, help="values at random from which each pose is searched")
    parser.add_argument("--record", help="a file for poses that are not right and settled")
    options = parser.parse_args()
    kinds = [kind for kind in KINDS if options.kinds is None or kind in options.kinds.split(",")]
    arms = [arm for arm in ARMS if options.arms is None or any(part in arm.name for part in options.arms.split(","))]
    record = open(options.record, "w", encoding="utf-8") if options.record else None  # noqa: SIM115: open to the end
    print("| arm | " + " | ".join(CLASSES) + " |")
    print("|---" * (len(CLASSES) + 1) + "|", flush=True)
    total = collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        program = Program(options.program, folder)
        for table in arms:
            row, reasons = tried(program, table, kinds, options, record)
            print(line(table.name, row), flush=True)
            total.update(row)
            for reason, number in reasons.most_common(8):
                print(f"{table.name}: {number} x {reason}", file=sys.stderr, flush=True)
    print(line("together", total))
    sys.exit(1 if total["settled and wrong"] else 0)


if __name__ == "__main__":
    main()
