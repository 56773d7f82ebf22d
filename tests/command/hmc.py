"""Reads compact files as docs/compact.md describes them, and shares no line with the library: slowly, by brute force."""
import re
import zlib
from itertools import combinations, product
from math import isqrt
from pathlib import Path

LOGISTIC = [32768, 36843, 40793, 44511, 47911, 50941, 53581, 55834, 57724, 59287, 60565, 61598, 62428, 63090, 63615,
            64030, 64357, 64614, 64816, 64974, 65097, 65194, 65269, 65328, 65374, 65410, 65438, 65459, 65476, 65489,
            65500, 65508, 65514, 65519, 65523, 65526, 65528, 65530, 65531, 65532, 65533, 65534, 65534, 65535, 65535]
COTANGENTS = [1303, 650, 431, 322, 256, 211, 179, 155, 135, 120, 107, 96, 86, 78, 71, 64,
              58, 53, 47, 43, 38, 34, 30, 27, 23, 19, 16, 13, 9, 6, 3]


def toward0(a, b):
    return abs(a) // b * (1 if a >= 0 else -1)


def probability(s):
    if abs(s) >= 2816:
        return 1 if s < 0 else 65535
    k, r = divmod(abs(s), 64)
    p = (LOGISTIC[k] * (64 - r) + LOGISTIC[k + 1] * r) // 64
    return 65536 - p if s < 0 else p


def make_logarithms():
    table, s = [], -2816
    for k in range(4096):
        while s < 2816 and probability(s) < 16 * k + 8:
            s += 1
        table.append(s)
    return table


LOGARITHMS = make_logarithms()


# The tables of contexts that a start table counts through: what an index is made of, and the context of that.
TABLES = [((48, 4, 4, 4, 4), lambda kind, *rest: (kind, 1, *rest)),
          ((48, 8, 8, 4), lambda kind, before, after, deeper: (kind, 2, before, after, deeper + 1)),
          ((48, 4, 4, 4, 4), lambda kind, *rest: (kind, 3, *rest)),
          ((48, 2, 32), lambda kind, a, deeper: (kind, 4, a, deeper)),
          ((48, 2), lambda *rest: ("inner", *rest)),
          ((3, 16, 16), lambda phase, *rest: ("g", phase + 1, *rest)),
          ((3, 16, 16, 16), lambda phase, *rest: ("i", phase + 1, *rest)),
          ((3, 3, 32, 32), lambda phase, *rest: ("n", phase + 1, *rest)),
          ((4, 20, 36), lambda c, level, k: ("s", c, k, level)),
          ((4, 20, 36), lambda c, level, k: ("m", c, k, level)),
          ((4, 2, 10, 36), lambda c, more, digits, k: ("o", c, k, (digits, more == 1))),
          ((4, 20, 8, 36), lambda c, distance, count, k: ("p", c, k, (distance, count))),
          ((4, 3, 3, 3), lambda c, one, other, _: ("sign", c, one, other)),
          ((4, 36, 8), lambda *rest: ("digit", *rest))]


# The sets of weights that a start table counts through, and how many each has.
SETS = [((48, 2), 4, lambda kind, is_deep: ("sites", kind, is_deep == 1)),
        ((3, 16), 3, lambda phase, slack: ("flips", phase + 1, slack)),
        ((4, 36), 4, lambda c, k: ("colors", c, k))]


