# SPDX-License-Identifier: GPL-3.0-or-later
"""A second reader of PLY, OBJ, MTL and STL, from the formats' public descriptions and with Python's standard library
alone: Turk's "The PLY Polygon File Format" (1994) with MeshLab's texture coordinates of corners and TextureFile, Alias
Wavefront's OBJ and MTL specifications with the PBR extension of MTL, the STL of 3D Systems' StereoLithography Interface
Specification with the facet colours of VisCAM and Magics.

It reads sound files and says what each of them holds: faces with what their corners have, materials, names, and the words
for what an asset has no place for, which an import must name."""

import os
import re
import struct

BLANKS = " \t\f\v"


class Face:
    """A polygon: positions, and for all of its corners or for none UVs, normals and linear colours."""

    def __init__(self, points, material=None, uvs=None, normals=None, colors=None):
        self.points, self.material, self.uvs, self.normals, self.colors = points, material, uvs, normals, colors


class Material:
    def __init__(self):
        self.color, self.alpha = (1.0, 1.0, 1.0), 1.0
        self.opacity = {}   # "d" and "tr", as they are given
        self.factors = {}   # "roughness", "metallic" and "emissive": values
        self.textures = {}  # role: file
        self.options = {}   # role: options of it, which are not carried


class Model:
    def __init__(self):
        self.faces, self.materials = [], {}
        self.names = []        # of objects and groups that have faces
        self.unread = set()    # words that must be named
        self.by_texture = False  # materials have no names: they are told apart by their picture


def to_linear(s):
    """IEC 61966-2-1."""
    return s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4


def text_lines(data):
    return re.split(r"\r\n|\n|\r", data.decode("utf-8-sig", "replace"))


def beside(path, name):
    """Names are also written as Windows has them."""
    return os.path.join(os.path.dirname(path), name.replace("\\", "/"))


# PLY ------------------------------------------------------------------------------------------------------------------

TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
         "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f",
         "float64": "d"}
COLORS = ("red", "green", "blue", "alpha")
SHORT_NAMES = {"r": "red", "g": "green", "b": "blue", "a": "alpha"}
UV_NAMES = (("u", "v"), ("s", "t"), ("texture_u", "texture_v"))
INDEX_NAMES = ("vertex_indices", "vertex_index")


def ply_header(data):
    """(format, elements [(name, count, [(property, type, type of the count or None)])], textures, what follows)"""
    data = data[3:] if data.startswith(b"\xef\xbb\xbf") else data
    end = re.search(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)", data)
    elements, textures, kind = [], [], ""
    for line in text_lines(data[:end.start()]):
        words = line.split()
        if words[:1] == ["format"]:
            kind = words[1]
        elif words[:2] == ["comment", "TextureFile"]:
            textures.append(line.strip().split(None, 2)[2])
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"] and words[1] == "list":
            elements[-1][2].append((words[4], TYPES[words[3]], TYPES[words[2]]))
        elif words[:1] == ["property"]:
            elements[-1][2].append((SHORT_NAMES.get(words[2], words[2]), TYPES[words[1]], None))
    return kind, elements, textures, data[end.end():]


def ply_rows(kind, elements, body):
    """name: [{property: number or list}]"""
    words, at = body.split(), 0

    def take(letter):
        nonlocal at
        if kind == "ascii":
            word = words[at]
            at += 1
            return float(word) if letter in "fd" else int(float(word))
        order = "<" if kind == "binary_little_endian" else ">"
        value, = struct.unpack_from(order + letter, body, at)
        at += struct.calcsize(letter)
        return value

    rows = {}
    for name, count, properties in elements:
        rows[name] = [{p: take(t) if n is None else [take(t) for _ in range(take(n))] for p, t, n in properties}
                      for _ in range(count)]
    return rows


def ply_color(row, types):
    if not all(c in row for c in COLORS[:3]):
        return None
    whole = {"B": 255.0, "H": 65535.0}
    rgba = [row.get(c, whole.get(types.get("alpha", "f"), 1.0)) / whole.get(types.get(c, "f"), 1.0) for c in COLORS]
    if types["red"] == "B":  # eight bits are what a screen shows
        rgba[:3] = [to_linear(c) for c in rgba[:3]]
    return tuple(rgba)


def strip_triangles(strip):
    """-1 ends a strip; every other triangle of one is turned."""
    first = 0
    for i, index in enumerate(strip):
        if index < 0:
            first = i + 1
        elif i >= first + 2:
            a, b, c = strip[i - 2:i + 1]
            yield [b, a, c] if (i - first) % 2 else [a, b, c]


