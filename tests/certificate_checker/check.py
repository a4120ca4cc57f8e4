#!/usr/bin/env python3
"""Checks certificates.json against the problem's file. It uses no code of the solver.

For every certificate it proves again, in exact rational interval arithmetic, that the box holds
exactly one solution (Krawczyk's test). It also proves that certified solutions differ, that the
claims real and not real are true, and that the counts agree with the certificates.

Usage: check.py PROBLEM certificates.json      PROBLEM: Bertini-classic input, or our JSON
Exit code: 0 all claims hold; 1 a claim fails, and its name is printed; 2 bad input.
"""

import json
import re
import sys
from fractions import Fraction

sys.setrecursionlimit(20000)


class Refused(Exception):
    """A claim that does not hold."""


class BadInput(Exception):
    """A file that cannot be read."""


# ---- numbers ---------------------------------------------------------------------------------
# A real interval is a pair (lower, upper) of Fractions, a complex one a pair of real intervals.

ZERO = (Fraction(0), Fraction(0))


def point(x):
    return (x, x)


def add(a, b):
    return (a[0] + b[0], a[1] + b[1])


def sub(a, b):
    return (a[0] - b[1], a[1] - b[0])


def mul(a, b):
    if a[0] == a[1]:
        ends = (a[0] * b[0], a[0] * b[1])
    elif b[0] == b[1]:
        ends = (a[0] * b[0], a[1] * b[0])
    else:
        ends = (a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1])
    return (min(ends), max(ends))


def magnitude(a):
    return max(abs(a[0]), abs(a[1]))


class Box:
    """A complex interval re + i im."""

    __slots__ = ("re", "im")

    def __init__(self, re, im=ZERO):
        self.re, self.im = re, im

    def __add__(self, o):
        return Box(add(self.re, o.re), add(self.im, o.im))

    def __sub__(self, o):
        return Box(sub(self.re, o.re), sub(self.im, o.im))

    def __mul__(self, o):
        re = sub(mul(self.re, o.re), mul(self.im, o.im))
        im = add(mul(self.re, o.im), mul(self.im, o.re))
        return Box(re, im)

    def conjugate(self):
        return Box(self.re, (-self.im[1], -self.im[0]))

    def inverse(self):
        def square(a):
            ends = (a[0] * a[0], a[1] * a[1])
            low = Fraction(0) if a[0] <= 0 <= a[1] else min(ends)
            return (low, max(ends))

        size = add(square(self.re), square(self.im))
        if size[0] <= 0:
            raise Refused("a division by a box that may hold 0")
        size = (1 / size[1], 1 / size[0])
        return Box(mul(self.re, size), mul((-self.im[1], -self.im[0]), size))

    def middle(self):
        return ((self.re[0] + self.re[1]) / 2, (self.im[0] + self.im[1]) / 2)

    def disjoint(self, o):
        def apart(a, b):
            return a[1] < b[0] or b[1] < a[0]

        return apart(self.re, o.re) or apart(self.im, o.im)


def exact_point(z):
    return Box(point(z[0]), point(z[1]))


EXACT = re.compile(r"(-?)0x([0-9a-f]+)p(-?[0-9]+)\Z")


def exact(text):
    """The exact value of a number such as -0x1fp-3."""
    found = EXACT.match(text) if isinstance(text, str) else None
    if not found or abs(int(found[3])) > 100000:
        raise BadInput(f"{text!r} is no exact number")
    value = Fraction(int(found[2], 16)) * Fraction(2) ** int(found[3])
    return -value if found[1] else value


# ---- expressions -----------------------------------------------------------------------------
# Trees of tuples: ("number", (re, im)), ("name", n), ("+", a, b), ("-", a, b), ("*", a, b),
# ("/", a, b), ("neg", a), ("^", a, exponent).

TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*(?:\[\d+\])?)|(\*\*|[-+*/^()]))")


