#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The floors of src/ and who includes whom, as a table with the number of #include lines.

  tools/include_graph.py             prints the table
  tools/include_graph.py --rooms     prints the arrows between rooms as text, most first; exits 1 where rooms of a floor,
                                     and files that lie in the floor itself, include each other in a circle
  tools/include_graph.py --write     rewrites the block between the markers in docs/explanation/architecture.md
  tools/include_graph.py --check     exits 1 where that block is not the table

Python's standard library alone. What is allowed is another question: cmake/layers.txt, held by tests/house.
"""
import collections
import pathlib
import re
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
DOCUMENT = REPOSITORY / "docs/explanation/architecture.md"
BEGIN = "<!-- include graph: written by tools/include_graph.py --write -->"
END = "<!-- end of the include graph -->"
SOURCES = {".h", ".cpp", ".c", ".inl", ".glsl", ".comp", ".vert", ".frag", ".mesh"}
ROOTS = ("src", "tools/meshlode")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.MULTILINE)


def room_of(path):
    """`floor/room` of a file below src/, `floor` of a file of the floor itself, `cli` of tools/meshlode."""
    parts = path.parts
    if parts[0] == "tools":
        return "cli"
    return parts[1] if len(parts) == 3 else f"{parts[1]}/{parts[2]}"


def box_of(path):
    """As room_of(), but `floor/name` of a file of the floor itself, with its header."""
    room = room_of(path)
    return room if "/" in room or room == "cli" else f"{room}/{path.name.split('.')[0]}"


def read_arrows(room_of=room_of):
    """(including room, included room) -> #include lines, for rooms that differ."""
    arrows = collections.Counter()
    for root in ROOTS:
        for file in sorted((REPOSITORY / root).rglob("*")):
            if file.suffix not in SOURCES:
                continue
            room = room_of(file.relative_to(REPOSITORY))
            for target in INCLUDE.findall(file.read_text(encoding="utf-8")):
                included = pathlib.Path("src") / target
                if "/" in target and (REPOSITORY / included).is_file() and room_of(included) != room:
                    arrows[room, room_of(included)] += 1
    return arrows


def circle_of(arrows):
    """The boxes of one floor that are left when those without an arrow inside the floor are taken away, again and again."""
    inside = {(source, target) for source, target in arrows if source.split("/")[0] == target.split("/")[0]}
    while True:
        ends = {target for _, target in inside} - {source for source, _ in inside}
        starts = {source for source, _ in inside} - {target for _, target in inside}
        kept = {(source, target) for source, target in inside if target not in ends and source not in starts}
        if kept == inside:
            return sorted({box for arrow in inside for box in arrow})
        inside = kept


def floors_of(arrows):
    floors = collections.Counter()
    for (source, target), count in arrows.items():
        if source.split("/")[0] != target.split("/")[0]:
            floors[source.split("/")[0], target.split("/")[0]] += count
    return floors


def order(floors):
    """Every floor that occurs, each behind those that it includes; equals by name."""
    below = collections.defaultdict(set)
    for source, target in floors:
        below[source].add(target)
        below.setdefault(target, set())
    done = []
    while len(done) < len(below):
        ready = sorted(floor for floor in below if floor not in done and below[floor] <= set(done))
        if not ready:
            sys.exit("include_graph.py: the floors include each other in a circle: "
                     + ", ".join(sorted(set(below) - set(done))))
        done += ready
    return done


def table(floors):
    """A line for each floor, those that include nobody first: what it includes, with the number of #include lines."""
    rank = {floor: i for i, floor in enumerate(order(floors))}
    lines = ["| floor | includes |", "| --- | --- |"]
    for source in rank:
        below = sorted((target for s, target in floors if s == source), key=rank.get)
        lines.append(f"| `{source}` | " + (", ".join(f"{t} {floors[source, t]}" for t in below) or "nothing") + " |")
    return "\n".join(lines)


def split_document():
    """What stands before, between and behind the markers."""
    text = DOCUMENT.read_text(encoding="utf-8")
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        sys.exit(f"include_graph.py: {DOCUMENT} needs each marker once: {BEGIN} and {END}")
    before, rest = text.split(BEGIN)
    between, behind = rest.split(END)
    return before, between, behind


def main(arguments):
    if arguments not in ([], ["--rooms"], ["--write"], ["--check"]):
        sys.exit(__doc__)
    arrows = read_arrows()
    if arguments == ["--rooms"]:
        for (source, target), count in sorted(arrows.items(), key=lambda item: (-item[1], item[0])):
            print(f"{count:4}  {source} -> {target}")
        circle = circle_of(read_arrows(box_of))
        if circle:
            print("include_graph.py: rooms include each other in a circle: " + ", ".join(circle), file=sys.stderr)
        return 1 if circle else 0
    graph = table(floors_of(arrows))
    if not arguments:
        print(graph)
        return 0
    before, between, behind = split_document()
    block = f"\n\n{graph}\n\n"
    if arguments == ["--check"]:
        if between == block:
            return 0
        print("docs/explanation/architecture.md: the include graph is stale; run tools/include_graph.py --write", file=sys.stderr)
        return 1
    DOCUMENT.write_text(before + BEGIN + block + END + behind, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