def read_ply(path):
    with open(path, "rb") as file:
        kind, elements, textures, body = ply_header(file.read())
    rows, model = ply_rows(kind, elements, body), Model()
    types = {name: {p: t for p, t, _ in properties} for name, _, properties in elements}
    model.unread |= set(types) - {"vertex", "face", "tristrips"}
    of_vertex, of_face = types["vertex"], types.get("face", {})
    uv_names = next((pair for pair in UV_NAMES if all(n in of_vertex for n in pair)), ())
    read = {"x", "y", "z", "nx", "ny", "nz", *uv_names} | (set(COLORS) if "red" in of_vertex else set())
    model.unread |= set(of_vertex) - read
    read = {"texcoord", "texnumber", *INDEX_NAMES} | (set(COLORS) if "red" in of_face else set())
    model.unread |= set(of_face) - read
    vertices = rows["vertex"]
    strips = [{"vertex_indices": t} for row in rows.get("tristrips", []) for t in strip_triangles(row["vertex_indices"])]
    for row in rows.get("face", []) + strips:
        corners = next(row[n] for n in INDEX_NAMES if n in row)
        at = [vertices[i] for i in corners]
        face = Face([(v["x"], v["y"], v["z"]) for v in at])
        wedge = row.get("texcoord", [])
        if len(wedge) == 2 * len(corners):
            face.uvs = list(zip(wedge[::2], wedge[1::2]))
        elif uv_names:
            face.uvs = [tuple(v[n] for n in uv_names) for v in at]
        if "nx" in of_vertex:
            face.normals = [(v["nx"], v["ny"], v["nz"]) for v in at]
        color = ply_color(row, of_face)
        face.colors = [color or ply_color(v, of_vertex) for v in at]
        if face.colors[:1] == [None]:
            face.colors = None
        if textures:
            face.material = textures[row.get("texnumber", 0)]
        model.faces.append(face)
    for name in textures:
        model.materials[name] = Material()
        model.materials[name].textures["map_kd"] = beside(path, name)
    model.by_texture = True
    return model


# MTL ------------------------------------------------------------------------------------------------------------------

MAPS = {"map_kd", "map_d", "norm", "bump", "map_bump", "map_ke", "map_pr", "map_pm"}
OPTION_WIDTHS = {"-s": 3, "-o": 3, "-t": 3, "-mm": 2, "-bm": 1, "-boost": 1, "-clamp": 1, "-blendu": 1, "-blendv": 1,
                 "-cc": 1, "-imfchan": 1, "-texres": 1, "-type": 1}


def is_number(word):
    return re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", word) is not None


def split_map(rest, options):
    """The file's name, behind its options, which are added to the set."""
    while rest.startswith("-"):
        option, _, rest = rest.partition(" ")
        options.add(option)
        for i in range(OPTION_WIDTHS.get(option, 0)):
            word, _, tail = rest.strip().partition(" ")
            if i > 0 and not is_number(word):  # the second and third number may be left out
                break
            rest = tail
        rest = rest.strip()
    return rest


def read_mtl(path, model):
    material, own = None, []
    with open(path, "rb") as file:
        lines = text_lines(file.read())
    for line in lines:
        line = line.strip(BLANKS)
        word, _, rest = line.replace("\t", " ").partition(" ")
        rest, key = rest.strip(BLANKS), word.lower()
        if not word or word.startswith("#"):
            continue
        if key == "newmtl":
            material = model.materials.setdefault(rest, Material())
            own.append(material)
        elif key == "kd":
            material.color = tuple(float(w) for w in (rest.split() * 3)[:3])
        elif key in ("d", "tr"):
            material.opacity[key] = float(rest.split()[-1])
        elif key in ("ke", "pr", "pm"):
            name = {"ke": "emissive", "pr": "roughness", "pm": "metallic"}[key]
            material.factors[name] = tuple(map(float, rest.split()))
        elif key in MAPS:
            material.textures[key] = beside(path, split_map(rest, material.options.setdefault(key, set())))
        else:
            model.unread.add(word)
    for material in own:
        given = material.opacity
        material.alpha = given["d"] if "d" in given else 1.0 - given.get("tr", 0.0)
        if material.alpha <= 0.0 and "d" not in given:  # nobody exports what cannot be seen
            material.alpha = 1.0
            model.unread.add("Tr")


# OBJ ------------------------------------------------------------------------------------------------------------------


def obj_lines(path):
    """Statements, continued lines joined."""
    with open(path, "rb") as file:
        waiting = ""
        for line in text_lines(file.read()):
            named = line.split()[:1] and line.split()[0] in ("g", "o", "usemtl", "mtllib")
            if line.endswith("\\") and not (named and line[-2] not in BLANKS):  # a folder of Windows
                waiting += line[:-1] + " "
                continue
            yield (waiting + line).strip(BLANKS)
            waiting = ""