def parse(text):
    tokens, at = [], 0
    text = text.strip()
    while at < len(text):
        found = TOKEN.match(text, at)
        if not found:
            raise BadInput(f"cannot read {text[at:at + 30]!r}")
        tokens.append(found.groups())
        at = found.end()
    tokens.append((None, None, None))
    place = 0

    def peek():
        return tokens[place][2]

    def take():
        nonlocal place
        place += 1
        return tokens[place - 1]

    def total():
        if peek() in ("-", "+"):
            value = ("neg", product()) if take()[2] == "-" else product()
        else:
            value = product()
        while peek() in ("+", "-"):
            value = (take()[2], value, product())
        return value

    def product():
        value = power()
        while peek() in ("*", "/"):
            value = (take()[2], value, signed())
        return value

    def signed():
        if peek() == "-":
            take()
            return ("neg", signed())
        return power()

    def power():
        base = atom()
        if peek() in ("^", "**"):
            take()
            exponent = signed()
            number = constant(exponent)
            if number[1] != 0 or number[0].denominator != 1 or number[0] < 0:
                raise BadInput("only powers with natural exponents can be checked")
            return ("^", base, int(number[0]))
        return base

    def atom():
        number, name, sign = take()
        if number is not None:
            return ("number", (Fraction(number), Fraction(0)))
        if name is not None:
            if peek() == "(":
                raise BadInput(f"the function {name} cannot be checked: it is not rational")
            if name in ("I", "i"):
                return ("number", (Fraction(0), Fraction(1)))
            return ("name", name)
        if sign == "(":
            value = total()
            if take()[2] != ")":
                raise BadInput("a parenthesis is not closed")
            return value
        raise BadInput(f"unexpected {sign!r} in {text!r}")

    value = total()
    if tokens[place] != (None, None, None):
        raise BadInput(f"something is left over in {text!r}")
    return value


def constant(tree):
    """The exact value of a tree without names."""
    number = evaluate(tree, {}, {})
    return (number.value.re[0], number.value.im[0])


class Dual:
    """A box, and its derivatives by its variables."""

    __slots__ = ("value", "slopes")

    def __init__(self, value, slopes):
        self.value, self.slopes = value, slopes

    def combine(self, o, value, by_self, by_other):
        slopes = {v: s * by_self for v, s in self.slopes.items()}
        for v, s in o.slopes.items():
            term = s * by_other
            slopes[v] = slopes[v] + term if v in slopes else term
        return Dual(value, slopes)

    def __add__(self, o):
        return self.combine(o, self.value + o.value, ONE, ONE)

    def __sub__(self, o):
        return self.combine(o, self.value - o.value, ONE, MINUS)

    def __mul__(self, o):
        return self.combine(o, self.value * o.value, o.value, self.value)


ONE = Box(point(Fraction(1)))
MINUS = Box(point(Fraction(-1)))


def evaluate(tree, names, seen):
    """Evaluates a tree over boxes. `names` maps each name to a Dual or a tree."""
    kind = tree[0]
    if kind == "number":
        return Dual(exact_point(tree[1]), {})
    if kind == "name":
        name = tree[1]
        if name in seen:
            return seen[name]
        if name not in names:
            raise BadInput(f"{name!r} has no meaning")
        meaning = names[name]
        if not isinstance(meaning, Dual):
            meaning = evaluate(meaning, names, seen)
        seen[name] = meaning
        return meaning
    a = evaluate(tree[1], names, seen)
    if kind == "neg":
        return a * Dual(MINUS, {})
    if kind == "^":
        result = Dual(ONE, {})
        for _ in range(tree[2]):
            result = result * a
        return result
    b = evaluate(tree[2], names, seen)
    if kind == "/":
        if b.slopes:
            raise BadInput("a variable stands in a denominator")
        return a * Dual(b.value.inverse(), {})
    return {"+": a.__add__, "-": a.__sub__, "*": a.__mul__}[kind](b)


# ---- problems --------------------------------------------------------------------------------


class Problem:
    """Variables, homogeneous groups, parameters, definitions and equations of a file."""

    def __init__(self):
        self.variables, self.homogeneous, self.parameters = [], [], []
        self.definitions, self.equations = {}, []


def read_bertini(text):
    text = re.sub(r"%[^\n]*", "", text)
    problem = Problem()
    section = re.search(r"\bINPUT\b(.*)\bEND\s*;", text, re.S)
    if section is None:
        section = re.search(r"\A(?:\s*CONFIG.*?END\s*;)?(.*?)(?:\bEND\s*;\s*)?\Z", text, re.S)
    functions = []
    for statement in section[1].split(";"):
        statement = statement.strip()
        if not statement:
            continue
        if "=" in statement:
            name, expression = statement.split("=", 1)
            problem.definitions[name.strip()] = parse(expression)
            continue
        word, _, rest = statement.partition(" ")
        names = [name.strip() for name in rest.split(",")]
        if word in ("variable", "variable_group", "hom_variable_group"):
            problem.variables += names
            if word == "hom_variable_group":
                problem.homogeneous.append(names)
        elif word == "parameter":
            problem.parameters += names
        elif word == "function":
            functions += names
        elif word != "constant":
            raise BadInput(f"cannot read the statement {statement[:40]!r}")
    problem.equations = [("name", name) for name in functions]
    return problem


