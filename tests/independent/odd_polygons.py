# SPDX-License-Identifier: GPL-3.0-or-later
"""Small PLY, OBJ and STL files, one for each way that programs write them: line ends, types, orders, properties that few
have, counts that are wrong. Each case comes with its area, worked out by hand, so that a mistake of the second reader is
told from one of the import."""

import os
import struct
import zlib

from polygons import TYPES

CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
HALVES = [t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))]
CUBE = 6.0
WALL = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]  # a window, by a bridge: 12
COMB = [(0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]  # 8
LETTER = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]  # a U: 7
# Two windows, each by a bridge: 24 - 2.
WINDOWS = [(0, 0), (6, 0), (6, 4), (0, 4), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1), (4, 1), (4, 2), (5, 2), (5, 1),
           (4, 1), (1, 1)]


def png(color):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = (b"\0" + bytes(color) * 4) * 4
    head = struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


PICTURES = {"tex.png": png((200, 60, 20)), "other.png": png((20, 60, 200)), "my map.png": png((90, 90, 90))}

# PLY ------------------------------------------------------------------------------------------------------------------


def ply(elements, kind="ascii", eol="\n", comments=(), bom=b"", tail=b""):
    """elements: (name, ["type name" or "list counts items name"], rows of values and lists)"""
    head, body = ["ply", f"format {kind} 1.0", *("comment " + c for c in comments)], b""
    order = ">" if kind == "binary_big_endian" else "<"
    for name, properties, rows in elements:
        head += [f"element {name} {len(rows)}"] + ["property " + p for p in properties]
        types = [p.split() for p in properties]
        for row in rows:
            words = []
            for t, value in zip(types, row):
                flat = [(t[0], value)] if t[0] != "list" else [(t[1], len(value))] + [(t[2], x) for x in value]
                words += [f"{x:g}" for _, x in flat]
                if kind != "ascii":
                    body += b"".join(struct.pack(order + TYPES[letter], x) for letter, x in flat)
            if kind == "ascii":
                body += (" ".join(words) + eol).encode()
    return bom + (eol.join(head + ["end_header"]) + eol).encode() + body + tail


def vertices(extra=(), values=(), kind="float"):
    return ("vertex", [f"{kind} {c}" for c in "xyz"] + list(extra), [(*p, *values) for p in CORNERS])


def faces(extra=(), values=(), counts="uchar", items="int", name="vertex_indices", sides=SIDES):
    return ("face", [f"list {counts} {items} {name}"] + list(extra), [(s, *values) for s in sides])


def flat_polygon(points):
    """The last lies on the outline's plane, tilted, so that no axis is the natural one."""
    return [(x, y, x + y) for x, y in points]