def read_table(table):
    """The contexts of a start table, and the sets of weights, and with what they begin."""
    header = f"photographs{'_1' if table == 1 else ''}.hpp"
    text = (Path(__file__).parent.parent.parent / "include" / "hmesh" / "io" / "compact" / header).read_text(encoding="ascii")
    symbols = [c for c in map(chr, range(35, 127)) if c not in "?\\"]
    places = [name(*index) for sizes, name in TABLES for index in product(*map(range, sizes))]
    texts = ["".join(re.findall('"(.*)"', part)) for part in re.findall('(?:^    ".*"\n)*^    ".*",?', text, re.M)]
    assert len(texts) == table
    contexts, at, passed, weights = {}, 0, 0, {}
    numbers = iter([symbols.index(c) for c in texts[0]])
    for number in numbers:
        passed = 45 * passed + number % 45
        if number < 45:
            at += passed
            contexts[places[at]] = (64 * probability(64 * (next(numbers) - 44)), 24)
            at, passed = at + 1, 0
    if table == 2:
        numbers = iter([1024 * (symbols.index(c) - 24) for c in texts[1]])
        for sizes, count, name in SETS:
            for index in product(*map(range, sizes)):
                weights[name(*index)] = [next(numbers) for _ in range(count)]
        assert next(numbers, None) is None
    return contexts, weights


