# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages: heads, ranges, the bit stream and strips (docs/reference/format.md, sections 12 and 13)."""

import struct

from rules import NONE, check


def i32(value):
    """Modulo 2^32, as a signed number."""
    value &= 0xFFFFFFFF
    return value - (1 << 32) if value >> 31 else value


def field(words, at, word, shift, bits, signed=False):
    value = words[at + word] >> shift & ((1 << bits) - 1)
    return value - (1 << bits) if signed and value >> (bits - 1) else value


class Bits:
    """The bit stream: bit k is bit k mod 32 of word k / 32; fields lie lowest bit first."""

    def __init__(self, words, at):
        check(at < len(words), "bit stream", "leaves the page")
        # One long integer: its bit k is the stream's bit k.
        self.value = int.from_bytes(struct.pack(f"<{len(words) - at}I", *words[at:]), "little")
        self.size = 32 * (len(words) - at)
        self.at = 0

    def take(self, count):
        check(self.at + count <= self.size, "bit stream", "leaves the page")
        value = self.value >> self.at & ((1 << count) - 1)
        self.at += count
        return value

    def take_many(self, counts, repeat):
        """`repeat` times one value for each of `counts`; cuts out a short piece first, which is much faster."""
        piece, width = self.take(sum(counts) * repeat), sum(counts)
        rows = []
        for i in range(repeat):
            row = piece >> i * width & ((1 << width) - 1)
            values = []
            for count in counts:
                values.append(row & ((1 << count) - 1))
                row >>= count
            rows.append(values)
        return rows


def decode_normal(a, b, scale, chart):
    axis, is_negative = chart // 2, chart % 2
    a, b = a - scale, b - scale
    c = scale - abs(a) - abs(b)
    if c < 0:
        a, b = (scale - abs(b)) * (1 if a >= 0 else -1), (scale - abs(a)) * (1 if b >= 0 else -1)
    normal = [0, 0, 0]
    normal[axis] = -c if is_negative else c
    normal[(axis + 1) % 3] = a
    normal[(axis + 2) % 3] = b
    return normal


def decode_strips(bits, triangle_count, strip_count, reference_bits, vertex_count, place):
    turn = [bits.take(1) for _ in range(triangle_count)]
    slots = triangle_count + 2 * strip_count
    fresh = [bits.take(1) for _ in range(slots)]
    starts = [0] + [bits.take((triangle_count - 1).bit_length()) for _ in range(strip_count - 1)]
    check(all(a < b for a, b in zip(starts, starts[1:])) and starts[-1] < triangle_count, place, "strips do not ascend")
    names, named = [], 0
    for is_fresh in fresh:
        if is_fresh:
            names.append(named)
            named += 1
        else:
            back = bits.take(reference_bits)
            check(back < named, place, "a reference to a vertex that was not named")
            names.append(named - 1 - back)
    check(named == vertex_count, place, "the strips do not name every vertex once")
    triangles = []
    strip = -1
    for t in range(triangle_count):
        if strip + 1 < strip_count and starts[strip + 1] == t:
            strip += 1
            first = t
            check(turn[t] == 0, place, "the first triangle of a strip turns")
        last = t + 2 * strip + 2
        if turn[t] == 0:
            q = last - 1
            turns = [r for r in range(first + 1, t) if turn[r] == 1]
            p = turns[-1] + 2 * strip + 2 - 1 if turns else first + 2 * strip + 2 - 2
        else:
            p = last - 1
            q = [r for r in range(first, t) if turn[r] == 0][-1] + 2 * strip + 2 - 1
        triangles.append((names[p], names[q], names[last]))
    return triangles


def read_materials(words, at, triangle_count, mesh, material_count, place):
    if mesh["material"] != NONE:
        return [mesh["material"]] * triangle_count, at
    materials = []
    while len(materials) < triangle_count:
        check(at < len(words), place, "material ranges leave the page")
        material = field(words, at, 0, 8, 24)
        check(not materials or materials[-1] < material, place, "materials do not ascend")
        materials += [material] * (field(words, at, 0, 0, 8) + 1)
        at += 1
    check(len(materials) == triangle_count, place, "material ranges do not end with the triangles")
    check(all(m < material_count for m in materials), place, "no such material")
    return materials, at


def read_uv_ranges(words, at, vertex_count, place):
    ranges, covered = [], 0
    while covered < vertex_count:
        check(at + 3 <= len(words), place, "UV ranges leave the page")
        has_fit = field(words, at, 0, 28, 1)
        check(at + 3 + 2 * has_fit <= len(words), place, "UV ranges leave the page")
        piece = {"count": field(words, at, 0, 0, 8) + 1,
                 "bits": (field(words, at, 0, 8, 5), field(words, at, 0, 13, 5)),
                 "shift": (field(words, at, 0, 18, 5), field(words, at, 0, 23, 5)),
                 "minimum": (field(words, at, 1, 0, 32, True), field(words, at, 2, 0, 32, True)),
                 "fit": None}
        check(field(words, at, 0, 29, 3) == 0, place, "unnamed bits are not zero")
        check(max(piece["bits"]) <= 25, place, "more than 25 bits for a UV")
        if has_fit:
            piece["fit"] = tuple(tuple(field(words, at, w, s, 10, True) for s in (0, 10, 20)) for w in (3, 4))
            check(words[at + 3] >> 30 == 0 and words[at + 4] >> 30 == 0, place, "unnamed bits are not zero")
        covered += piece["count"]
        ranges.append(piece)
        at += 3 + 2 * has_fit
    check(covered == vertex_count, place, "UV ranges do not end with the vertices")
    return ranges, at