def ply_cases():
    """name, bytes, area, textures, arguments of the build, the word for what is not carried"""
    for eol, name in (("\n", "lf"), ("\r", "cr"), ("\r\n", "crlf")):
        for kind in ("ascii", "binary_little_endian", "binary_big_endian"):
            yield f"{kind}_{name}", ply([vertices(), faces()], kind, eol, ["made by a CAD program"]), CUBE
    yield "bom", ply([vertices(), faces()], bom=b"\xef\xbb\xbf"), CUBE
    for kind in ("ascii", "binary_little_endian", "binary_big_endian"):
        for of_position in ("char", "uchar", "short", "ushort", "int", "uint", "double", "float32", "float64", "int16"):
            yield f"{kind}_{of_position}", ply([vertices(kind=of_position), faces()], kind), CUBE
        for counts, items in (("char", "uint"), ("int", "uchar"), ("ushort", "short"), ("uint8", "uint16"), ("uint", "int8")):
            yield f"{kind}_{counts}_{items}", ply([vertices(), faces(counts=counts, items=items)], kind), CUBE
        yield f"{kind}_faces_first", ply([faces(name="vertex_index"), vertices()], kind), CUBE
        more = ("edge", ["int vertex1", "int vertex2", "list uchar float weights"], [(0, 1, (1, 2)), (1, 2, ())])
        yield f"{kind}_extra", ply([vertices(["float confidence", "list uchar short marks"], [0.5, (1, 2, 3)]), more,
                                    faces(["uchar flags", "list int double areas"], [7, (1.5,)])], kind), CUBE
        strip = [i for a, b, c, d in SIDES for i in (a, b, d, c, -1)]
        yield f"{kind}_strips", ply([vertices(), ("tristrips", ["list int int vertex_indices"], [(strip[:-1],)])], kind), CUBE
        wedge = [(0, 0, 1, 0, 1, 1), (0, 0, 1, 1, 0, 1)] * 6
        rows = [(t, uv) for t, uv in zip(HALVES, wedge)]
        of_face = ("face", ["list uchar int vertex_indices", "list uchar float texcoord"], rows)
        yield f"{kind}_wedge", ply([vertices(), of_face], kind, comments=["TextureFile tex.png"]), CUBE
        yield f"{kind}_wedge_bare", ply([vertices(), of_face], kind), CUBE
        rows = [(t, uv, i % 2) for i, (t, uv) in enumerate(zip(HALVES, wedge))]
        of_face = ("face", of_face[1] + ["int texnumber"], rows)
        yield f"{kind}_two_textures", ply([vertices(), of_face], kind,
                                          comments=["TextureFile tex.png", "TextureFile other.png"]), CUBE
        color = ["uchar red", "uchar green", "uchar blue"]
        yield f"{kind}_face_color", ply([vertices(), faces(color, (255, 128, 0))], kind), CUBE
        yield f"{kind}_face_alpha", ply([vertices(), faces(color + ["uchar alpha"], (10, 128, 250, 51))], kind), CUBE
        yield f"{kind}_color", ply([vertices(color, (188, 100, 50)), faces()], kind), CUBE
        floats = ["float red", "float green", "float blue"]
        yield f"{kind}_float_color", ply([vertices(floats, (0.5, 0.25, 0.125)), faces()], kind), CUBE
    for names in (("u", "v"), ("s", "t"), ("texture_u", "texture_v")):
        yield "uv_" + names[0], ply([vertices([f"float {n}" for n in names], (0.25, 0.75)), faces()],
                                    comments=["TextureFile my map.png"]), CUBE
    yield "normals", ply([vertices(["float nx", "float ny", "float nz"], (0.6, 0.0, 0.8)), faces()]), CUBE
    for name, points, area in (("wall", WALL, 12), ("comb", COMB, 8), ("letter", LETTER, 7), ("windows", WINDOWS, 22)):
        element = ("vertex", ["float x", "float y", "float z"], flat_polygon(points))
        yield name, ply([element, faces(sides=[tuple(range(len(points)))])]), area * 3 ** 0.5
    yield "rgb", ply([vertices(["uchar r", "uchar g", "uchar b"], (9, 9, 9)), faces()]), CUBE
    yield "index_last", ply([vertices(), ("face", ["uchar kind", "list uchar int vertex_index"], [(3, s) for s in SIDES])]), CUBE
    yield "small_faces", ply([vertices(), faces(sides=[(0, 1), (), *SIDES, (3,)])]), CUBE
    yield "blank_lines", ply([vertices(), faces()], tail=b"\n\n  \n"), CUBE


# OBJ ------------------------------------------------------------------------------------------------------------------

V = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
VT = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
VN = "vn 0.6 0 0.8\nvn 0 1 0\n"


def f(corner, sides=None):
    return "".join("f " + " ".join(corner(i, k) for k, i in enumerate(side)) + "\n" for side in sides or SIDES)


PLAIN = f(lambda i, k: f"{i + 1}")
FULL = f(lambda i, k: f"{i + 1}/{k + 1}/{k % 2 + 1}")