class Code:
    """The arithmetic code, and contexts by name."""

    def __init__(self, data):
        self.data, self.at, self.low, self.high, self.code = data, 0, 0, 2**32 - 1, 0
        self.contexts, self.weights = {}, {}
        for _ in range(4):
            self.code = self.code * 256 + self.take()

    def take(self):
        self.at += 1
        assert self.at <= len(self.data) + 4
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def raw(self, p):
        size = self.high - self.low
        middle = self.low + size // 65536 * p + size % 65536 * p // 65536
        bit = self.code <= middle
        if bit:
            self.high = middle
        else:
            self.low = middle + 1
        while self.low >> 24 == self.high >> 24:
            self.low = self.low * 256 % 2**32
            self.high = self.high * 256 % 2**32 + 255
            self.code = self.code * 256 % 2**32 + self.take()
        return int(bit)

    def bits(self, count):
        value = 0
        for _ in range(count):
            value = 2 * value + self.raw(32768)
        return value

    def learn(self, name, bit):
        q, count = self.contexts.get(name, (2**21, 0))
        way = toward0(toward0((4194303 if bit else 0) - q, 8) * (16384 // (2 * count + 3)), 1024)
        self.contexts[name] = (q + way, min(count + 1, 160))

    def bit(self, *name):
        bit = self.raw(max(1, self.contexts.get(name, (2**21, 0))[0] // 64))
        self.learn(name, bit)
        return bit

    def mixed(self, names, weights, first):
        logs = [LOGARITHMS[self.contexts.get(name, (2**21, 0))[0] // 1024] for name in names]
        w = self.weights.setdefault(weights, [first] * len(names))
        s = max(-2816, min(2816, toward0(sum(a * b for a, b in zip(logs, w)), 65536)))
        p = probability(s)
        bit = self.raw(p)
        for i, log in enumerate(logs):
            w[i] = max(-524288, min(524288, w[i] + toward0(log * ((65536 if bit else 0) - p), 16384)))
            self.learn(names[i], bit)
        return bit


def read_sites(code, width, height, n):
    if n == 0:
        return []
    left, axes = [(width - 1).bit_length(), (height - 1).bit_length()], []
    sides = [tuple(left)]
    while sum(left):
        axes.append(1 if left[1] > left[0] else 0)
        left[axes[-1]] -= 1
        sides.append(tuple(left))

    def room(level, cell):  # of a cell, given as columns and rows of cells
        size = [max(0, min(1 << sides[level][k], (width, height)[k] - (cell[k] << sides[level][k]))) for k in (0, 1)]
        return size[0] * size[1]

    def halves(level, cell):
        a = axes[level]
        first = tuple(2 * c if k == a else c for k, c in enumerate(cell))
        return first, tuple(c + 1 if k == a else c for k, c in enumerate(first))

    def tell(level, cell, n, ask):
        one, two = halves(level, cell)
        least, most, node = max(0, n - room(level + 1, two)), min(n, room(level + 1, one)), 1
        while least < most:
            middle = (least + most) // 2
            kind = 0 if n == 1 else 3 * n - 6 + min(3, node) if n < 4 else 8 + 8 * min(4, n.bit_length() - 3) + min(7, node)
            bit = ask(kind)
            least, most = (middle + 1, most) if bit else (least, middle)
            node = min(8, 2 * node + bit)
        return least

    def way_order(level, cells):
        def way(cell):
            value, seen = [], [0, 0]
            total = [axes[:level].count(0), axes[:level].count(1)]
            for a in axes[:level]:
                seen[a] += 1
                value.append(cell[a] >> (total[a] - seen[a]) & 1)
            return value
        return sorted(cells, key=way)

    counts = {(0, 0): n}
    dense = min(len(axes), n.bit_length() + 2)
    for level in range(dense):
        a, new = axes[level], {}

        def neighbor(cell, along, across):
            return (cell[0] + along, cell[1] + across) if a == 0 else (cell[0] + across, cell[1] + along)

        for cell in way_order(level, counts):
            def whole(along, across):
                return counts.get(neighbor(cell, along, across), 0)

            def half(along, across, which):
                return new.get(halves(level, neighbor(cell, along, across))[which], 0)

            def q(x, most=3):
                return min(most, x)
            s1, s2, deeper = half(0, -1, 0), half(0, -1, 1), min(31, len(axes) - level)
            far = whole(-1, 1) + whole(1, 1) + whole(1, -1)
            names = [(1, q(half(-1, 0, 1)), q(whole(1, 0)), q(s1), q(s2)), (2, q(whole(-1, 0), 7), q(whole(1, 0), 7), q(deeper, 4)),
                     (3, q(s1 + s2), q(whole(0, 1)), q(half(-1, -1, 1)), q((far + 1) // 2)), (4, a, deeper)]
            first = tell(level, cell, counts[cell],
                         lambda kind: code.mixed([(kind, *name) for name in names], ("sites", kind, deeper < 4), 21845))
            for part, count in zip(halves(level, cell), (first, counts[cell] - first)):
                if count:
                    new[part] = count
        counts = new

    sites = []

    def split(level, cell, n):
        if level == len(axes):
            sites.append(cell)
            return
        ask = (lambda kind: code.bits(1)) if n == 1 else (lambda kind: code.bit("inner", kind, axes[level]))
        first = tell(level, cell, n, ask)
        for part, count in zip(halves(level, cell), (first, n - first)):
            if count:
                split(level + 1, part, count)

    for cell in way_order(dense, counts):
        split(dense, cell, counts[cell])
    return sites


def turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])


def is_inside(points, a, b, c, d):
    """Whether d counts as inside of the circle of the positive a, b, c."""
    rows = [(points[v][0] - points[d][0], points[v][1] - points[d][1]) for v in (a, b, c)]
    rows = [(x, y, x * x + y * y) for x, y in rows]
    (p, q, r), (s, t, u), (v, w, x) = rows
    value = p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v)
    if value:
        return value > 0
    least = min(a, b, c, d)
    if least == d:
        return True
    return turn(*(points[d if k == least else k] for k in (a, b, c))) < 0


def delaunay(points):
    faces = []
    for a, b, c in combinations(range(len(points)), 3):
        if turn(points[a], points[b], points[c]) == 0:
            continue
        if turn(points[a], points[b], points[c]) < 0:
            b, c = c, b
        if not any(is_inside(points, a, b, c, d) for d in range(len(points)) if d not in (a, b, c)):
            faces.append((a, b, c))
    return faces


def read_flips(code, points):
    apex = {}  # of the face to the left of each side
    rounds = {}
    for a, b, c in delaunay(points):
        apex.update({(a, b): c, (b, c): a, (c, a): b})

    def angle(p, q, r):
        p, q, r = points[p], points[q], points[r]
        t = 64 * ((q[0] - p[0]) * (r[0] - p[0]) + (q[1] - p[1]) * (r[1] - p[1]))
        k = sum(abs(t) < cotangent * turn(p, q, r) for cotangent in COTANGENTS)
        return k if t >= 0 else 63 - k

    asked, now = sorted({(min(e), max(e)) for e in apex}), 0
    while asked:
        now, after = now + 1, []
        for a, b in asked:
            c, d = apex.get((a, b)), apex.get((b, a))
            if c is None or d is None or now in (rounds.get((a, b)), rounds.get((b, a))):
                continue
            if turn(points[a], points[d], points[c]) <= 0 or turn(points[d], points[b], points[c]) <= 0:
                continue
            g, h, i, j = angle(c, a, b), angle(d, b, a), angle(a, d, c), angle(b, c, d)
            phase, slack = min(3, now), max(0, min(63, 79 - g - h))
            fresh = sum(rounds.get(e, 0) == now - 1 for e in [(a, b), (b, a)])
            near = sum(0 if rounds.get(e, 0) == 0 else 6 if rounds[e] == now else 1 for e in [(a, c), (c, b), (b, d), (d, a)])
            names = [("g", phase, min(g, h) // 4, max(g, h) // 4), ("i", phase, slack // 4, min(i, j) // 4, max(i, j) // 4),
                     ("n", phase, fresh, slack // 2, near)]
            if not code.mixed(names, ("flips", phase, slack // 4), 26000):
                continue
            del apex[(a, b)], apex[(b, a)]
            for x, y, z in [(a, d, c), (d, b, c)]:
                for side, third in [((x, y), z), ((y, z), x), ((z, x), y)]:
                    apex[side], rounds[side] = third, now
            for e in [(a, c), (c, b), (b, d), (d, a)]:
                e = (min(e), max(e))
                if e not in after:
                    after.append(e)
        asked = after
    return apex


def coarse_step(points, apex, v, mean, share, step):
    area = sum(turn(points[a], points[b], points[c]) for (a, b), c in apex.items() if a == v)
    ratio = max(16, min(mean // area, 4096))
    return max(1, step * isqrt(ratio) * share // 256)


class ByArea:
    """What colours are foretold as by area."""

    def __init__(self, points, apex, used, one, is_rgb, area):
        self.points, self.apex, self.used, self.is_rgb, self.unit = points, apex, used, is_rgb, area // 2**29 + 1
        self.like = max(1, one // 64)
        self.slopes = {pair: [0, max(1, (one // 13)**2)] for pair in [(1, 0), (2, 0), (2, 1)]}

    def shared(self, u, v):
        beside = [self.apex.get(edge) for edge in [(u, v), (v, u)]]
        areas = [abs(turn(self.points[u], self.points[v], self.points[c])) for c in beside if c is not None]
        return sum(areas) // self.unit + 1

    def look(self, v, edges, planes, missed, channels, last):
        self.near = []
        for u in (u for u in edges[v] if self.used[u]):
            known = [(u, 1)] if u < v else [(t, self.shared(t, u)) for t in edges[u] if t < v and self.used[t]]
            total = sum(w for _, w in known)
            if total:
                means = [[sum(w * of[t, c] for t, w in known) // total for c in range(channels)] for of in (planes, missed)]
                self.near.append((self.shared(u, v), *means))
        if not self.near and last is not None:
            self.near = [(1, *([of[last, c] for c in range(channels)] for of in (planes, missed)))]

    def mean(self, c):
        return (sum(w * numbers[c] for w, numbers, _ in self.by) + self.total // 2) // self.total

    def foretell(self, c, v, planes, first, top):
        """The guess, the sum of weights, and the sums of weight times what neighbours are off the guess, and were missed by."""
        self.by = self.near
        if self.is_rgb and c in (1, 2):
            self.by = [(max(1, 16 * w * self.like // (self.like + abs(numbers[0] - planes[v, 0]))), numbers, off)
                       for w, numbers, off in self.near]
        self.total = sum(w for w, _, _ in self.by)
        if not self.by:
            return first, 0, 0, 0
        guess = self.mean(c)
        for k in range(c if self.is_rgb and c < 3 else 0):
            a, b = self.slopes[c, k]
            guess += toward0(a * (planes[v, k] - self.mean(k)), b)
        guess = max(0, min(guess, top))
        return (guess, self.total, sum(w * abs(numbers[c] - guess) for w, numbers, _ in self.by),
                sum(w * off[c] for w, _, off in self.by))

    def learn(self, c, v, planes):
        e = planes[v, c] - self.mean(c) if self.by else 0
        for k in range(c if self.by and self.is_rgb and c < 3 else 0):
            slope, r = self.slopes[c, k], planes[v, k] - self.mean(k)
            told = toward0(slope[0] * r, slope[1])
            slope[0] += r * e - toward0(slope[0], 512)
            slope[1] += r * r - slope[1] // 512
            e -= told


def read_colors(code, points, apex, used, channels, most, is_float, color_step, mean, area):
    edges = {v: set() for v in range(len(points))}
    for a, b in apex:
        edges[a].add(b)
        edges[b].add(a)
    order = list(range(channels))
    if channels % 2 == 0:
        order = [channels - 1, *order[:-1]]
    is_rgb = channels > 2 and not is_float
    planes, missed, colors, last = {}, {}, {}, None
    by_area = ByArea(points, apex, used, 4080 if color_step else most, is_rgb, area) if area else None
    for v in (v for v in range(len(points)) if used[v]):
        near = []
        for u in edges[v]:
            if u < v and used[u]:
                x, y = (abs(points[u][k] - points[v][k]) for k in (0, 1))
                near.append((u, max(x, y) + 3 * min(x, y) // 8))
        nearest = min((d for _, d in near), default=2**26)
        unit = 64 if most >= 131072 else 4096
        near = [(u, max(1, unit * nearest // d)) for u, d in near]
        if not near and last is not None and not area:
            near = [(last, 1)]
        total = sum(w for _, w in near)
        if area:
            by_area.look(v, edges, planes, missed, channels, last)
        sizes, signs = [0, 0], [0, 0]
        for c in order:
            is_difference = is_rgb and c in (1, 2)
            top = 2 * most if is_difference else most
            first, step = (top + 1) // 2, 1
            if color_step:
                top, first = 16383, 8192 if is_difference else 2048
                step = coarse_step(points, apex, v, mean, (10, 12, 7, 17)[c if is_rgb else 3], color_step)
            if area:
                guess, total, spread, off = by_area.foretell(c, v, planes, first, top)
            else:
                guess = (sum(w * planes[u, c] for u, w in near) + total // 2) // total if near else first
                spread = sum(w * abs(planes[u, c] - guess) for u, w in near)
                off = sum(w * missed[u, c] for u, w in near)

            def level(x):
                if not total:
                    return 19
                x = x // (total * step // 4 + 1)
                return min(18, x if x < 2 else 2 * x.bit_length() - 2 + (x >> (x.bit_length() - 2) & 1))
            spread, off = level(spread), level(off)
            other = (min(9, sizes[0]), sizes[1] > sizes[0])
            place = (min(19, nearest.bit_length()), min(7, len(near)))
            size = 0
            while size < (max(guess, top - guess) // step).bit_length() and code.mixed(
                    [("s", c, size, spread), ("m", c, size, off), ("o", c, size, other), ("p", c, size, place)],
                    ("colors", c, size), 21845):
                size += 1
            value, sign = 0, 0
            if size:
                sign = 2 if code.bit("sign", c, *signs) else 1
                value, node = 1, 1
                for _ in range(size - 1):
                    bit = code.bit("digit", c, size, node) if node < 4 else code.bits(1)
                    value, node = 2 * value + bit, 2 * node + bit
            planes[v, c] = guess + step * (value if sign == 1 else -value)
            assert 0 <= planes[v, c] <= top
            missed[v, c] = step * value
            if area:
                by_area.learn(c, v, planes)
            sizes, signs = [size, sizes[0]], [sign, signs[0]]
        color = [planes[v, c] for c in range(channels)]
        if color_step:
            if is_rgb:
                y, o, n = color[0], color[1] - 8192, color[2] - 8192
                color[:3] = [y + o - n, y + 2 * n, y - o - n]
            color = [min(255, (max(0, x) + 8) // 16) for x in color]
        elif is_rgb:
            o, n = color[1] - most, color[2] - most
            m = color[0] - n // 2
            color[:3] = [m - o // 2 + o, n + m, m - o // 2]
        assert all(0 <= x <= most for x in color)
        colors[v], last = color, v
    return colors


def read_compact(data, is_bare=False, size=None):
    """Width, height and channels; `size` where a bare file does not tell it; positions in 1/256 px with colours as numbers; faces."""
    at = 0

    def byte():
        nonlocal at
        at += 1
        return data[at - 1]

    def varint():
        value, shift = 0, 0
        while True:
            b = byte()
            value |= (b & 127) << shift
            shift += 7
            if b < 128:
                return value

    if is_bare:
        first = byte()
        table, told = divmod((first >> 4) - 1, 2)
        assert told == (1 if size else 0)
        width, height = size or (varint(), varint())
        step, color_step = 256 * varint(), varint()
        channels, kind, has_mask, points_kind = (first & 3) + 1, 0, False, False
        frame = None
    else:
        table = data[5]
        assert data[:5] == b"\x9dHMC\1" and int.from_bytes(data[6:10], "little") == len(data)
        assert int.from_bytes(data[10:14], "little") == zlib.crc32(data[:10] + data[14:])
        at = 14
        first, second = byte(), byte()
        width, height, step, color_step = varint(), varint(), varint(), varint()
        channels, kind, has_mask, points_kind = (first & 3) + 1, first >> 2 & 3, second & 4, first & 32
        if first & 128:
            at += 8
        frame = None
        if second & 8:
            left, top = ((v >> 1) ^ -(v & 1) for v in (varint(), varint()))
            frame = left, top, varint(), varint()
    less = 1 if points_kind else 0
    left, top, w, h = frame or (0, 0, 256 * (width - less), 256 * (height - less))
    columns, rows = -(-w // step), -(-h // step)
    code = Code(data[at:])
    assert table in (0, 1, 2)
    code.contexts, code.weights = read_table(table) if table else ({}, {})

    inside = code.bits(5)
    inside = (1 << (inside - 1) | code.bits(inside - 1)) if inside else 0
    numbers = []
    for _ in range(4):
        d = 0
        while d < 31 and code.bit("count", d):
            d += 1
        numbers.append(1 << (d - 1) | code.bits(d - 1) if d else 0)
    sides = [read_sites(code, (columns, rows)[k % 2] - 1, 1, n) for k, n in enumerate(numbers)]
    sites = [(0, 0), (columns, 0), (columns, rows), (0, rows)]
    sites += [(x + 1, 0) for x, _ in sides[0]] + [(columns, x + 1) for x, _ in sides[1]]
    sites += [(x + 1, rows) for x, _ in sides[2]] + [(0, x + 1) for x, _ in sides[3]]
    sites += [(x + 1, y + 1) for x, y in read_sites(code, columns - 1, rows - 1, inside)]
    points = [(min(x * step, w), min(y * step, h)) for x, y in sites]
    apex = read_flips(code, points)
    faces = sorted((a, b, c) for (a, b), c in apex.items() if a < b and a < c)
    shown = {}
    if has_mask:
        for a, b, c in faces:
            beside = [shown.get(side) for side in [(b, a), (c, b), (a, c)]]
            bit = code.bit("mask", beside.count(0), beside.count(1))
            shown.update({(a, b): bit, (b, c): bit, (c, a): bit})
        faces = [face for face in faces if shown[face[:2]]]
    used = [not has_mask or any(v in face for face in faces) for v in range(len(points))]
    largest = (255, 65535, 2**32 - 1)[kind]
    area = 2 * w * h if table == 2 else 0
    colors = read_colors(code, points, apex, used, channels, largest, kind == 2, color_step, 1536 * w * h // len(points), area)
    number = {v: i for i, v in enumerate(sorted(colors))}
    return ((width, height, channels),
            [(points[v][0] + left, points[v][1] + top, *colors[v]) for v in sorted(colors)],
            [tuple(number[v] for v in face) for face in faces])
