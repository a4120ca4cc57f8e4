#!/usr/bin/env python3
"""Holds the finite solutions of a solve against those of a stored family, one by one.

    compare.py FAMILY/solutions.points VARIABLES SOLVE/solutions.jsonl

VARIABLES: names of the stored variables, in their order, with commas between. Solutions may have
further variables. Each stored solution must be found once, and nothing else; singular ones do not
count. Exit code 0 where that is so.
"""
import bisect
import json
import struct
import sys

NEAR = 1e-8  # largest difference of a coordinate, relative to the largest of the point or 1


def stored(path):
    data = open(path, "rb").read()
    assert data[:8] == b"CGNPTS01", "no file of stored points"
    (dimension,) = struct.unpack_from("<Q", data, 8)
    numbers = struct.unpack_from(f"<{(len(data) - 16) // 8}d", data, 16)
    values = [complex(*numbers[k : k + 2]) for k in range(0, len(numbers), 2)]
    return [values[k : k + dimension] for k in range(0, len(values), dimension)]


def found(path, names):
    for line in open(path):
        solution = json.loads(line)
        if not solution["singular"]:
            values = solution["variables"]
            yield [complex(float(values[n][0]), float(values[n][1])) for n in names]


def main(points, names, solutions):
    family = sorted(stored(points), key=lambda p: p[0].real)
    keys = [p[0].real for p in family]
    hits = [0] * len(family)
    strangers = count = 0
    for point in found(solutions, names.split(",")):
        count += 1
        size = NEAR * max(1.0, *map(abs, point))
        low = bisect.bisect_left(keys, point[0].real - size)
        high = bisect.bisect_right(keys, point[0].real + size)
        near = [
            k
            for k in range(low, high)
            if all(abs(a - b) <= size for a, b in zip(family[k], point))
        ]
        strangers += len(near) != 1
        for k in near:
            hits[k] += 1
    missing = sum(h == 0 for h in hits)
    twice = sum(h > 1 for h in hits)
    print(
        f"{len(family)} stored, {count} found: {missing} missing, {twice} found twice, "
        f"{strangers} that are none of them"
    )
    return missing or twice or strangers


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(1 if main(*sys.argv[1:]) else 0)