def square(x, at, corner="{0}", size=1):
    """A square of its own vertices, the first of which is number `at`."""
    points = [(x, 0), (x + size, 0), (x + size, size), (x, size)]
    return "".join(f"v {a} {b} 0\n" for a, b in points) + "f " + " ".join(corner.format(at + i, i + 1) for i in range(4)) + "\n"


def polygon(points, at=1):
    return "".join(f"v {x} {y} {z}\n" for x, y, z in flat_polygon(points)) + \
        "f " + " ".join(str(at + i) for i in range(len(points))) + "\n"


def obj_cases():
    """name, OBJ, area"""
    for eol, name in (("\n", "lf"), ("\r", "cr"), ("\r\n", "crlf")):
        for bom, before in (("", ""), ("\ufeff", "bom_")):
            yield before + name, (bom + "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nf 1 3 4\n").replace("\n", eol), 1
    yield "blanks", "\n\f\n  v 0 0 0 \n\tv\t1 0 0\t\nv  1  1 0\n v 0 1 0\f\n\nf 1 2 3 4   \n", 1
    yield "no_last_line_end", V + PLAIN.rstrip("\n"), CUBE
    yield "continued", V + PLAIN.replace(" 1 2 4", " 1 \\\n 2 4") + "# a comment\n", CUBE
    yield "continued_crlf", (V + PLAIN.replace(" 1 2 4", " 1 \\\n 2 4")).replace("\n", "\r\n"), CUBE
    yield "relative", V + VT + VN + f(lambda i, k: f"{i - 8}/{k - 4}/{k % 2 - 2}"), CUBE
    yield "relative_parts", square(0, 1) + square(2, 5).replace("f 5 6 7 8", "f -4 -3 -2 -1"), 2
    yield "full", V + VT + VN + FULL, CUBE
    yield "only_vn", V + VN + f(lambda i, k: f"{i + 1}//{k % 2 + 1}"), CUBE
    yield "colors", "".join(f"v {x} {y} {z} 0.5 0.25 {z}\n" for x, y, z in CORNERS) + PLAIN, CUBE
    yield "numbers", "v +0 -0.0 0e0\nv 1.0E+0 .0 0.\nv 1 10e-1 0\nv 0 1 0 1.0\nf 1 2 3 4\n", 1
    yield "mixed_uv", VT + square(0, 1, "{0}/{1}") + square(2, 5) + square(4, 9, "{0}/{1}"), 3
    yield "mixed_vn", VN + square(0, 1, "{0}//1") + square(2, 5), 2
    yield "mixed_all", VT + VN + square(0, 1, "{0}/{1}/1") + square(2, 5) + square(4, 9, "{0}//2") + square(6, 13, "{0}/{1}"), 4
    yield "mixed_materials", "mtllib a.mtl\n" + VT + "usemtl painted\n" + square(0, 1, "{0}/{1}") + "usemtl plain\n" + \
        square(2, 5), 2
    yield "dangling_vt", V + f(lambda i, k: f"{i + 1}/{k + 1}"), CUBE
    yield "dangling_vn", V + f(lambda i, k: f"{i + 1}//{k + 1}"), CUBE
    for name, points, area in (("wall", WALL, 12), ("comb", COMB, 8), ("letter", LETTER, 7), ("windows", WINDOWS, 22)):
        yield name, polygon(points), area * 3 ** 0.5
        yield name + "_turned", polygon(points[::-1]), area * 3 ** 0.5
        yield name + "_textured", "mtllib a.mtl\nusemtl painted\n" + "".join(f"vt {x / 4} {y / 4}\n" for x, y in points) + \
            "".join(f"v {x} {y} {x + y}\n" for x, y in points) + \
            "f " + " ".join(f"{i + 1}/{i + 1}" for i in range(len(points))) + "\n", area * 3 ** 0.5
    yield "bent", "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv 0 1 -1\nf 1 2 3 4 5\n", 1 + 2 ** 0.5 + 5 ** 0.5
    yield "objects", "o left\n" + square(0, 1) + "o right side\n" + square(2, 5), 2
    yield "groups", "g left\n" + square(0, 1) + "g right\n" + square(2, 5), 2
    parts = PLAIN.splitlines(True)
    yield "shared_objects", V + "o front\n" + "".join(parts[:3]) + "o back\n" + "".join(parts[3:]), CUBE
    yield "objects_and_groups", V + "o one\ng front\n" + "".join(parts[:3]) + "g back\n" + "".join(parts[3:]), CUBE
    yield "two_names", "g left wing\n" + square(0, 1) + "g\n" + square(2, 5), 2
    yield "library_last", VT + "usemtl painted\n" + square(0, 1, "{0}/{1}") + "mtllib a.mtl\n", 1
    yield "one_number", "vt 0.5\nvt 0.25\nvt 1\nvt 0\n" + square(0, 1, "{0}/{1}"), 1
    yield "long_normals", "vn 3 0 4\n" + square(0, 1, "{0}//1"), 1
    yield "smooth", V + "s 1\n" + PLAIN + "s off\nl 1 2\np 3\n", CUBE
    yield "no_library", "mtllib gone.mtl\nusemtl a\n" + V + PLAIN, CUBE
    for number, (name, words, alpha) in enumerate(MATERIALS):
        yield f"mtl_{name}", f"mtllib m{number}.mtl\nusemtl it\n" + VT + square(0, 1, "{0}/{1}"), 1
    yield "two_libraries", "mtllib a.mtl b.mtl\nusemtl painted\n" + square(0, 1) + "usemtl second\n" + square(2, 5), 2
    yield "names_with_blanks", "mtllib a b.mtl\nusemtl a b c\n" + V + PLAIN, CUBE


