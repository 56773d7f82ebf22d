"""Models of heights as files of every kind that hmesh-terrain reads, made here, and what it writes read back by the specifications
alone. Heights are lists of rows from the north; None is a sample without data."""
import json
import math
import struct
import zlib
from pathlib import Path


def ground(width, height, first_column=0, first_row=0):
    """Hills, a cliff and some noise: whole numbers from about -60 to 500. Tiles of it are cut by their first column and row."""
    def at(x, y):
        hill = 180 * math.sin(x / 9) * math.cos(y / 7) + 90 * math.sin(x / 3.3 + y / 5.1)
        cliff = 120 if x + 2 * y > 70 else 0
        return round(200 + 0.6 * hill + cliff + (x * 7919 + y * 104729) % 11)

    return [[at(x, y) for x in range(first_column, first_column + width)] for y in range(first_row, first_row + height)]


def with_holes(heights):
    """A lake, a bay of the border and a single sample without data."""
    def is_none(x, y):
        return math.hypot(x - 20, y - 15) < 6 or (x < 5 and 20 < y < 27) or (x, y) == (33, 8)

    return [[None if is_none(x, y) else z for x, z in enumerate(row)] for y, row in enumerate(heights)]


def flat(heights, none):
    return [none if z is None else z for row in heights for z in row]


# ---- files ----
def asc(heights, corner=(0, 0), cell=1, none=-9999, center=False):
    where = "center" if center else "corner"
    head = f"ncols {len(heights[0])}\nnrows {len(heights)}\nxll{where} {corner[0]}\nyll{where} {corner[1]}\ncellsize {cell}\n"
    rows = "\n".join(" ".join(str(none if z is None else z) for z in row) for row in heights)
    return (head + f"NODATA_value {none}\n" + rows + "\n").encode()


def pgm(heights, maximum=65535, none=0):
    body = struct.pack(f">{len(heights) * len(heights[0])}{'H' if maximum > 255 else 'B'}", *flat(heights, none))
    return b"P5\n# heights\n%d %d\n%d\n" % (len(heights[0]), len(heights), maximum) + body


def raw(heights, kind="f", none=math.nan):
    return struct.pack(f"<{len(heights) * len(heights[0])}{kind}", *flat(heights, none))


def hgt(heights):
    return struct.pack(f">{len(heights) * len(heights[0])}h", *flat(heights, -32768))


