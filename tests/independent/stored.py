# SPDX-License-Identifier: GPL-3.0-or-later
"""Stored pages: codecs lz4 and strips (docs/reference/codecs.md, section 3)."""

import struct

from codes import Columns, Stream, decode_lz4, make_code, unfold
from pages import decode_normal, field, i32
from rules import NONE, Unsupported, check

LZ4, ZSTD, DRACO, STRIPS = 1, 2, 3, 4
KINDS = 8  # of range words: material, UV 0 to 2, fit 0 and 1, colour 0 and 1
DELTA_KINDS = (2, 3)
NOBODY = -1
MASK = 0xFFFFFFFF


class Head:
    """A cluster's head and ranges, once they stand in the page."""

    def __init__(self, words, at, mesh):
        self.at = at
        self.vertices, self.triangles = field(words, at, 0, 0, 8) + 1, field(words, at, 0, 8, 8) + 1
        self.minimum = [field(words, at, 1 + k, 0, 24, True) for k in range(3)]
        self.bits = [field(words, at, 1 + k, 24, 5) for k in range(3)]
        self.chart, self.axis = field(words, at, 1, 29, 3), field(words, at, 2, 29, 2)
        self.shear = field(words, at, 4, 0, 8, True), field(words, at, 4, 8, 8, True)
        self.strips, self.reference_bits = field(words, at, 4, 16, 8) + 1, field(words, at, 4, 24, 4)
        self.has_normals = mesh["normal_mode"] == 1
        self.normal_bits, self.normal_minimum = [0, 0], [0, 0]
        if self.has_normals:
            self.normal_bits = [field(words, at, 4, 28, 4), field(words, at, 5, 28, 4)]
            self.normal_minimum = [field(words, at, 5, 0, 14), field(words, at, 5, 14, 14)]
        wrong = max(self.bits) > 24 or max(self.normal_bits) > 14 or self.axis > 2 or not 1 <= self.reference_bits <= 8
        check(not wrong and self.chart <= (5 if self.has_normals else 0), "a head", "is not possible")
        self.slots = self.triangles + 2 * self.strips
        self.references = self.slots - self.vertices
        self.sets, self.color = [], None

    def range_of(self, ranges, vertex):
        for piece in ranges:
            if vertex < piece["end"]:
                return piece
        raise AssertionError

    def roles(self):
        """Axes in the order of their streams."""
        return [k for k in range(3) if k != self.axis] + [self.axis]

    def field_bits(self, vertex):
        out = list(self.bits)
        if self.has_normals:
            out += self.normal_bits
        for ranges in self.sets:
            out += self.range_of(ranges, vertex)["bits"]
        if self.color:
            out += self.color["bits"]
        return out

    def sheared(self, raw):
        u, v = (raw[k] for k in range(3) if k != self.axis)
        return i32(self.shear[0] * u + self.shear[1] * v) >> 7

    @staticmethod
    def fitted(piece, side, raw):
        if piece["fit"] is None:
            return 0
        return i32(sum(f * r for f, r in zip(piece["fit"][side], raw))) >> piece["shift"][side]

    def integers(self, vertex, raw, scale):
        """What the fields of the stream say."""
        out = [m + r for m, r in zip(self.minimum, raw)]
        out[self.axis] += self.sheared(raw)
        at = 3
        if self.has_normals:
            out += decode_normal(self.normal_minimum[0] + raw[at], self.normal_minimum[1] + raw[at + 1], scale, self.chart)
            at += 2
        for ranges in self.sets:
            piece = self.range_of(ranges, vertex)
            for side in range(2):
                out.append(i32(piece["minimum"][side] + raw[at] + self.fitted(piece, side, raw)))
                at += 1
        if self.color:
            out += [m + r for m, r in zip(self.color["minimum"], raw[at:])]
        return out

    def fields(self, vertex, integers, scale):
        """The way back."""
        raw = [i32(v - m) & MASK for v, m in zip(integers, self.minimum)]
        raw[self.axis] = i32(raw[self.axis] - self.sheared(raw)) & MASK
        at = 3
        if self.has_normals:
            pole = self.chart // 2
            normal = integers[3:6]
            a, b = normal[(pole + 1) % 3], normal[(pole + 2) % 3]
            c = -normal[pole] if self.chart % 2 else normal[pole]
            if c < 0:
                a, b = (scale - abs(b)) * (1 if a >= 0 else -1), (scale - abs(a)) * (1 if b >= 0 else -1)
            raw += [a + scale - self.normal_minimum[0] & MASK, b + scale - self.normal_minimum[1] & MASK]
            at += 3
        for ranges in self.sets:
            piece = self.range_of(ranges, vertex)
            for side in range(2):
                raw.append(integers[at] - piece["minimum"][side] - self.fitted(piece, side, raw) & MASK)
                at += 1
        if self.color:
            raw += [v - m & MASK for v, m in zip(integers[at:], self.color["minimum"])]
        return raw