def decode_cluster(words, head, mesh, record, material_count, place):
    """(vertices, triangles, the word where the cluster's data starts, the word behind it)."""
    vertex_count, triangle_count = field(words, head, 0, 0, 8) + 1, field(words, head, 0, 8, 8) + 1
    check(vertex_count == record["vertices_less_1"] + 1, place, "vertex count is not the record's")
    check(triangle_count == record["triangles_less_1"] + 1, place, "triangle count is not the record's")
    start = at = field(words, head, 0, 16, 16)
    minimum = [field(words, head, 1 + k, 0, 24, True) for k in range(3)]
    axis_bits = [field(words, head, 1 + k, 24, 5) for k in range(3)]
    check(max(axis_bits) <= 24, place, "more than 24 bits for a position")
    check(words[head + 3] >> 29 == 0, place, "unnamed bits are not zero")
    chart, shear_axis = field(words, head, 1, 29, 3), field(words, head, 2, 29, 2)
    check(words[head + 2] >> 31 == 0, place, "unnamed bits are not zero")
    check(shear_axis <= 2 and chart <= 5, place, "no such axis")
    shear = field(words, head, 4, 0, 8, True), field(words, head, 4, 8, 8, True)
    strip_count, reference_bits = field(words, head, 4, 16, 8) + 1, field(words, head, 4, 24, 4)
    check(strip_count <= triangle_count and 1 <= reference_bits <= 8, place, "strips are not possible")
    has_normals = mesh["normal_mode"] == 1
    normal_bits = [field(words, head, 4, 28, 4), field(words, head, 5, 28, 4) if has_normals else 0]
    check(max(normal_bits) <= 14, place, "more than 14 bits for a normal")
    if not has_normals:
        check(normal_bits[0] == 0 and chart == 0, place, "normals where none are stored")

    materials, at = read_materials(words, at, triangle_count, mesh, material_count, place)
    uv_sets = []
    for _ in range(mesh["uv_set_count"]):
        ranges, at = read_uv_ranges(words, at, vertex_count, place)
        uv_sets.append(ranges)
    if mesh["has_color"]:
        check(at + 2 <= len(words), place, "the colour range leaves the page")
        color_minimum = [field(words, at, 0, 8 * k, 8) for k in range(4)]
        color_bits = [field(words, at, 1, 4 * k, 4) for k in range(4)]
        check(max(color_bits) <= 8 and words[at + 1] >> 16 == 0, place, "the colour range")
        at += 2

    bits = Bits(words, at)
    vertices, raw = [], bits.take_many(axis_bits, vertex_count)
    for r in raw:
        position = [i32(m + v) for m, v in zip(minimum, r)]
        u, v = (r[k] for k in range(3) if k != shear_axis)
        position[shear_axis] = i32(position[shear_axis] + (i32(shear[0] * u + shear[1] * v) >> 7))
        vertices.append(position)
    if has_normals:
        low = field(words, head, 5, 0, 14), field(words, head, 5, 14, 14)
        for vertex, (a, b) in zip(vertices, bits.take_many(normal_bits, vertex_count)):
            vertex += decode_normal(low[0] + a, low[1] + b, mesh["normal_scale"], chart)
    for ranges in uv_sets:
        i = 0
        for piece in ranges:
            for values in bits.take_many(piece["bits"], piece["count"]):
                for k in range(2):
                    value = piece["minimum"][k] + values[k]
                    if piece["fit"]:
                        slope = sum(f * r for f, r in zip(piece["fit"][k], raw[i]))
                        value += i32(slope) >> piece["shift"][k]
                    vertices[i].append(i32(value))
                i += 1
    if mesh["has_color"]:
        for vertex, values in zip(vertices, bits.take_many(color_bits, vertex_count)):
            vertex += [i32(m + v) for m, v in zip(color_minimum, values)]
    corners = decode_strips(bits, triangle_count, strip_count, reference_bits, vertex_count, place)
    end = at + (bits.at + 31) // 32
    rest = (end - at) * 32 - bits.at
    check(bits.take(rest) == 0, place, "the stream's last word is not filled with zeros")
    return vertices, [corner + (m,) for corner, m in zip(corners, materials)], start, end


def decode_page(data, index, page, mesh, tables):
    place = f"page {index}"
    check(len(data) % 4 == 0 and len(data) >= 8, place, "is not whole words")
    words = struct.unpack(f"<{len(data) // 4}I", data)
    check(words[0] == page["first_cluster"] and words[1] == page["cluster_count"], place, "its head is not its record's")
    head_words = 6 if mesh["normal_mode"] == 1 else 5
    end = 2 + head_words * words[1]
    check(end < len(words), place, "its heads leave it")
    for i in range(words[1]):
        cluster = words[0] + i
        here = f"{place}, cluster {cluster}"
        vertices, triangles, start, stop = decode_cluster(words, 2 + head_words * i, mesh, tables["CLUS"][cluster],
                                                          len(tables["MATL"]), here)
        check(start == end, here, "its data does not follow the cluster before it")
        end = stop
        yield cluster, vertices, triangles
    check(end == len(words) - 1 and words[end] == 0, place, "does not end with one zero word")
