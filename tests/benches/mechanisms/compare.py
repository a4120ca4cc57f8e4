"""Every real posture of arms: time a pose and postures found, by cognate and by programs that pip installs.

Arguments: the program, the folder tests/mechanisms, how many poses each arm gets, how many in the batch that cognate is
timed with, and after how many seconds another program is stopped. All get the same rows of
Denavit-Hartenberg numbers and the same poses, which random joint angles reach. A posture counts when forward kinematics
leads from it to the pose within 1e-6, and none that was counted is nearer than 1e-4 radians. Times are CPU time of one
thread, but what is said to be by the wall.
"""

import collections
import csv
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from importlib import metadata

import numpy as np

LIMIT_SECONDS = int(sys.argv[5]) if len(sys.argv) > 5 else 60
ARMS = [
    ("general 6R", "arm_generic/arm.json"),
    ("UR10e as calibrated", "arm_ur10e_calibrated/arm.urdf"),
    ("UR10e nominal", "arm_ur10e/arm.urdf"),
    ("PUMA 560", "arm_puma560/arm.json"),
    ("Manseur and Doty", "arm_manseur_doty/arm.json"),
]


def angle(text):
    """Radians of an angle as the table writes it."""
    number, _, unit = text.partition(" ")
    return float(number) * (1.0 if unit == "rad" else np.pi / 180.0)


def rows_of(program, path):
    """Rows (theta, d, a, alpha) of an arm, without its base and tool, and their text."""
    text = subprocess.run(
        [program, "mechanism", "convert", path, "--to", "dh.csv"], capture_output=True, text=True, check=True
    ).stdout
    rows = [[angle(r["theta"]), float(r["d"]), float(r["a"]), angle(r["alpha"])] for r in csv.DictReader(text.splitlines())]
    return np.array(rows), text


def forward(rows, q):
    """The hand's pose."""
    pose = np.eye(4)
    for (theta, d, a, alpha), value in zip(rows, q):
        c, s, ca, sa = np.cos(theta + value), np.sin(theta + value), np.cos(alpha), np.sin(alpha)
        pose = pose @ np.array(
            [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        )
    return pose


def count(rows, pose, postures):
    """How many different postures reach the pose."""
    found = []
    for q in postures:
        q = np.array(q, dtype=float)
        if q.shape != (6,) or not np.all(np.isfinite(q)) or np.abs(forward(rows, q) - pose).max() > 1e-6:
            continue
        apart = [np.abs((q - other + np.pi) % (2 * np.pi) - np.pi).max() for other in found]
        if not apart or min(apart) > 1e-4:
            found.append(q)
    return len(found)


def quaternion(r):
    """w, x, y, z of a rotation."""
    w2 = 1 + r[0, 0] + r[1, 1] + r[2, 2]
    candidates = [
        [w2, r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
        [r[2, 1] - r[1, 2], 1 + r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[0, 2] + r[2, 0]],
        [r[0, 2] - r[2, 0], r[1, 0] + r[0, 1], 1 - r[0, 0] + r[1, 1] - r[2, 2], r[2, 1] + r[1, 2]],
        [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[2, 1] + r[1, 2], 1 - r[0, 0] - r[1, 1] + r[2, 2]],
    ]
    q = np.array(max(candidates, key=lambda c: np.dot(c, c)))
    return q / np.linalg.norm(q)


def urdf(rows):
    """The arm for programs that read URDF: joint i turns about the z of its frame."""
    links = "".join(f'<link name="l{i}"/>' for i in range(8))
    joints = []
    origin = "0 0 0", "0 0 0"
    for i, (theta, d, a, alpha) in enumerate(rows):
        joints.append(
            f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="{origin[0]}" rpy="{origin[1]}"/><axis xyz="0 0 1"/>'
            f'<limit lower="-3.141592653589793" upper="3.141592653589793" effort="1" velocity="1"/></joint>'
        )
        c, s = np.cos(theta), np.sin(theta)
        # Rz(theta) Tz(d) Tx(a) Rx(alpha) as xyz and roll, pitch, yaw.
        origin = f"{a * c!r} {a * s!r} {d!r}".replace("np.float64(", "").replace(")", ""), f"{float(alpha)!r} 0 {float(theta)!r}"
    tool = (
        '<joint name="tool" type="fixed"><parent link="l6"/><child link="l7"/>'
        f'<origin xyz="{origin[0]}" rpy="{origin[1]}"/></joint>'
    )
    return f'<robot name="arm">{links}{"".join(joints)}{tool}</robot>'


def eaik(rows):
    from eaik.IK_DH import DhRobot

    robot = DhRobot(rows[:, 3].copy(), rows[:, 2].copy(), rows[:, 1].copy())
    if not robot.hasKnownDecomposition():
        return None
    return lambda pose: [q - rows[:, 0] for q in robot.IK(pose).Q]


def ikdh(rows):
    import ikdh as module

    columns = [list(map(float, rows[:, k])) for k in (2, 1, 3, 0)]
    solver = module.Solver(module.DHTable(*columns))
    return lambda pose: [np.radians(q) for q in solver.solve(pose)]


def ssik(rows):
    import ssik as module

    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(urdf(rows))
        file.flush()
        arm = module.Manipulator.from_urdf(file.name, base="l0", ee="l7")
    if hasattr(arm, "prepare"):
        arm.prepare()
    return lambda pose: [s.q for s in arm.solve(pose)]


def toolbox(rows):
    import roboticstoolbox as rtb

    links = [rtb.RevoluteDH(d=d, a=a, alpha=alpha, offset=theta) for theta, d, a, alpha in rows]
    robot = rtb.DHRobot(links)
    return lambda pose: [robot.ik_LM(pose)[0]]


def ikpy(rows):
    from ikpy.chain import Chain

    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(urdf(rows))
        file.flush()
        chain = Chain.from_urdf_file(file.name, base_elements=["l0"], active_links_mask=[False] + [True] * 6 + [False])
    return lambda pose: [chain.inverse_kinematics_frame(pose, orientation_mode="all")[1:7]]


def pinocchio(rows):
    import pinocchio as pin

    model = pin.buildModelFromXML(urdf(rows))
    data = model.createData()
    frame = model.getFrameId("l7")

    def solve(pose):
        wanted = pin.SE3(pose[:3, :3], pose[:3, 3])
        q = pin.neutral(model)
        for _ in range(1000):
            pin.framesForwardKinematics(model, data, q)
            error = pin.log(data.oMf[frame].actInv(wanted)).vector
            if np.linalg.norm(error) < 1e-10:
                break
            jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL)
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-8 * np.eye(6), error)
            q = pin.integrate(model, q, step)
        return [q]

    return solve