# What a material `it` says, and its alpha.
MATERIALS = [("d", "Kd 1 0.5 0\nd 0.5", 0.5), ("tr", "Kd 1 0.5 0\nTr 0.25", 0.75), ("d_before_tr", "Kd 1 1 1\nd 1\nTr 1", 1.0),
             ("tr_before_d", "Kd 1 1 1\nTr 1\nd 1", 1.0), ("tr_1", "Kd 1 1 1\nTr 1.000000\nmap_Kd tex.png", 1.0),
             ("map_d", "Kd 1 1 1\nmap_Kd tex.png\nmap_d tex.png", 1.0), ("map_d_other", "map_Kd tex.png\nmap_d other.png", 1.0),
             ("norm", "Kd 1 1 1\nmap_Kd tex.png\nnorm other.png", 1.0), ("map_bump", "map_Bump other.png", 1.0),
             ("bump", "bump -bm 0.3 other.png", 1.0), ("ke", "Kd 0 0 0\nKe 0.5 0.25 0", 1.0), ("ke_bright", "Kd 0 0 0\nKe 4 1 0", 1.0),
             ("map_ke", "Kd 0 0 0\nKe 1 1 1\nmap_Ke other.png", 1.0), ("pbr", "Kd 1 1 1\nPr 0.25\nPm 0.75", 1.0),
             ("map_pr", "Pr 1\nmap_Pr other.png", 1.0), ("map_pm", "Pm 1\nmap_Pm other.png", 1.0),
             ("old", "Ka 0 0 0\nKd 0.1 0.2 0.3\nKs 1 1 1\nNs 200\nNi 1.5\nillum 2\nTf 1 1 1\nmap_Ks other.png\ndisp tex.png", 1.0),
             ("options", "map_Kd -s 2 2 1 -o 0.5 0 0 -clamp on tex.png", 1.0), ("blanks", "\tKd\t1 0 0\n  map_Kd   my map.png  ", 1.0),
             ("lower", "kd 0.25 0.5 1\nmap_kd tex.png", 1.0), ("d_0", "Kd 1 1 1\nd 0", 0.0)]