def read_json(text):
    content = json.loads(text, parse_float=str, parse_int=str)
    problem = Problem()
    problem.variables = content["variables"]
    if content.get("homogeneous"):
        problem.homogeneous = content.get("groups") or [content["variables"]]
    problem.parameters = content.get("parameters", [])
    problem.definitions = {name: parse(e) for name, e in content.get("definitions", {}).items()}
    problem.equations = [parse(e) for e in content["equations"]]
    return problem


def read_problem(path):
    with open(path, encoding="utf-8") as file:
        text = file.read()
    return read_json(text) if text.lstrip().startswith("{") else read_bertini(text)


# ---- Krawczyk's test -------------------------------------------------------------------------


def rounded(x, bits):
    """A dyadic number near x with about `bits` bits."""
    if x == 0:
        return x
    shift = bits - (abs(x.numerator).bit_length() - x.denominator.bit_length())
    scale = Fraction(2) ** shift
    return Fraction(round(x * scale)) / scale


def approximate_inverse(matrix, bits):
    """Gauss-Jordan inverse in rounded rationals. The proof holds for any matrix; a good inverse proves more."""
    n = len(matrix)

    def near(z):
        return (rounded(z[0], bits), rounded(z[1], bits))

    def times(a, b):
        return (a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0])

    rows = [
        [near(z) for z in row] + [(Fraction(int(i == j)), Fraction(0)) for j in range(n)]
        for i, row in enumerate(matrix)
    ]
    for k in range(n):
        size = [rows[i][k][0] ** 2 + rows[i][k][1] ** 2 for i in range(k, n)]
        pivot = k + size.index(max(size))
        if max(size) == 0:
            raise Refused("the Jacobian at the centre is singular")
        rows[k], rows[pivot] = rows[pivot], rows[k]
        z, s = rows[k][k], max(size)
        scale = (z[0] / s, -z[1] / s)
        rows[k] = [near(times(scale, entry)) for entry in rows[k]]
        for i in range(n):
            factor = rows[i][k]
            if i != k and factor != (0, 0):
                for j in range(k, 2 * n):
                    t = times(factor, rows[k][j])
                    rows[i][j] = near((rows[i][j][0] - t[0], rows[i][j][1] - t[1]))
    return [row[n:] for row in rows]


class Certificate:
    """A claim, and its proof."""

    def __init__(self, claim, system):
        self.number = claim.get("solution")
        given = {c["variable"]: c for c in claim["coordinates"]}
        if set(given) != set(system.variables) or len(claim["coordinates"]) != len(given):
            raise Refused("it does not name every variable once")
        self.centre, self.radius, self.error = {}, {}, {}
        for name, c in given.items():
            self.centre[name] = (exact(c["re"]), exact(c["im"]))
            self.radius[name], self.error[name] = exact(c["radius"]), exact(c["error"])
        self.fixed = []
        for group in system.homogeneous:
            ones = [v for v in group if self.radius[v] == 0 and self.centre[v] == (1, 0)]
            if len(ones) != 1:
                raise Refused("a homogeneous group has not exactly one variable fixed at 1")
            self.fixed += ones
        self.free = [v for v in system.variables if v not in self.fixed]
        if any(self.radius[v] <= 0 for v in self.free):
            raise Refused("a radius is not positive")
        if len(system.equations) != len(self.free):
            raise Refused(f"{len(system.equations)} equations for {len(self.free)} unknowns")
        self.bits = max(64, int(claim.get("precision_bits") or 0) + 32)
        self.proved = self.prove(system)

    def box(self, name, radius):
        (re, im), r = self.centre[name], radius[name]
        return Box((re - r, re + r), (im - r, im + r))

    def prove(self, system):
        """The smaller box around the solution, or a refusal."""
        nothing = {v: Fraction(0) for v in self.centre}
        _, jacobian = system.at(self.centre, self.free, lambda v: self.box(v, nothing))
        inverse = approximate_inverse([[z.middle() for z in row] for row in jacobian], self.bits)
        inverse = [[exact_point(z) for z in row] for row in inverse]
        values, _ = system.at(self.centre, [], lambda v: self.box(v, nothing))
        _, slopes = system.at(self.centre, self.free, lambda v: self.box(v, self.radius))
        n = len(self.free)
        proved = {v: Fraction(0) for v in self.fixed}
        for i, v in enumerate(self.free):
            step = Box(ZERO)
            for j in range(n):
                step = step + inverse[i][j] * values[j]
            reach = max(magnitude(step.re), magnitude(step.im))
            for j, w in enumerate(self.free):
                entry = ONE if i == j else Box(ZERO)
                for k in range(n):
                    entry = entry - inverse[i][k] * slopes[k][j]
                reach += (magnitude(entry.re) + magnitude(entry.im)) * self.radius[w]
            if reach >= self.radius[v]:
                raise Refused(f"the box is not mapped into its interior (variable {v})")
            if reach > self.error[v]:
                raise Refused(f"the solution may be farther from the centre than it says ({v})")
            proved[v] = reach
        return proved

    def solution(self):
        return {v: self.box(v, self.proved) for v in self.centre}

    def in_chart(self, system, values):
        """Homogeneous groups, divided by the value of the variable that is 1 in this certificate."""
        values = dict(values)
        for group in system.homogeneous:
            fixed = next(v for v in group if v in self.fixed)
            divisor = values[fixed]
            if divisor.re == point(Fraction(1)) and divisor.im == ZERO:
                continue
            inverse = divisor.inverse()
            for v in group:
                values[v] = values[v] * inverse
        return values

    def holds(self, values):
        """True if all values lie in the interior of the box."""

        def inside(part, centre, r):
            return centre - r < part[0] and part[1] < centre + r

        return all(
            inside(values[v].re, self.centre[v][0], self.radius[v])
            and inside(values[v].im, self.centre[v][1], self.radius[v])
            for v in self.free
        )