def png(heights, none=0):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = b"".join(b"\0" + struct.pack(f">{len(row)}H", *(none if z is None else z for z in row)) for row in heights)
    head = struct.pack(">IIBBBBB", len(heights[0]), len(heights), 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def geotiff(heights, place=(0, 0), step=(1, 1), is_point=False, geographic=False, epsg=None, kind="f", none=None, bands=1):
    """`place`: x and y of the corner of the first sample's area, or of its point."""
    form, bits, sample = {"f": ("f", 32, 3), "d": ("d", 64, 3), "h": ("h", 16, 2), "H": ("H", 16, 1)}[kind]
    width, height = len(heights[0]), len(heights)
    pixels = struct.pack(f"<{width * height * bands}{form}", *[z for z in flat(heights, none) for _ in range(bands)])
    keys = [1024, 0, 1, 2 if geographic else 1, 1025, 0, 1, 2 if is_point else 1, 2048 if geographic else 3072, 0, 1,
            epsg or (4326 if geographic else 32632)]
    tags = {256: ("I", [width]), 257: ("I", [height]), 258: ("H", [bits] * bands), 259: ("H", [1]), 262: ("H", [1]),
            273: ("I", [0]), 277: ("H", [bands]), 278: ("I", [height]), 279: ("I", [len(pixels)]), 339: ("H", [sample] * bands),
            33550: ("d", [*step, 0]), 33922: ("d", [0, 0, 0, *place, 0]), 34735: ("H", [1, 1, 0, len(keys) // 4, *keys])}
    if none is not None:
        tags[42113] = ("s", str(none).encode() + b"\0")
    codes = {"H": 3, "I": 4, "d": 12, "s": 2}
    at = 8 + 2 + 12 * len(tags) + 4
    after, table = b"", b""
    tags[273] = ("I", [0])
    sizes = sum(len(v) * {"H": 2, "I": 4, "d": 8, "s": 1}[k] for k, v in tags.values())
    start = at + sizes + 2 * len(tags)
    tags[273] = ("I", [start])
    for number, (code, values) in sorted(tags.items()):
        packed = values if code == "s" else struct.pack(f"<{len(values)}{code}", *values)
        count = len(values)
        if len(packed) > 4:
            packed, after = struct.pack("<I", at + len(after)), after + packed + b"\0" * (len(packed) % 2)
        table += struct.pack("<HHI", number, codes[code], count) + packed.ljust(4, b"\0")
    head = struct.pack("<2sHI", b"II", 42, 8) + struct.pack("<H", len(tags)) + table + bytes(4) + after
    return head.ljust(start, b"\0") + pixels


# ---- what is written: vertices (x to the east, y to the north, z up), normals alike, faces counter-clockwise from above ----
# `textures`: places in an image, to the right and down from its upper left corner.
class Model:
    def __init__(self, vertices, faces, normals=(), textures=()):
        self.vertices, self.faces, self.normals, self.textures = vertices, faces, list(normals), list(textures)


def read_ply(name):
    header, _, body = Path(name).read_bytes().partition(b"end_header\n")
    counts, names = {}, []
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        elif words[:2] == ["property", "float"]:
            names.append(words[2])
    stride = 4 * len(names)
    rows = [dict(zip(names, struct.unpack_from(f"<{len(names)}f", body, v * stride))) for v in range(counts["vertex"])]
    faces = []
    for f in range(counts["face"]):
        three, *face = struct.unpack_from("<B3I", body, counts["vertex"] * stride + 13 * f)
        assert three == 3
        faces.append(tuple(face))
    assert len(body) == counts["vertex"] * stride + 13 * counts["face"]
    return Model([(r["x"], r["y"], r["z"]) for r in rows], faces, [(r["nx"], r["ny"], r["nz"]) for r in rows if "nx" in r],
                 [(r["s"], 1 - r["t"]) for r in rows if "s" in r])


def read_obj(name):
    lines = [line.split() for line in Path(name).read_text().splitlines()]
    words_of = {kind: [words[1:] for words in lines if words and words[0] == kind] for kind in ("v", "vn", "vt", "f")}
    numbers = {kind: [tuple(map(float, words)) for words in words_of[kind]] for kind in ("v", "vn", "vt")}
    kinds = 1 + bool(numbers["vt"]) + bool(numbers["vn"])
    corners = [[word.split("/") for word in words] for words in words_of["f"]]
    assert all(corner == corner[:1] * kinds for face in corners for corner in face)
    faces = [tuple(int(corner[0]) - 1 for corner in face) for face in corners]
    return Model(numbers["v"], faces, numbers["vn"], [(s, 1 - t) for s, t in numbers["vt"]])


def as_float(number):
    return struct.unpack("f", struct.pack("f", number))[0]


def read_glb(name):
    file = Path(name).read_bytes()
    assert struct.unpack_from("<4s2I", file) == (b"glTF", 2, len(file))
    size = struct.unpack_from("<I", file, 12)[0]
    head, buffer = json.loads(file[20 : 20 + size]), file[28 + size :]

    def array(accessor):
        accessor = head["accessors"][accessor]
        view = head["bufferViews"][accessor["bufferView"]]
        form = "<" + {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]] * {5126: "f", 5125: "I", 5123: "H"}[accessor["componentType"]]
        assert view.get("byteOffset", 0) + view["byteLength"] <= head["buffers"][0]["byteLength"] <= len(buffer)
        return [struct.unpack_from(form, buffer, view.get("byteOffset", 0) + i * struct.calcsize(form)) for i in range(accessor["count"])]

    primitive = head["meshes"][0]["primitives"][0]
    north_up = [[(x, -z, y) for x, y, z in array(primitive["attributes"][key])] if key in primitive["attributes"] else []
                for key in ("POSITION", "NORMAL")]
    corners = [i for i, in array(primitive["indices"])]
    bounds = head["accessors"][primitive["attributes"]["POSITION"]]
    columns = list(zip(*array(primitive["attributes"]["POSITION"])))
    assert [list(map(min, columns)), list(map(max, columns))] == [[as_float(z) for z in bounds[end]] for end in ("min", "max")]
    textures = array(primitive["attributes"]["TEXCOORD_0"]) if "TEXCOORD_0" in primitive["attributes"] else []
    return Model(north_up[0], list(zip(corners[::3], corners[1::3], corners[2::3])), north_up[1], textures)


def read_stl(name):
    file = Path(name).read_bytes()
    count = struct.unpack_from("<I", file, 80)[0]
    assert len(file) == 84 + 50 * count
    vertices, faces, names = [], [], {}
    for f in range(count):
        numbers = struct.unpack_from("<12f", file, 84 + 50 * f)
        corners = [numbers[3:6], numbers[6:9], numbers[9:12]]
        for corner in corners:
            if corner not in names:
                names[corner] = len(vertices)
                vertices.append(corner)
        faces.append(tuple(names[corner] for corner in corners))
    return Model(vertices, faces)


def read_tile(name):
    """quantized-mesh: x and y are shares of the tile, z in metres. `edges`: west, south, east, north; `extensions` by number."""
    file = Path(name).read_bytes()
    low, high = struct.unpack_from("<2f", file, 24)
    count, = struct.unpack_from("<I", file, 88)
    at, arrays = 92, []
    for _ in range(3):
        value, numbers = 0, []
        for word in struct.unpack_from(f"<{count}H", file, at):
            value += (word >> 1) ^ -(word & 1)
            numbers.append(value)
        arrays.append(numbers)
        at += 2 * count
    letter, size = ("I", 4) if count > 65536 else ("H", 2)
    at += -at % size
    faces, = struct.unpack_from("<I", file, at)
    highest, corners = 0, []
    for code in struct.unpack_from(f"<{3 * faces}{letter}", file, at + 4):
        corners.append(highest - code)
        highest += code == 0
    at += 4 + 3 * faces * size
    edges = []
    for _ in range(4):
        number, = struct.unpack_from("<I", file, at)
        edges.append(struct.unpack_from(f"<{number}{letter}", file, at + 4))
        at += 4 + number * size
    model = Model([(u / 32767, v / 32767, low + (high - low) * h / 32767) for u, v, h in zip(*arrays)],
                  list(zip(corners[::3], corners[1::3], corners[2::3])))
    model.edges, model.grid, model.range, model.extensions = edges, list(zip(*arrays)), (low, high), {}
    while at < len(file):
        number, length = struct.unpack_from("<BI", file, at)
        model.extensions[number] = file[at + 5 : at + 5 + length]
        at += 5 + length
    assert at == len(file)
    return model


READERS = {"ply": read_ply, "obj": read_obj, "glb": read_glb, "stl": read_stl, "terrain": read_tile}


def read_model(name):
    return READERS[name.rpartition(".")[2]](name)


# ---- the judge ----
def judge(heights, model, place=lambda x, y, z: (x, y, z), slack=1e-6, may_be_open=lambda x, y: False):
    """The largest |surface - sample|, having looked that the faces are turned right, do not overlap, hang together along all edges
    but those around what has data and those at places that may be open, cover all cells of data and no sample without. `place` takes
    a vertex to (column, row from the north, height). Samples within `slack` of a border are held against the nearest point of it."""
    width, height = len(heights[0]), len(heights)
    points = [place(*vertex) for vertex in model.vertices]
    errors, area, edges = {}, 0, {}
    for a, b, c in model.faces:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[a], points[b], points[c]
        twice = (cx - ax) * (by - ay) - (bx - ax) * (cy - ay)
        assert twice > 0, "a face is turned over"
        area += twice / 2
        for edge in ((a, b), (b, c), (c, a)):
            assert edge not in edges, "an edge has two faces on one side"
            edges[edge] = True
        for j in range(max(0, math.ceil(min(ay, by, cy) - slack)), min(height - 1, math.floor(max(ay, by, cy) + slack)) + 1):
            for i in range(max(0, math.ceil(min(ax, bx, cx) - slack)), min(width - 1, math.floor(max(ax, bx, cx) + slack)) + 1):
                u = ((cx - bx) * (j - by) - (i - bx) * (cy - by)) / -twice
                v = ((ax - cx) * (j - cy) - (i - cx) * (ay - cy)) / -twice
                w = 1 - u - v
                inward = min(u, v, w)
                longest = max(math.hypot(bx - ax, by - ay), math.hypot(cx - bx, cy - by), math.hypot(ax - cx, ay - cy))
                if inward * twice < -slack * longest:
                    continue
                if heights[j][i] is None:
                    assert inward * twice <= slack * longest, f"a face covers ({i}, {j}), where there is no data"
                    continue
                error = abs(u * az + v * bz + w * cz - heights[j][i])
                is_inside = inward >= 0
                before = errors.get((i, j))
                if before is None or (is_inside and not before[0]):
                    errors[i, j] = (is_inside, error)
                elif is_inside == before[0]:
                    errors[i, j] = (is_inside, max(error, before[1]) if is_inside else min(error, before[1]))

    def is_cell(i, j):
        return 0 <= i < width - 1 and 0 <= j < height - 1 and None not in heights[j][i : i + 2] + heights[j + 1][i : i + 2]

    for a, b in edges:
        if (b, a) in edges:
            continue
        for share in (0.25, 0.5, 0.75):
            x, y = (points[a][k] + share * (points[b][k] - points[a][k]) for k in (0, 1))
            if may_be_open(x, y):
                continue
            around = [(math.floor(x + dx), math.floor(y + dy)) for dx in (-slack, slack) for dy in (-slack, slack)]
            assert not all(is_cell(*cell) for cell in around), f"an edge at ({x}, {y}) has one face, and data on both sides"
    cells = 0
    for j in range(height - 1):
        for i in range(width - 1):
            corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
            if is_cell(i, j):
                cells += 1
                assert all(corner in errors for corner in corners), f"the cell ({i}, {j}) is not covered"
    if all(z is not None for row in heights for z in row):
        assert abs(area - cells) < 1e-4 * cells + slack * 2 * (width + height), "faces overlap or leave gaps"
    return max(error for _, error in errors.values())