def libraries():
    """Files beside the OBJs."""
    files = {f"m{n}.mtl": f"newmtl it\n{words}\n" for n, (_, words, _) in enumerate(MATERIALS)}
    files["m0.mtl"] = "\ufeff" + files["m0.mtl"].replace("\n", "\r")
    files["m1.mtl"] = files["m1.mtl"].replace("\n", "\r\n")
    files["a.mtl"] = "newmtl painted\nKd 1 1 1\nmap_Kd tex.png\nnewmtl plain\nKd 0.2 0.4 0.6\n"
    files["b.mtl"] = "newmtl second\nKd 0.5 0.5 0.5\n"
    files["a b.mtl"] = "newmtl a b c\nKd 1 0 0\n"
    return files


# STL ------------------------------------------------------------------------------------------------------------------


def text_stl(eol="\n", upper=False, before="", name="part", solids=1):
    lines = []
    for s in range(solids):
        lines.append(f"solid {name}")
        for t in HALVES[s * 12 // solids:(s + 1) * 12 // solids]:
            lines += [" facet normal 0 0 0", "  outer loop"]
            lines += ["   vertex " + " ".join(f"{x:.6e}" for x in CORNERS[i]) for i in t]
            lines += ["  endloop", " endfacet"]
        lines.append(f"endsolid {name}")
    text = "\n".join(lines) + "\n"
    return (before + (text.upper() if upper else text)).replace("\n", eol).encode()


def binary_stl(count=12, head=b"part", attributes=None, tail=b""):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in CORNERS[i]), a)
                    for t, a in zip(HALVES, attributes or [0] * 12))
    return head.ljust(80, b" ") + struct.pack("<I", count) + body + tail


def stl_cases():
    for eol, name in (("\n", "lf"), ("\r", "cr"), ("\r\n", "crlf")):
        for upper in (False, True):
            yield f"text_{name}" + ("_upper" if upper else ""), text_stl(eol, upper), CUBE
    yield "bom", text_stl(before="\ufeff"), CUBE
    yield "blank_first", text_stl(before="\n \n"), CUBE
    yield "mixed_case", text_stl().replace(b"solid", b"Solid").replace(b"facet", b"Facet"), CUBE
    yield "no_name", text_stl(name=""), CUBE
    yield "two_solids", text_stl(solids=2), CUBE
    yield "no_end", text_stl().replace(b"endsolid part\n", b""), CUBE
    for name, count in (("right", 12), ("zero", 0), ("less", 7), ("more", 13), ("huge", 0xFFFFFFFF)):
        yield f"count_{name}", binary_stl(count), CUBE
        yield f"solid_count_{name}", binary_stl(count, b"solid part"), CUBE
    yield "tail", binary_stl(tail=b"\0" * 7), CUBE
    red, blue = 31 << 10 | 1 << 15, 31 | 1 << 15
    yield "viscam", binary_stl(attributes=[red, blue, 0] * 4), CUBE
    yield "magics", binary_stl(head=b"COLOR=\x40\x80\xff\xff,MATERIAL=" + bytes(12), attributes=[31, 31 << 10, 1 << 15] * 4), CUBE
    head = b"COLOR=\x40\x80\xff\xff"
    yield "meshlab", binary_stl(head=head, attributes=[31 | 1 << 15, 31 << 10 | 1 << 15, 0xFFFF] * 4), CUBE
    yield "magics_zero", binary_stl(head=head, attributes=[0] * 12), CUBE
    yield "attributes", binary_stl(attributes=[7] * 12), CUBE


def write_all(folder):
    """[(path, area, arguments of the build)]"""
    for name, data in PICTURES.items():
        write(folder, name, data)
    for name, text in libraries().items():
        write(folder, name, text.encode())
    cases = []
    for kind, made in (("ply", ply_cases()), ("obj", obj_cases()), ("stl", stl_cases())):
        for name, data, area, *arguments in made:
            path = write(folder, f"{kind}_{name}.{kind}", data.encode() if isinstance(data, str) else data)
            cases.append((path, area, arguments))
    return cases


def write(folder, name, data):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(data)
    return path
