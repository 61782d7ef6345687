# SPDX-License-Identifier: GPL-3.0-or-later
"""A second reader of .lode files, written from docs/reference/format.md alone and with Python's standard library alone.

    python3 lode.py FILE         the canonical text: every integer of every table and page, floats as their bits
    python3 lode.py --hash FILE  its SHA-256

It opens, checks and decodes everything but pages of the codecs zstd and draco, for which Python has no library of its own.
A file that breaks a rule ends with its place and exit code 3; one that asks for more than this reader does (a codec, a
required section) with exit code 5."""

import hashlib
import struct
import sys

from codes import decode_section
from layout import TABLES_TEXT
from pages import decode_page
from rules import Invalid, NONE, Unsupported, check
from stored import unpack_page
from tables import check_tables, hold_hints
from xxh3 import canonical_128, xxh3_64

FORMATS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "i8": "b", "i16": "h", "i32": "i", "f32": "I", "f64": "Q",
           "str": "II"}
EXPONENTS = {"f32": 0x7F800000, "f64": 0x7FF0000000000000}
VERSIONS = (1, 2)
TEXTS = ("META", "SCNE", "STRS")
SECTIONS = ("META", "SCNE", "STRS", "MESH", "MATL", "INST", "GRUP", "CLUS", "NODE", "PAGT", "PDEP", "BLBT", "PAGE",
            "BLOB")
PROMISES = ("PRMS", "PRMG")  # both or neither
OPTIONAL = PROMISES + ("PHNT",)


def parse_layout(text):
    """Lines `offset type[count] field`; the last one is `size bytes`."""
    fields, end = [], 0
    for line in text.strip().splitlines():
        words = line.split()
        if words[0] == "size":
            assert end == int(words[1]), text
            return end, fields
        kind, _, count = words[1].partition("[")
        count = int(count.rstrip("]")) if count else 1
        assert int(words[0]) == end, line  # nothing lies between the fields
        fields.append((words[2], end, kind, count))
        end += struct.calcsize("<" + FORMATS[kind]) * count
    raise AssertionError(text)


LAYOUTS = {name: parse_layout(text) for name, text in TABLES_TEXT.items()}


def read_record(data, at, layout):
    """A dictionary of integers and tuples of integers; floats are their bits."""
    record = {}
    for field, offset, kind, count in LAYOUTS[layout][1]:
        values = struct.unpack_from(f"<{count * len(FORMATS[kind])}{FORMATS[kind][0]}", data, at + offset)
        if kind in EXPONENTS:
            for bits in values:
                check(bits & EXPONENTS[kind] != EXPONENTS[kind], f"{layout} at {at}, field {field}", "is not finite")
        record[field] = values[0] if len(values) == 1 else values
    return record


def is_zero(data):
    return not any(data)


def align(offset):
    return (offset + 15) // 16 * 16


