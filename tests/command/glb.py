"""Reads .glb files of meshes by the specifications alone: glTF 2.0, KHR_mesh_quantization, EXT_meshopt_compression."""
import json
import struct
from pathlib import Path

NUMBERS = {5120: ("b", 127), 5121: ("B", 255), 5122: ("h", 32767), 5123: ("H", 65535), 5125: ("I", 1), 5126: ("f", 1)}


def unzigzag(value, mask):
    return (~(value >> 1) if value & 1 else value >> 1) & mask


def decode_attributes(data, count, stride):
    """Mode ATTRIBUTES, appendix A: bytes of an element are differences to the element before, 16 of them in a group."""
    assert data[0] == 0xA0
    at, tail = 1, data[len(data) - max(32, stride):]
    before = bytearray(tail[len(tail) - stride:])
    out = bytearray()
    while len(out) < count * stride:
        elements = min(count - len(out) // stride, min((8192 // stride) & ~15, 256))
        block = bytearray(elements * stride)
        for k in range(stride):
            groups = (elements + 15) // 16
            header, at = data[at : at + (groups + 3) // 4], at + (groups + 3) // 4
            deltas = []
            for group in range(groups):
                mode = header[group // 4] >> 2 * (group % 4) & 3
                if mode == 0:
                    deltas += [0] * 16
                elif mode == 3:
                    deltas += data[at : at + 16]
                    at += 16
                else:
                    bits = 2 * mode
                    packed, at = data[at : at + 2 * bits], at + 2 * bits
                    for i in range(16):
                        place = i * bits
                        value = packed[place // 8] >> 8 - bits - place % 8 & (1 << bits) - 1
                        if value == (1 << bits) - 1:
                            value, at = data[at], at + 1
                        deltas.append(value)
            for i in range(elements):
                before[k] = (before[k] + unzigzag(deltas[i], 255)) & 255
                block[i * stride + k] = before[k]
        out += block
    assert at + len(tail) == len(data)
    return bytes(out)


def decode_triangles(data, count):
    """Mode TRIANGLES, appendix A: edges and vertices that were met lately, and new ones in their order."""
    assert data[0] == 0xE1
    codes, at, table = data[1 : 1 + count // 3], 1 + count // 3, data[len(data) - 16 :]
    edges, vertices, state, out = [], [], {"next": 0, "last": 0}, []

    def fresh():
        state["next"] += 1
        return state["next"] - 1

    def explicit():
        nonlocal at
        value = shift = 0
        while True:
            byte, at = data[at], at + 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        state["last"] = (state["last"] + unzigzag(value, 0xFFFFFFFF)) & 0xFFFFFFFF
        return state["last"]

    def corner(code):
        return fresh() if code == 0 else explicit() if code == 15 else vertices[-code]

    for code in codes:
        high, low = code >> 4, code & 15
        if high < 15:
            a, b = edges[-1 - high]
            if low == 0:
                c = fresh()
            elif low < 13:
                c = vertices[-1 - low]
            elif low < 15:
                c = state["last"] = state["last"] + (1 if low == 14 else -1)
            else:
                c = explicit()
            pushed = [(c, b), (a, c)]
            new = [] if 0 < low < 13 else [c]
        else:
            pair = table[low] if low < 14 else data[at]
            at += low >= 14
            if low >= 14 and pair == 0:
                state["next"] = 0
            a = explicit() if low == 15 else fresh()
            b, c = corner(pair >> 4), corner(pair & 15)
            pushed = [(b, a), (c, b), (a, c)]
            new = [a] + [v for v, code in [(b, pair >> 4), (c, pair & 15)] if code in (0, 15)]
        edges, vertices = (edges + pushed)[-16:], (vertices + new)[-16:]
        out += [a, b, c]
    assert at + 16 == len(data)
    return out


class Glb:
    """The JSON, and the first mesh, all of its primitives as one: `attributes` by name as tuples, integers as shares where they are normalised; `faces`;
    `places` in the units of the scene."""

    def __init__(self, name):
        file = Path(name).read_bytes()
        assert struct.unpack_from("<4s2I", file) == (b"glTF", 2, len(file)) and len(file) % 4 == 0
        size = struct.unpack_from("<I", file, 12)[0]
        self.json = json.loads(file[20 : 20 + size])
        self.buffer = file[28 + size :]
        self.attributes, self.faces = {}, []
        for primitive in self.json["meshes"][0]["primitives"]:
            first = len(self.attributes.get("POSITION", []))
            corners = [first + i for i, in self.array(primitive["indices"])]
            self.faces += zip(corners[::3], corners[1::3], corners[2::3])
            for name, i in primitive["attributes"].items():
                self.attributes.setdefault(name, []).extend(self.array(i))
        node = self.json["nodes"][0]
        self.places = [tuple(x * s + t for x, s, t in zip(place, node["scale"], node["translation"]))
                       for place in self.attributes["POSITION"]]

    def array(self, accessor):
        accessor = self.json["accessors"][accessor]
        view = self.json["bufferViews"][accessor["bufferView"]]
        letter, most = NUMBERS[accessor["componentType"]]
        components = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        form = "<" + components * letter
        stride = view.get("byteStride", struct.calcsize(form))
        data = self.view(view, stride, accessor["count"])
        assert len(data) == view["byteLength"] == stride * accessor["count"]
        offset = accessor.get("byteOffset", 0)
        assert offset % 4 == 0 and offset + struct.calcsize(form) <= stride
        values = [struct.unpack_from(form, data, i * stride + offset) for i in range(accessor["count"])]
        return [tuple(x / most for x in value) for value in values] if accessor.get("normalized") else values

    def view(self, view, stride, count):
        assert view.get("byteOffset", 0) % 4 == 0
        packed = view.get("extensions", {}).get("EXT_meshopt_compression")
        source = packed or view
        assert source["buffer"] == 0
        data = self.buffer[source.get("byteOffset", 0) :][: source["byteLength"]]
        if not packed:
            return data
        assert (packed["byteStride"], packed["count"]) == (stride, count)
        fallback = self.json["buffers"][view["buffer"]]
        assert "uri" not in fallback and fallback["extensions"]["EXT_meshopt_compression"]["fallback"]
        if packed["mode"] == "ATTRIBUTES":
            return decode_attributes(data, count, stride)
        return struct.pack("<%d%s" % (count, "H" if stride == 2 else "I"), *decode_triangles(data, count))