class System:
    """The square system of the certificates."""

    def __init__(self, problem, claim):
        self.problem = problem
        self.variables, self.homogeneous = problem.variables, problem.homogeneous
        if claim["variables"] != self.variables:
            raise Refused("the certificates are of other variables")
        if sorted(map(sorted, claim["homogeneous"])) != sorted(map(sorted, self.homogeneous)):
            raise Refused("the certificates are of other homogeneous groups")
        self.parameters = {name: (exact(v[0]), exact(v[1])) for name, v in claim["parameters"]}
        if set(self.parameters) != set(problem.parameters):
            raise Refused("the certificates are of other parameters")
        self.definitions, self.equations = problem.definitions, problem.equations
        if claim["squared_up"]:
            # The file contains the certified system. It does not prove that the system comes from the equations.
            square = read_json(claim["combinations"])
            if square.variables != self.variables:
                raise Refused("the combinations are in other variables")
            self.definitions, self.equations = square.definitions, square.equations
        self.partner = {v: v for v in self.variables}
        for a, b in claim["conjugates"]:
            if self.partner.get(a) != a or self.partner.get(b) != b:
                raise Refused(f"{a} and {b} are not each other's only partner")
            self.partner[a], self.partner[b] = b, a

    def at(self, centre, by, box):
        """Values over a box, and derivatives by the variables `by`."""
        names = dict(self.definitions)
        for name, value in self.parameters.items():
            names[name] = Dual(exact_point(value), {})
        for v in centre:
            names[v] = Dual(box(v), {v: ONE} if v in by else {})
        seen = {}
        found = [evaluate(e, names, seen) for e in self.equations]
        return (
            [f.value for f in found],
            [[f.slopes.get(v, Box(ZERO)) for v in by] for f in found],
        )

    # -- invariance under conjugation and exchange of the pairs, by exact polynomials

    def polynomial(self, tree, seen):
        """A map from monomials to coefficients; a monomial is a sorted tuple of variables."""
        kind = tree[0]
        if kind == "number":
            return {(): tree[1]} if tree[1] != (0, 0) else {}
        if kind == "name":
            name = tree[1]
            if name not in seen:
                if name in self.partner:
                    seen[name] = {(name,): (Fraction(1), Fraction(0))}
                elif name in self.parameters:
                    seen[name] = {(): self.parameters[name]}
                else:
                    seen[name] = self.polynomial(self.definitions[name], seen)
            return seen[name]
        a = self.polynomial(tree[1], seen)
        if kind == "neg":
            return {m: (-c[0], -c[1]) for m, c in a.items()}
        if kind == "^":
            result = {(): (Fraction(1), Fraction(0))}
            for _ in range(tree[2]):
                result = multiplied(result, a)
            return result
        b = self.polynomial(tree[2], seen)
        if kind == "*":
            return multiplied(a, b)
        if kind == "/":
            if set(b) != {()}:
                raise BadInput("a variable stands in a denominator")
            c = b[()]
            size = c[0] ** 2 + c[1] ** 2
            return multiplied(a, {(): (c[0] / size, -c[1] / size)})
        sign = 1 if kind == "+" else -1
        result = dict(a)
        for m, c in b.items():
            old = result.get(m, (0, 0))
            new = (old[0] + sign * c[0], old[1] + sign * c[1])
            if new == (0, 0):
                result.pop(m, None)
            else:
                result[m] = new
        return result

    def is_invariant(self):
        """True if every image is a combination of the equations, or of their multiples by variables."""
        seen = {}
        given = [self.polynomial(e, seen) for e in self.equations]
        images = [
            {tuple(sorted(self.partner[v] for v in m)): (c[0], -c[1]) for m, c in f.items()}
            for f in given
        ]
        one = (Fraction(1), Fraction(0))
        multiples = [multiplied({(v,): one}, f) for v in self.variables for f in given]
        for rows in (given, given + multiples):
            if all(not reduced(image, echelon(rows)) for image in images):
                return True
        return False