class Lode:
    def __init__(self, data):
        self.data, self.decoded = data, {}
        self.read_header()
        self.read_sections()
        self.tables = {name: self.read_table(name) for name in ("MESH", "MATL", "INST", "GRUP", "CLUS", "NODE", "PAGT",
                                                                 "BLBT")}
        check(len([name for name in PROMISES if name in self.sections]) != 1, "section PRMS", "is there without PRMG, or PRMG without it")
        self.tables["version"] = self.header["version"]
        for name in OPTIONAL:
            self.tables[name] = self.read_table(name) if name in self.sections else []
        self.tables["has_promises"] = "PRMS" in self.sections
        self.tables["has_hints"] = "PHNT" in self.sections
        raw = self.section("PDEP")
        check(len(raw) % 4 == 0, "section PDEP", "is not whole records")
        self.tables["PDEP"] = list(struct.unpack(f"<{len(raw) // 4}I", raw))
        self.tables["STRS"] = self.section("STRS")
        self.tables["PAGE"] = self.sections["PAGE"]
        self.tables["BLOB"] = self.sections["BLOB"]
        check_tables(self.tables)

    def read_header(self):
        data = self.data
        check(len(data) >= 64, "header", "is cut off")
        header = self.header = read_record(data, 0, "HEADER")
        check(bytes(header["magic"]) == b"LODE", "header, field magic")
        if header["version"] not in VERSIONS:
            raise Unsupported(f"header, field version: {header['version']}")
        check(header["header_bytes"] == 64, "header, field header_bytes")
        check(header["section_entry_bytes"] == 64, "header, field section_entry_bytes")
        check(header["section_table_offset"] == 64, "header, field section_table_offset")
        check(header["flags"] == 0, "header, field flags")
        check(header["file_bytes"] == len(data), "header, field file_bytes", "is not the file's size")
        end = 64 + 64 * header["section_count"]
        check(end <= len(data), "header, field section_count", "leaves the file")
        check(xxh3_64(data[:56] + bytes(8) + data[64:end]) == header["header_checksum"], "header, field header_checksum")
        self.table_end = end

    def read_sections(self):
        self.sections = {}
        end = self.table_end
        for i in range(self.header["section_count"]):
            entry = read_record(self.data, 64 + 64 * i, "ENTRY")
            name = bytes(entry["id"]).decode("latin-1")
            place = f"section {name}"
            check(entry["offset"] == align(end), place + ", field offset")
            check(entry["bytes"] <= len(self.data) - entry["offset"], place + ", field bytes", "leaves the file")
            check(is_zero(self.data[end:entry["offset"]]), place, "the padding before it is not zero")
            end = entry["offset"] + entry["bytes"]
            if name not in SECTIONS + OPTIONAL:
                if entry["flags"] & 1:
                    raise Unsupported(f"{place}: is required and not known")
                continue
            check(name not in self.sections, place, "is there twice")
            self.check_entry(name, entry, place)
            self.sections[name] = entry
        check(end == len(self.data), "section table", "bytes are left over at the end of the file")
        for name in SECTIONS:
            check(name in self.sections, f"section {name}", "is missing")

    def check_entry(self, name, entry, place):
        if entry["version"] != 0 or entry["codec"] > (0 if name in ("PAGE", "BLOB") else 1):
            raise Unsupported(f"{place}: version or codec is not known")
        check(entry["flags"] & ~1 == 0, place + ", field flags")
        if entry["codec"] == 0:
            check(entry["decoded_bytes"] == entry["bytes"], place + ", field decoded_bytes")
        stride = 4 if name == "PDEP" else LAYOUTS[name][0] if name in LAYOUTS else 0
        check(entry["record_bytes"] == stride, place + ", field record_bytes")
        check(entry["record_count"] * stride == (entry["decoded_bytes"] if stride else 0), place + ", field record_count")
        check(entry["record_count"] < NONE and (stride or entry["record_count"] == 0), place + ", field record_count")
        if name == "PAGE":
            check(entry["checksum"] == 0, place + ", field checksum")
        else:
            stored = self.data[entry["offset"]:entry["offset"] + entry["bytes"]]
            check(xxh3_64(stored) == entry["checksum"], place + ", field checksum")

    def section(self, name):
        if name not in self.decoded:
            entry = self.sections[name]
            data = self.data[entry["offset"]:entry["offset"] + entry["bytes"]]
            if entry["codec"] == 1:
                data = decode_section(data, entry["record_bytes"], entry["decoded_bytes"], f"section {name}")
            self.decoded[name] = data
        return self.decoded[name]

    def read_table(self, name):
        size, data = LAYOUTS[name][0], self.section(name)
        return [read_record(data, i * size, name) for i in range(self.sections[name]["record_count"])]

    def page_bytes(self, index):
        page = self.tables["PAGT"][index]
        place = f"page {index}"
        stored = self.data[page["offset"]:page["offset"] + page["stored_bytes"]]
        check(xxh3_64(stored) == page["checksum"], place + ", field checksum")
        if index > 0:
            before = self.tables["PAGT"][index - 1]
            gap = self.data[before["offset"] + before["stored_bytes"]:page["offset"]]
            check(is_zero(gap), place, "the padding before it is not zero")
        if page["codec"] != 0:
            mesh = self.tables["MESH"][self.tables["GRUP"][page["first_group"]]["mesh"]]
            stored = unpack_page(stored, page, mesh, place)
            check(xxh3_64(stored) == page["decoded_checksum"], place + ", field decoded_checksum")
            return stored
        check(page["decoded_checksum"] == page["checksum"], place + ", field decoded_checksum")
        return stored

    def clusters(self):
        """(id, vertices, triangles with material) of every cluster, in order."""
        for index, page in enumerate(self.tables["PAGT"]):
            mesh = self.tables["MESH"][self.tables["GRUP"][page["first_group"]]["mesh"]]
            yield from decode_page(self.page_bytes(index), index, page, mesh, self.tables)

    def check_blobs(self):
        entry, end = self.sections["BLOB"], self.sections["BLOB"]["offset"]
        for i, blob in enumerate(self.tables["BLBT"]):
            data = self.data[blob["offset"]:blob["offset"] + blob["bytes"]]
            check(xxh3_64(data) == blob["checksum"], f"section BLBT, record {i}, field checksum")
            check(is_zero(self.data[end:blob["offset"]]), f"section BLBT, record {i}", "the padding before it is not zero")
            end = blob["offset"] + blob["bytes"]
        check(end == entry["offset"] + entry["bytes"], "section BLOB", "bytes are left over")

    def content_hash(self):
        def head(name):
            return name.encode() + struct.pack("<Q", len(self.section(name)))

        def without(name, fields):
            size, layout = LAYOUTS[name]
            raw = bytearray(self.section(name))
            for field, offset, kind, _ in layout:
                if field in fields:
                    width = struct.calcsize("<" + FORMATS[kind])
                    for at in range(offset, len(raw), size):
                        raw[at:at + width] = bytes(width)
            return bytes(raw)

        parts = [struct.pack("<I", self.header["version"])]
        for name in ("SCNE", "STRS", "MESH", "MATL", "INST", "GRUP", "CLUS", "NODE"):
            parts += [head(name), self.section(name)]
        parts += [head("PAGT"), without("PAGT", ("offset", "stored_bytes", "codec", "checksum"))]
        parts += [head("PDEP"), self.section("PDEP")]
        parts += [self.page_bytes(i) for i in range(len(self.tables["PAGT"]))]
        parts += [head("BLBT"), without("BLBT", ("offset",))]
        parts += [self.data[b["offset"]:b["offset"] + b["bytes"]] for b in self.tables["BLBT"]]
        for name in PROMISES:
            if name in self.sections:
                parts += [head(name), self.section(name)]
        return canonical_128(b"".join(parts))