def obj_libraries(path, rest):
    folder = os.path.dirname(path)
    whole = os.path.join(folder, rest.strip('"'))
    if os.path.exists(whole):
        return [whole]
    return [os.path.join(folder, a or b) for a, b in re.findall(r'"([^"]+)"|(\S+)', rest)]


def read_obj(path):
    model, v, vt, vn, colors = Model(), [], [], [], {}
    material, names, used = None, [], set()

    def pick(rows, text):
        """None where the index is left out, or names nothing."""
        i = int(text) if text else 0
        i = i - 1 if i > 0 else len(rows) + i if i < 0 else len(rows)
        return rows[i] if 0 <= i < len(rows) else None

    def together(values):
        return None if any(value is None for value in values) else values

    for line in obj_lines(path):
        line = line.partition("#")[0].strip(BLANKS)
        words = line.split()
        if not words:
            continue
        word, rest = words[0], line[len(words[0]):].strip(BLANKS)
        if word == "v":
            numbers = tuple(map(float, words[1:]))
            if len(numbers) >= 6:
                colors[len(v)] = tuple(min(max(c, 0.0), 1.0) for c in numbers[3:6]) + (1.0,)
            v.append((numbers[:3], len(v)))
        elif word == "vt":
            vt.append((tuple(map(float, words[1:])) + (0.0,))[:2])
        elif word == "vn":
            vn.append(tuple(map(float, words[1:4])))
        elif word == "f":
            parts = [(corner + "//").split("/")[:3] for corner in words[1:]]
            at = [pick(v, p[0]) for p in parts]
            face = Face([p for p, _ in at], material, together([pick(vt, p[1]) for p in parts]),
                        together([pick(vn, p[2]) for p in parts]))
            if colors:
                face.colors = [colors.get(i, (1.0, 1.0, 1.0, 1.0)) for _, i in at]
            model.faces.append(face)
            used.update(names)
        elif word == "usemtl":
            material = rest
        elif word == "mtllib":
            for library in obj_libraries(path, rest):
                if os.path.exists(library):
                    read_mtl(library, model)
                else:
                    model.unread.add(os.path.basename(library))
        elif word in ("o", "g"):
            names = [n for n in names if n[0] != word] + ([(word, rest)] if rest else [])
        else:
            model.unread.add(word)
    if all(face.normals is not None for face in model.faces):  # nothing that smoothing would change
        model.unread.discard("s")
    model.names = sorted({name for _, name in used})
    return model


# STL ------------------------------------------------------------------------------------------------------------------


def is_text_stl(data):
    if len(data) >= 84 and 84 + 50 * struct.unpack_from("<I", data, 80)[0] == len(data):
        return False
    start = re.match(rb"(?:\xef\xbb\xbf)?\s*solid", data, re.IGNORECASE)
    return start is not None and b"\0" not in data[:1024]


def read_stl(path):
    with open(path, "rb") as file:
        data = file.read()
    model = Model()
    if is_text_stl(data):
        corner = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
        points = [tuple(map(float, found)) for found in corner.findall(data)]
        model.faces = [Face(points[i:i + 3]) for i in range(0, len(points), 3)]
        return model
    magics = re.search(rb"COLOR=(....)", data[:80], re.DOTALL)
    whole = tuple(c / 255.0 for c in magics.group(1)[:3]) if magics else None
    model.unread |= {"alpha"} if magics and magics.group(1)[3] < 255 else set()
    model.unread |= {"MATERIAL"} if magics and b"MATERIAL=" in data[:80] else set()
    attributes = []
    for at in range(84, len(data) - 49, 50):
        numbers = struct.unpack_from("<12fH", data, at)
        model.faces.append(Face([numbers[3:6], numbers[6:9], numbers[9:12]]))
        attributes.append(numbers[12])
    five = [[(a >> shift & 31) / 31.0 for shift in (0, 5, 10)] for a in attributes]
    if magics:  # bit 15 alone, or all bits: the colour of the whole; else red is lowest
        rows = [whole if a in (0x8000, 0xFFFF) or not any(attributes) else tuple(rgb)
                for a, rgb in zip(attributes, five)]
    elif any(a >> 15 for a in attributes):  # VisCAM: bit 15: there is a colour; blue is lowest
        rows = [tuple(rgb[::-1]) if a >> 15 else (1.0, 1.0, 1.0) for a, rgb in zip(attributes, five)]
    else:
        rows = None
        if any(attributes):
            model.unread.add("attribute")
    for face, color in zip(model.faces, rows or []):
        face.colors = [tuple(map(to_linear, color)) + (1.0,)] * 3
    if (len(data) - 84) % 50 != 0:
        model.unread.add("bytes")
    return model


def read(path):
    return {".ply": read_ply, ".obj": read_obj, ".stl": read_stl}[os.path.splitext(path)[1].lower()](path)