class Page:
    def __init__(self, stored, record, mesh, place):
        self.stored, self.record, self.mesh, self.place = stored, record, mesh, place
        self.words = [0] * (record["bytes"] // 4)
        self.words[0], self.words[1] = record["first_cluster"], record["cluster_count"]
        self.head_words = 6 if mesh["normal_mode"] == 1 else 5
        self.clusters = record["cluster_count"]
        check(2 + self.clusters * self.head_words < len(self.words), place, "its heads leave it")

    # ---- side information

    def read_planes(self, take):
        """`take(count)` gives the next column."""
        counts = struct.unpack(f"<{KINDS}I", take(4 * KINDS))
        for index in range(self.head_words):
            planes = [take(self.clusters) for _ in range(2 if index == 0 else 4)]
            before = 0
            for c, parts in enumerate(zip(*planes)):
                word = sum(part << 8 * k for k, part in enumerate(parts))
                if 1 <= index <= 3:
                    before = before + unfold(word & 0xFFFFFF) & 0xFFFFFF
                    word = word & 0xFF000000 | before
                self.words[2 + c * self.head_words + index] = word
        self.range_words = []
        for kind, count in enumerate(counts):
            planes = [take(count) if count else b"" for _ in range(4)]
            values, before = [], 0
            for parts in zip(*planes):
                value = sum(part << 8 * k for k, part in enumerate(parts))
                if kind in DELTA_KINDS:
                    value = before = before + unfold(value) & MASK
                values.append(value)
            self.range_words.append(iter(values))

    def place_word(self, kind, at):
        value = next(self.range_words[kind], None)
        check(value is not None and at + 1 < len(self.words), self.place, "range words are missing")
        self.words[at] = value
        return at + 1

    def place_cluster(self, c, at):
        """The head, complete, and the word behind the cluster's ranges."""
        check(at < min(len(self.words), 1 << 16), self.place, "data leaves the page")
        start = 2 + c * self.head_words
        self.words[start] |= at << 16
        head = Head(self.words, start, self.mesh)
        check(head.strips <= head.triangles and head.references >= 0, self.place, "strips are not possible")
        if self.mesh["material"] == NONE:
            covered = 0
            while covered < head.triangles:
                at = self.place_word(0, at)
                covered += (self.words[at - 1] & 255) + 1
        for _ in range(self.mesh["uv_set_count"]):
            ranges, covered = [], 0
            while covered < head.vertices:
                first = at
                for kind in (1, 2, 3):
                    at = self.place_word(kind, at)
                piece = {"bits": (field(self.words, first, 0, 8, 5), field(self.words, first, 0, 13, 5)),
                         "shift": (field(self.words, first, 0, 18, 5), field(self.words, first, 0, 23, 5)),
                         "minimum": (field(self.words, first, 1, 0, 32, True), field(self.words, first, 2, 0, 32, True)),
                         "start": covered, "fit": None}
                if field(self.words, first, 0, 28, 1):
                    for kind in (4, 5):
                        at = self.place_word(kind, at)
                    piece["fit"] = tuple(tuple(field(self.words, first, w, s, 10, True) for s in (0, 10, 20)) for w in (3, 4))
                check(max(piece["bits"]) <= 25, self.place, "more than 25 bits for a UV")
                covered += field(self.words, first, 0, 0, 8) + 1
                piece["end"] = covered
                ranges.append(piece)
            check(covered == head.vertices, self.place, "UV ranges do not end with the vertices")
            head.sets.append(ranges)
        if self.mesh["has_color"]:
            at = self.place_word(7, self.place_word(6, at))
            head.color = {"minimum": [field(self.words, at - 2, 0, 8 * k, 8) for k in range(4)],
                          "bits": [field(self.words, at - 1, 0, 4 * k, 4) for k in range(4)]}
            check(max(head.color["bits"]) <= 8, self.place, "more than 8 bits for a colour")
        return head, at

    def stream_bits(self, head):
        per_vertex = sum(sum(head.field_bits(v)) for v in range(head.vertices))
        return (per_vertex + head.triangles + head.slots + (head.strips - 1) * (head.triangles - 1).bit_length() +
                head.references * head.reference_bits)

    def finish(self, at):
        check(at + 1 == len(self.words), self.place, "is not filled exactly")
        return struct.pack(f"<{len(self.words)}I", *self.words)

    # ---- method 1

    def unpack_columns(self, side, rest):
        columns = Columns(side, self.place)
        self.read_planes(columns.bytes)
        columns.end()
        at, rest = 2 + self.clusters * self.head_words, Columns(rest, self.place)
        for c in range(self.clusters):
            head, at = self.place_cluster(c, at)
            count = (self.stream_bits(head) + 31) // 32
            check(at + count < len(self.words), self.place, "a stream leaves the page")
            self.words[at:at + count] = struct.unpack(f"<{count}I", rest.bytes(4 * count))
            at += count
        rest.end()
        return self.finish(at)

    # ---- method 2

    def field_names(self):
        names = ["positions", "positions", "shear"]
        if self.mesh["normal_mode"] == 1:
            names += ["normals"] * 2
        for k in range(self.mesh["uv_set_count"]):
            names += [f"uv{k}"] * 2
        return names + ["colours"] * 4 * self.mesh["has_color"]

    def unpack_strips(self, side, side_bytes, twin_count, rest):
        columns = Columns(side, self.place)
        sizes = {"triples": 216, "starts": 27, "lengths": 120, "references": 120, "twins": 120, "positions": 120,
                 "shear": 120, "normals": 120, "colours": 120}
        sizes.update({f"uv{k}": 120 for k in range(self.mesh["uv_set_count"])})
        total = 0

        def take(count):
            nonlocal total
            total += count
            return columns.column(count)

        lengths, codes = take(sum(sizes.values())), {}
        for name, size in sizes.items():
            codes[name], lengths = make_code(list(lengths[:size]), self.place), lengths[size:]
        self.read_planes(take)
        columns.end()
        check(total == side_bytes, self.place, "side information has another size")

        names = ["triples", "starts", "lengths", "references", "twins"] + self.field_names()
        rest = Columns(rest, self.place)
        stream_sizes = struct.unpack(f"<{len(names)}I", rest.bytes(4 * len(names)))
        streams = [Stream(rest.bytes(size), self.place) for size in stream_sizes]
        rest.end()
        self.streams, self.codes, self.names = streams, codes, names
        self.last_twin, self.all_integers, self.twins = 0, [], 0

        at = 2 + self.clusters * self.head_words
        for c in range(self.clusters):
            head, at = self.place_cluster(c, at)
            at = self.unpack_cluster(head, at)
        check(self.twins == twin_count, self.place, "the number of twins")
        return self.finish(at)

    def number(self, stream):
        return self.streams[stream].number(self.codes[self.names[stream]])

    def unpack_cluster(self, head, at):
        gates, kinds, turns, fresh, starts, distances = self.walk(head)
        raw = [None] * head.vertices
        half = [(1 << bits) >> 1 for bits in head.field_bits(0)]
        roles = head.roles() + list(range(3, len(half)))
        first = len(self.all_integers)
        scale = self.mesh["normal_scale"]
        for v in range(head.vertices):
            if kinds[v] == 2:
                self.last_twin += unfold(self.number(4))
                check(0 <= self.last_twin < first, self.place, "a twin that is not yet there")
                self.twins += 1
                raw[v] = head.fields(v, self.all_integers[self.last_twin], scale)
                continue
            a, b, c = (half if g == NOBODY else raw[g] for g in gates[v])
            raw[v] = [0] * len(half)
            for f, name in enumerate(self.names[5:]):
                k = roles[f]
                if name == "normals":
                    guess = (3 * a[k] + 3 * b[k] - 2 * c[k]) // 4
                else:
                    guess = a[k] + b[k] - c[k]
                raw[v][k] = guess + unfold(self.number(5 + f)) & MASK
        pieces = []  # (value, bits)
        raw = [[value & ((1 << bits) - 1) for value, bits in zip(fields, head.field_bits(v))] for v, fields in enumerate(raw)]
        self.all_integers += [head.integers(v, fields, scale) for v, fields in enumerate(raw)]
        spans, k = [(0, 3)], 3
        if head.has_normals:
            spans.append((k, k + 2))
            k += 2
        for _ in head.sets:
            spans.append((k, k + 2))
            k += 2
        if head.color:
            spans.append((k, k + 4))
        for low, high in spans:
            for v, fields in enumerate(raw):
                pieces += list(zip(fields[low:high], head.field_bits(v)[low:high]))
        pieces += [(turn, 1) for turn in turns] + [(f, 1) for f in fresh]
        pieces += [(start, (head.triangles - 1).bit_length()) for start in starts[1:]]
        for distance in distances:
            check(distance < 1 << head.reference_bits, self.place, "a reference needs more bits")
            pieces.append((distance, head.reference_bits))
        value, bit = 0, 0
        for piece, bits in pieces:
            value |= piece << bit
            bit += bits
        count = (bit + 31) // 32
        check(at + count < len(self.words), self.place, "a stream leaves the page")
        self.words[at:at + count] = struct.unpack(f"<{count}I", value.to_bytes(4 * count, "little"))
        return at + count

    def walk(self, head):
        gates, kinds, turns, fresh, starts, distances = [], [], [], [], [], []
        continued = []
        while len(continued) < head.triangles - head.strips:
            triple = self.streams[0].symbol(self.codes["triples"])
            continued += [triple % 6, triple // 6 % 6, triple // 36]
        continued = iter(continued)
        last = 0

        def name(gate, kind):
            nonlocal last
            fresh.append(int(kind > 0))
            if kind > 0:
                gates.append(gate)
                kinds.append(kind)
                return len(gates) - 1
            last += unfold(self.number(3))
            check(0 <= last < len(gates), self.place, "a reference to a vertex that is not yet there")
            distances.append(len(gates) - 1 - last)
            return last

        n = NOBODY
        for strip in range(head.strips):
            left = head.triangles - len(turns) - (head.strips - strip - 1)
            length = self.number(2) + 1 if strip + 1 < head.strips else left
            check(length <= left, self.place, "a strip is too long")
            starts.append(len(turns))
            start = self.streams[1].symbol(self.codes["starts"])
            p = name((n,) * 3, start // 9)
            q = name((p,) * 3, start // 3 % 3)
            n = name((q,) * 3, start % 3)
            turns.append(0)
            for _ in range(length - 1):
                turn, kind = divmod(next(continued), 3)
                turns.append(turn)
                if turn == 0:
                    p, q, c = p, n, q
                else:
                    p, q, c = n, q, p
                n = name((p, q, c), kind)
        check(len(gates) == head.vertices, self.place, "the strips do not name every vertex once")
        return gates, kinds, turns, fresh, starts, distances


def unpack_page(stored, record, mesh, place):
    """The decoded bytes of a page whose codec is not 0."""
    codec = record["codec"]
    if codec in (ZSTD, DRACO):
        raise Unsupported(f"{place}: codec {codec} needs a library")
    check(len(stored) >= 16, place, "its stored bytes are cut off")
    method, side_stored, side_bytes, twin_count = struct.unpack_from("<4I", stored)
    check(method == (1 if codec == LZ4 else 2), place, "another method than its codec's")
    check(16 + side_stored <= len(stored), place, "side information leaves the stored bytes")
    side, rest = stored[16:16 + side_stored], stored[16 + side_stored:]
    page = Page(stored, record, mesh, place)
    if codec == LZ4:
        check(twin_count == 0, place, "twins where there are none")
        return page.unpack_columns(decode_lz4(side, side_bytes, place), rest)
    return page.unpack_strips(side, side_bytes, twin_count, rest)