def canonical_lines(lode):
    """What two readers must agree on, one line a record, a vertex or a triangle."""
    yield f"lode {lode.header['version']} {bytes(lode.header['content_hash']).hex()}"
    for name in TEXTS:
        yield f"{name} {lode.section(name).hex()}"
    for name in ("MESH", "MATL", "INST", "GRUP", "CLUS", "NODE", "PAGT", "BLBT", "PRMS", "PRMG", "PHNT"):
        for i, record in enumerate(lode.tables[name]):
            words = []
            for field, _, kind, _ in LAYOUTS[name][1]:
                if field == "reserved":
                    continue
                values = record[field] if isinstance(record[field], tuple) else (record[field],)
                words += [f"{v:08x}" if kind == "f32" else f"{v:016x}" if kind == "f64" else str(v) for v in values]
            yield f"{name} {i} {' '.join(words)}"
    for i, page in enumerate(lode.tables["PDEP"]):
        yield f"PDEP {i} {page}"
    for cluster, vertices, triangles in lode.clusters():
        yield f"cluster {cluster} {len(vertices)} {len(triangles)}"
        for vertex in vertices:
            yield "v " + " ".join(map(str, vertex))
        for triangle in triangles:
            yield "t " + " ".join(map(str, triangle))


def read(data, is_complete=True):
    """(0, the canonical text), or (3 or 5, the reason). Complete: with what section 16 leaves to `validate`."""
    try:
        lode = Lode(data)
        lines = "\n".join(canonical_lines(lode)) + "\n"
        if is_complete:
            lode.check_blobs()
            hold_hints(lode.tables)
            check(lode.content_hash() == bytes(lode.header["content_hash"]), "header, field content_hash")
    except Invalid as error:
        return 3, str(error)
    except Unsupported as error:
        return 5, str(error)
    return 0, lines


def main(arguments):
    as_hash = arguments[:1] == ["--hash"]
    if as_hash:
        arguments = arguments[1:]
    if len(arguments) != 1:
        sys.stderr.write(__doc__)
        return 1
    with open(arguments[0], "rb") as file:
        status, lines = read(file.read())
    if status != 0:
        sys.stderr.write(f"{lines}\n")
        return status
    sys.stdout.write(hashlib.sha256(lines.encode()).hexdigest() + "\n" if as_hash else lines)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