def multiplied(a, b):
    result = {}
    for m, c in a.items():
        for n, d in b.items():
            key = tuple(sorted(m + n))
            old = result.get(key, (Fraction(0), Fraction(0)))
            result[key] = (old[0] + c[0] * d[0] - c[1] * d[1], old[1] + c[0] * d[1] + c[1] * d[0])
    return {m: c for m, c in result.items() if c != (0, 0)}


def reduced(row, basis):
    row = dict(row)
    for pivot, other in basis:
        if pivot in row:
            c = row[pivot]
            for m, d in other.items():
                old = row.get(m, (Fraction(0), Fraction(0)))
                new = (old[0] - c[0] * d[0] + c[1] * d[1], old[1] - c[0] * d[1] - c[1] * d[0])
                if new == (0, 0):
                    row.pop(m, None)
                else:
                    row[m] = new
    return row


def echelon(rows):
    basis = []
    for row in rows:
        rest = reduced(row, basis)
        if rest:
            pivot = next(iter(rest))
            c = rest[pivot]
            size = c[0] ** 2 + c[1] ** 2
            basis.append((pivot, multiplied(rest, {(): (c[0] / size, -c[1] / size)})))
    return basis


# ---- the file --------------------------------------------------------------------------------


def check_target(problem, target):
    system = System(problem, target["system"])
    certificates = []
    for claim in target["certificates"]:
        try:
            certificates.append((claim, Certificate(claim, system)))
        except Refused as why:
            raise Refused(f"solution {claim.get('solution')}: {why}") from None
    counted = [(claim, c) for claim, c in certificates if claim["distinct"]]
    solutions = [c.solution() for _, c in certificates]
    for i, (claim, c) in enumerate(certificates):
        for j in range(i):
            if not (claim["distinct"] or certificates[j][0]["distinct"]):
                continue
            other = c.in_chart(system, solutions[j])
            if not any(solutions[i][v].disjoint(other[v]) for v in system.variables):
                numbers = (certificates[j][1].number, c.number)
                raise Refused("solutions {} and {} may be one and the same".format(*numbers))
    asked = [claim for claim, _ in certificates if claim["real"] is not None]
    if asked and not system.is_invariant():
        raise Refused("the equations are not invariant under the involution, so none is real")
    for (claim, c), values in zip(certificates, solutions):
        if claim["real"] is None:
            continue
        image = {v: values[system.partner[v]].conjugate() for v in system.variables}
        image = c.in_chart(system, image)
        if claim["real"] and not c.holds(image):
            raise Refused(f"solution {c.number} is not proved to be real")
        if not claim["real"] and not any(image[v].disjoint(values[v]) for v in system.variables):
            raise Refused(f"solution {c.number} is not proved to be other than its conjugate")
    found = {
        "certified": len(counted),
        "real": sum(claim["real"] is True for claim, _ in counted),
    }
    claimed = target["claims"]
    if claimed["certified"] != found["certified"] or claimed["real"] not in (None, found["real"]):
        raise Refused(f"it claims {claimed} and holds {found}")
    return found, target["system"]["squared_up"]


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        problem = read_problem(arguments[0])
        with open(arguments[1], encoding="utf-8") as file:
            content = json.load(file)
        if content.get("format") != "cognate certificates 1":
            raise BadInput("it is no file of certificates of version 1")
        for number, target in enumerate(content["targets"]):
            found, squared_up = check_target(problem, target)
            where = f"target {number}: " if len(content["targets"]) > 1 else ""
            what = ", of the squared-up system" if squared_up else ""
            print(
                f"{where}{found['certified']} solutions proved, all distinct, "
                f"{found['real']} of them real{what}"
            )
    except Refused as why:
        print(f"refused: {why}", file=sys.stderr)
        return 1
    except (BadInput, OSError, ValueError, KeyError, TypeError, AttributeError) as why:
        print(f"bad input: {type(why).__name__}: {why}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