PEERS = [
    ("EAIK", "EAIK", eaik, "all"),
    ("ikdh", "ikdh", ikdh, "all"),
    ("ssik", "ssik", ssik, "all"),
    ("robotics-toolbox, ik_LM", "roboticstoolbox-python", toolbox, "one"),
    ("ikpy", "ikpy", ikpy, "one"),
    ("Pinocchio, damped Newton", "pin", pinocchio, "one"),
]


def measured(prepare, rows, poses, sender):
    """In a process of its own: seconds to prepare, then of each pose, and what was found."""
    start = time.process_time()
    try:
        solve = prepare(rows)
    except Exception as error:  # noqa: BLE001: whatever another program says
        sender.send(("refuses", f"{type(error).__name__}: {error}"[:120]))
        return
    if solve is None:
        sender.send(("refuses", "no closed form"))
        return
    sender.send(("prepared", time.process_time() - start))
    for pose in poses:
        start = time.process_time()
        try:
            postures = list(solve(pose.copy()))
        except Exception:  # noqa: BLE001
            postures = []
        sender.send(("pose", time.process_time() - start, postures))
    sender.send(("done",))


def peer(prepare, rows, poses):
    """The median of milliseconds a pose, and postures found, or why there are none."""
    receiver, sender = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.Process(target=measured, args=(prepare, rows, poses, sender))
    process.start()
    end = time.monotonic() + LIMIT_SECONDS
    times, found, prepared, refused = [], 0, None, None
    while True:
        if not receiver.poll(max(0.0, end - time.monotonic())):
            refused = f"not done in {LIMIT_SECONDS} s"
            break
        try:
            message = receiver.recv()
        except EOFError:
            refused = "it died"
            break
        if message[0] == "refuses":
            refused = f"refuses ({message[1]})"
            break
        if message[0] == "done":
            break
        if message[0] == "prepared":
            prepared = message[1]
        else:
            found += count(rows, poses[len(times)], message[2])
            times.append(1000 * message[1])
    process.kill()
    process.join()
    if not times:
        return refused
    rest = f", {len(times)} of {len(poses)} poses" if len(times) < len(poses) else ""
    return f"{np.median(times):.3g} ms, {found}{rest} (prepared in {prepared:.2g} s)"


def run(program, arguments, text=None):
    start = time.monotonic()
    done = subprocess.run([program, "mechanism", *arguments], capture_output=True, text=True, input=text)
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    return done.stdout, time.monotonic() - start


def poses_csv(poses, path):
    with open(path, "w", encoding="utf-8") as file:
        file.write("x,y,z,qw,qx,qy,qz\n")
        for pose in poses:
            file.write(",".join(repr(float(x)) for x in [*pose[:3, 3], *quaternion(pose[:3, :3])]) + "\n")


def found_by(rows, poses, answer):
    total = 0
    for pose, target in zip(poses, answer["targets"]):
        total += count(rows, pose, [list(s["inputs"].values()) for s in target["solutions"]])
    return total


def cognate(program, folder, rows, table, poses, many):
    """Rows of the table: batches, with proof, and one pose alone."""
    arm, file = os.path.join(folder, "arm.csv"), os.path.join(folder, "poses.csv")
    with open(arm, "w", encoding="utf-8") as out:
        out.write(table)
    cache = ["--cache", os.path.join(folder, "cache"), "--threads", "1", "--format", "json"]
    poses_csv(poses, file)
    result = {}
    _, first = run(program, ["inverse", arm, "--poses", file, *cache])
    text, _ = run(program, ["inverse", arm, "--poses", file, *cache])
    found = found_by(rows, poses, json.loads(text))
    random = np.random.default_rng(2)
    batch = [forward(rows, random.uniform(-np.pi, np.pi, 6)) for _ in range(many)]
    poses_csv(batch, file)
    ways = [
        ("cognate", []),
        ("cognate, paths only", ["--paths-only"]),
        ("cognate, with proof", ["--certify"]),
        ("cognate, paths only, with proof", ["--paths-only", "--certify"]),
    ]
    for name, options in ways:
        text, _ = run(program, ["inverse", arm, "--poses", file, *cache, *options])
        answer = json.loads(text)
        here = answer["mechanism"]["family"]["here"]
        short = [t for t in answer["targets"] if t["configurations"]["complex"] != here]
        unsettled = sum(not t["settled"] for t in answer["targets"])
        each = 1000 * answer["time"]["cpu_seconds"] / many
        proved = sum(t["configurations"]["certified_real"] or 0 for t in answer["targets"])
        real = sum(t["configurations"]["real"] for t in answer["targets"])
        said = f", {proved} of {real} real ones proved" if "--certify" in options else f", {found}"
        routes = collections.Counter(t["route"] for t in answer["targets"])
        said += "; " + ", ".join(f"{number} by {route}" for route, number in sorted(routes.items()))
        lost = f"; {len(short)} of {many} poses with a number other than {here}, {unsettled} unsettled"
        result[name] = f"{each:.3g} ms{said}{lost}"
    poses_csv(poses[:1], file)
    alone = min(run(program, ["inverse", arm, "--poses", file, *cache])[1] for _ in range(5))
    result["cognate, one pose, program started"] = f"{1000 * alone:.3g} ms by the wall ({1000 * first:.3g} the first time)"
    serve = subprocess.Popen(
        [program, "mechanism", "serve", arm, "--cache", os.path.join(folder, "cache")],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )
    times = []
    for pose in poses:
        line = json.dumps({"position": list(pose[:3, 3]), "quaternion": list(quaternion(pose[:3, :3]))})
        start = time.monotonic()
        serve.stdin.write(line + "\n")
        serve.stdin.flush()
        serve.stdout.readline()
        times.append(1000 * (time.monotonic() - start))
    serve.stdin.close()
    serve.wait()
    result["cognate, one pose to `serve`"] = f"{np.median(times):.3g} ms by the wall"
    return result


def main():
    program, instances = sys.argv[1:3]
    number = int(sys.argv[3]) if len(sys.argv) > 3 else 40
    many = int(sys.argv[4]) if len(sys.argv) > 4 else 1000
    versions = {}
    for name, package, _, _ in PEERS:
        try:
            versions[name] = metadata.version(package)
        except metadata.PackageNotFoundError:
            versions[name] = None
    table = {}
    for arm, path in ARMS:
        rows, text = rows_of(program, os.path.join(instances, path))
        random = np.random.default_rng(1)
        poses = [forward(rows, random.uniform(-np.pi, np.pi, 6)) for _ in range(number)]
        with tempfile.TemporaryDirectory() as folder:
            for name, cell in cognate(program, folder, rows, text, poses, many).items():
                table.setdefault(name, {})[arm] = cell
        for name, _, prepare, kind in PEERS:
            cell = peer(prepare, rows, poses) if versions[name] else "not installed"
            table.setdefault(f"{name} {versions[name]} ({kind})", {})[arm] = cell
        print(f"{arm}: done", file=sys.stderr)
    print("| | " + " | ".join(arm for arm, _ in ARMS) + " |")
    print("|---" * (len(ARMS) + 1) + "|")
    for name, cells in table.items():
        print(f"| {name} | " + " | ".join(cells.get(arm, "") for arm, _ in ARMS) + " |")


if __name__ == "__main__":
    main()
