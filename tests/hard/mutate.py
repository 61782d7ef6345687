#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Would the tests of the numerics notice? Small seeded changes of the source, each judged by `ctest -L numerics`.

    cmake --preset release -DMESHLODE_TESTS=ON && ninja -C build/release
    tests/hard/mutate.py --count 150 --seed 1 --jobs 2        # run again, it goes on; --list shows what would be tried

A mutant is one change of one line in a room that decides numbers (ROOMS): an operator, a comparison, a constant off by a factor, a
float for a double, a minimum for a maximum, a truncation for a floor, an epsilon where 0 stood, a statement or a rounding up left
out. It is compiled (at -O1, into a folder of its own below --out) with all objects that see the changed file, linked in front of
the build's libraries into the programs that `ctest -L numerics` runs, those of its own room first, and is killed by the first
that fails or takes more than --limit seconds. What does not compile, and what compiles to the same object code as the source,
is counted apart and is no part of the rate. Draws are even over the rooms; the same seed draws the same mutants of the same
source. Nothing in the tree is changed.

Elsewhere, on a machine with more processors and the same compiler: `--describe build.json` writes down what the finished build says
of itself; with `--build build.json` neither ninja nor ctest is asked any more, and of the tree only the sources of ROOMS, the objects
and libraries that the programs are linked of, and the headers that those objects include are read. `--seconds` starts no mutant later.
"""
import argparse
import hashlib
import json
import os
import random
import re
import shlex
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Room: its files, and the program that is asked first.
ROOMS = {
    "prepare": (["src/builder/prepare/*.cpp"], "prepare_test"),
    "simplify": (["src/builder/simplify/quadric.h", "src/builder/simplify/attribute_quadrics.h", "src/builder/simplify/placement.h",
                  "src/builder/simplify/surface_quadrics.h", "src/builder/simplify/attribute_scales.cpp",
                  "src/builder/simplify/point_triangle.h", "src/builder/simplify/guards.cpp", "src/builder/simplify/left_behind.cpp",
                  "src/builder/simplify/painted_guard.h", "src/builder/simplify/collapse_costs.h",
                  "src/builder/simplify/new_surface.cpp", "src/builder/simplify/edge_heap.h",
                  "src/builder/simplify/group_places.*", "src/builder/simplify/pieces.cpp"], "simplify_test"),
    "deviation": (["src/builder/deviation/*.cpp", "src/builder/deviation/cover.h", "src/builder/deviation/four_triangles.h",
                   "src/builder/deviation/open_boxes.h", "src/builder/deviation/point_distance.h"], "deviation_test"),
    "measure": (["src/builder/measure/*.cpp", "src/builder/measure/*.h"], "measure_test"),
    "promise": (["src/builder/promise/*.cpp", "src/builder/promise/*.h"], "promise_test"),
    "hierarchy": (["src/builder/hierarchy/*.cpp", "src/builder/hierarchy/margins.h"], "hierarchy_test"),
    "encode": (["src/builder/encode/encode.cpp", "src/builder/encode/fits.cpp", "src/builder/encode/quantize_normal.cpp",
                "src/builder/encode/uv_grid.cpp"], "encode_test"),
    "select": (["src/run/select/*.cpp", "src/run/select/metric.h", "src/run/read/nesting.h"], "select_test"),
}

NUMBER = r"(?<![\w.])(\d+\.\d+(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+|0x[0-9a-fA-F]+p[-+]\d+)(F?)(?![\w.])"


def scaled(factor):
    return lambda m: f"({m[0]} * {factor}{'F' if m[2] else ''})"


# Name, what is changed, what it becomes. Spaces tell an operator from a pointer, a template or a sign.
OPERATORS = [
    ("+ to -", r" \+ ", " - "), ("- to +", r" - ", " + "), ("* to /", r" \* ", " / "), ("/ to *", r" / ", " * "),
    ("< to <=", r" < ", " <= "), ("<= to <", r" <= ", " < "), ("> to >=", r" > ", " >= "), (">= to >", r" >= ", " > "),
    ("< to >", r" < ", " > "), ("> to <", r" > ", " < "), ("== to !=", r" == ", " != "),
    ("&& to ||", r" && ", " || "), ("|| to &&", r" \|\| ", " && "),
    ("max to min", r"(?:std|glm)::max\b", lambda m: m[0].replace("max", "min")),
    ("min to max", r"(?:std|glm)::min\b", lambda m: m[0].replace("min", "max")),
    ("float for double", r"\bdouble\b", "float"),
    ("constant doubled", NUMBER, scaled("2.0")), ("constant halved", NUMBER, scaled("0.5")),
    ("epsilon for 0", r"([<>]=?) 0\.0(?![\w.])", lambda m: f"{m[1]} 1e-9"),
    ("trunc for floor", r"std::floor\(", "std::trunc("), ("floor for ceil", r"std::ceil\(", "std::floor("),
    ("abs dropped", r"std::f?abs\(", "("), ("sqrt dropped", r"std::sqrt\(", "("),
    ("rounding up dropped", r"\bfloat_above\(", "static_cast<float>("),
    ("negation dropped", r"if \(!", "if ("),
    ("statement dropped", r"^( +)[\w.\[\]>-]+ (?:[-+*/|&]=|= std::(?:max|min)\().*;$", lambda m: f"{m[1]};"),
    ("return turned", r"\breturn (true|false);", lambda m: f"return {'false' if m[1] == 'true' else 'true'};"),
]


def blank(match):
    return re.sub(r"[^\n]", " ", match[0])


def code_of(text):
    """Comments, strings and includes as blanks, so that places stay."""
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:[^"\\\n]|\\.)*"', blank, text, flags=re.S)
    return re.sub(r"^#[^\n]*$", blank, text, flags=re.M)


def mutants_of(path):
    """Every change of the file: line, operator, and the new line."""
    text = path.read_text()
    found = []
    seen = {}
    for number, (line, code) in enumerate(zip(text.splitlines(), code_of(text).splitlines())):
        # An id is of the line's words and not of its number, which any edit above it would change.
        occurrence = seen[line] = seen.get(line, -1) + 1
        if "static_assert" in code or re.match(r" *(template|for \()", code):  # how far a loop runs is no number's matter
            continue
        for name, pattern, becomes in OPERATORS:
            for match in re.finditer(pattern, code):
                new = match.expand(becomes) if isinstance(becomes, str) else becomes(match)
                changed = line[:match.start()] + new + line[match.end():]
                if changed == line:
                    continue
                file = str(path.relative_to(ROOT))
                key = f"{file}\n{occurrence}\n{match.start()}\n{name}\n{line}"
                found.append({"id": hashlib.sha256(key.encode()).hexdigest()[:12], "file": file, "line": number + 1, "operator": name,
                              "before": line.strip(), "after": changed.strip(), "text": changed})
    return found


def files_of(pattern):
    files = list(ROOT.glob(pattern))
    if not files:
        sys.exit(f"no file is {pattern}: ROOMS is of an older tree")
    return files


def draw(count, seed, seen=()):
    """Round by round one of each room; within a room any operator, then any place, as likely as another. None of `seen`."""
    source = random.Random(seed)
    pools = {}
    for room, (patterns, _) in ROOMS.items():
        files = sorted({path for pattern in patterns for path in files_of(pattern)})
        by_operator = {}
        for path in files:
            for mutant in mutants_of(path):
                if mutant["id"] in seen:
                    continue
                by_operator.setdefault(mutant["operator"], []).append({**mutant, "room": room})
        for one in by_operator.values():
            source.shuffle(one)
        pools[room] = by_operator
    drawn = []
    while len(drawn) < count and any(pools.values()):
        for room in ROOMS:
            by_operator = pools[room]
            if not by_operator or len(drawn) == count:
                continue
            name = source.choice(sorted(by_operator))
            drawn.append(by_operator[name].pop())
            if not by_operator[name]:
                del by_operator[name]
    return drawn


class Build:
    """What a finished build says of itself: how each object is made, what it depends on, how a program is linked."""

    def __init__(self, folder):
        self.folder = folder
        if folder.suffix == ".json":
            described = json.loads(folder.read_text())
            self.folder = Path(described["folder"])
            self.objects_of = {path: set(objects) for path, objects in described["objects_of"].items()}
            self.command_of = described["command_of"]
            self.programs = {name: {**one, "objects": set(one["objects"]), "members": set(one["members"])}
                             for name, one in described["programs"].items()}
            return
        said = subprocess.run(["ninja", "-C", folder, "-t", "deps"], check=True, capture_output=True, text=True).stdout
        self.objects_of = {}
        for block in said.split("\n\n"):
            lines = block.splitlines()
            if not lines or ": #deps" not in lines[0]:
                continue
            for line in lines[1:]:
                path = os.path.normpath(folder / line.strip())
                self.objects_of.setdefault(path, set()).add(lines[0].split(":")[0])
        commands = json.loads(subprocess.run(["ninja", "-C", folder, "-t", "compdb"], check=True, capture_output=True,
                                             text=True).stdout)
        self.command_of = {one["output"]: one["command"] for one in commands}
        listed = subprocess.run(["ctest", "--test-dir", folder, "-L", "numerics", "--show-only=json-v1"], check=True,
                                capture_output=True, text=True).stdout
        programs = {test["command"][0] for test in json.loads(listed)["tests"] if test.get("command")}
        self.programs = {Path(program).name: self.link_of(Path(program)) for program in sorted(programs)}

    def describe(self):
        """As JSON, of what the mutants of ROOMS need alone."""
        sources = {str(path) for patterns, _ in ROOMS.values() for pattern in patterns for path in files_of(pattern)}
        linked = set().union(*(one["objects"] | one["members"] for one in self.programs.values()))
        objects_of = {path: sorted(self.objects_of.get(path, set()) & linked) for path in sorted(sources)}
        compiled = sorted(set().union(*objects_of.values()))
        programs = {name: {**one, "objects": sorted(one["objects"]), "members": sorted(one["members"])}
                    for name, one in self.programs.items()}
        includes = sorted(path for path, objects in self.objects_of.items() if objects & set(compiled))
        return {"folder": str(self.folder), "objects_of": objects_of, "command_of": {one: self.command_of[one] for one in compiled},
                "programs": programs, "includes": includes}

    def link_of(self, program):
        """Objects, libraries' members, and the command: ninja's last step for the program, without what runs after it."""
        target = str(program.relative_to(self.folder))
        said = subprocess.run(["ninja", "-C", self.folder, "-t", "commands", "-s", target], check=True, capture_output=True, text=True)
        command = next(part for part in said.stdout.strip().split(" && ") if f" -o {target}" in part)
        words = shlex.split(command)
        objects = {word for word in words if word.endswith(".o")}
        members = set()
        for word in words:
            if word.endswith(".a") and not os.path.isabs(word):
                members |= {one for one in shlex.split(self.command_of[word]) if one.endswith(".o")}
        # Of the libraries only what the linker takes: it names each member, without its folder.
        traced = subprocess.run([*words[:words.index("-o")], "-o", "/dev/null", "-Wl,-M", *words[words.index("-o") + 2:]], check=True,
                                cwd=self.folder, capture_output=True, text=True).stdout
        taken = set(re.findall(r"^\S+\.a\((\S+\.o)\)", traced, flags=re.M))
        members = {member for member in members if Path(member).name in taken}
        return {"target": target, "words": words, "objects": objects, "members": members}

    def compile(self, output, source, before, after, to):
        """`output` again, with the file `before` replaced by `after`; headers are found in `after`'s tree first."""
        words = shlex.split(self.command_of[output])
        words = words[1:] if Path(words[0]).name == "ccache" else words
        words = ["-O1" if word == "-O3" else word for word in words if not word.startswith("-W")]
        overlay = str(after)[:-len(str(before))].rstrip("/")
        for flag in ("-o", "-MF"):
            words[words.index(flag) + 1] = str(to) if flag == "-o" else f"{to}.d"
        at = words.index("-c") + 1
        if os.path.normpath(self.folder / words[at]) == str(source):
            words[at] = str(after)
        words[1:1] = ["-w", f"-I{overlay}/src"]
        return subprocess.run(words, cwd=self.folder, capture_output=True, text=True)


def judge(build, mutant, out, limit, most_objects, is_quick):
    """killed by a program, survived, open (survived its own room's program alone), equivalent (the same object code), refused
    (does not compile), or too wide."""
    folder = out / mutant["id"]
    source = ROOT / mutant["file"]
    lines = source.read_text().split("\n")
    lines[mutant["line"] - 1] = mutant["text"]
    changed = folder / mutant["file"]
    changed.parent.mkdir(parents=True, exist_ok=True)
    changed.write_text("\n".join(lines))
    seen = build.objects_of.get(str(source), set())
    first = ROOMS[mutant["room"]][1]
    order = sorted(build.programs, key=lambda name: (name != first, name != "numerics_test", name))
    made = {}
    for name in order[:1] if is_quick else order:
        program = build.programs[name]
        needed = sorted(seen & (program["objects"] | program["members"]))
        if not needed:
            continue
        if len(needed) > most_objects:
            return "too wide", f"{len(needed)} objects"
        for output in needed:
            if output in made:
                continue
            to = folder / (hashlib.sha256(output.encode()).hexdigest()[:16] + ".o")
            result = build.compile(output, source, mutant["file"], changed, to)
            if result.returncode != 0:
                return "refused", next((line for line in result.stderr.splitlines() if "error" in line), "")[-160:]
            made[output] = to
        words = list(program["words"])
        replaced = [str(made[output]) for output in needed]
        words = [word for word in words if word not in needed]
        words[words.index("-o") + 1] = str(folder / name)
        words[1:1] = replaced
        linked = subprocess.run(words, cwd=build.folder, capture_output=True, text=True)
        if linked.returncode != 0:
            return "refused", linked.stderr[-160:]
        try:
            run = subprocess.run([folder / name, "--gtest_fail_fast", "--gtest_brief=1"], cwd=folder, capture_output=True, text=True,
                                 timeout=limit, errors="replace")
        except subprocess.TimeoutExpired:
            return "killed", f"{name}: more than {limit} s"
        (folder / name).unlink()
        if run.returncode != 0:
            case = re.search(r"\[  FAILED  \] (\S+)", run.stdout)
            return "killed", f"{name}: {case[1].rstrip(',') if case else f'exit code {run.returncode}'}"
    if not made:
        return "survived", "no program has it"
    plain = folder / "plain.o"
    for output, to in made.items():
        build.compile(output, source, mutant["file"], source, plain)
        if plain.read_bytes() != to.read_bytes():
            break
    else:
        return "equivalent", "the same object code"
    return ("open" if is_quick else "survived"), ""


def report(drawn, results, explained):
    rows = ["| room | mutants | killed | survived | rate | same object code | equivalent, explained | did not compile | too wide, or in no program |",
            "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    unseen = {m["id"] for m in drawn if results.get(m["id"]) == ("survived", "no program has it")}
    for room in [*ROOMS, None]:
        mine = [m for m in drawn if room in (m["room"], None) and m["id"] in results]

        def count(*verdicts):
            return sum(results[m["id"]][0] in verdicts and m["id"] not in unseen for m in mine)
        why = sum(results[m["id"]][0] in ("survived", "open") and m["id"] in explained for m in mine if m["id"] not in unseen)
        killed, survived = count("killed"), count("survived", "open") - why
        apart = [count("equivalent"), why, count("refused"), count("too wide") + sum(m["id"] in unseen for m in mine)]
        assert killed + survived + sum(apart) == len(mine)
        judged = killed + survived
        rate = f"{100 * killed / judged:.0f}%" if judged else "–"
        rows.append(f"| {room or 'all'} | {judged} | {killed} | {survived} | {rate} | {' | '.join(map(str, apart))} |")
    by_time = sum(results.get(m["id"], ("", ""))[0] == "killed" and ": more than " in results[m["id"]][1] for m in drawn)
    rows.append(f"\n{len([m for m in drawn if m['id'] in results])} of {len(drawn)} drawn; of those killed, {by_time} by time alone.")
    for m in drawn:
        if results.get(m["id"], ("",))[0] in ("survived", "open"):
            why = ": " + explained[m["id"]] if m["id"] in explained else ""
            rows.append(f"\n{m['id']} {m['file']}:{m['line']} ({m['operator']}){why}"
                        f"\n  - {m['before']}\n  + {m['after']}")
    return "\n".join(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release",
                        help="a finished build with tests, or what --describe wrote of one; nothing in it is changed")
    parser.add_argument("--describe", default="", metavar="FILE", help="write down what --build says of itself, and try nothing")
    parser.add_argument("--out", default="build/mutants", help="folder of mutants and of what was found: it goes on where it was")
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--unseen", default="", metavar="FILES",
                        help="results.jsonl of earlier draws, comma by comma: none of their mutants is drawn")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--limit", type=int, default=60, help="seconds that a program may take")
    parser.add_argument("--seconds", type=float, default=float("inf"),
                        help="start no mutant later than that; run again, it goes on")
    parser.add_argument("--most-objects", type=int, default=12, help="of a header that more objects see no mutant is built")
    parser.add_argument("--quick", action="store_true",
                        help="ask the room's own program alone; what survives it is open, and judged by all the next time")
    parser.add_argument("--only", default="", help="ids, comma by comma, judged again")
    parser.add_argument("--explained", default=str(ROOT / "tests" / "hard" / "equivalent_mutants.txt"),
                        help="a line each: id, a space, why no test can tell it from the source")
    parser.add_argument("--list", action="store_true", help="show the mutants that would be tried")
    parser.add_argument("--report", action="store_true", help="show what was found so far, and try nothing")
    options = parser.parse_args()
    started = time.monotonic()
    if options.describe:
        Path(options.describe).write_text(json.dumps(Build((ROOT / options.build).resolve()).describe(), indent=1) + "\n")
        return 0
    seen = {json.loads(line)["id"] for file in filter(None, options.unseen.split(",")) for line in Path(file).read_text().splitlines()}
    drawn = draw(options.count, options.seed, seen)
    if options.list:
        for m in drawn:
            print(f"{m['id']} {m['file']}:{m['line']} ({m['operator']})\n  - {m['before']}\n  + {m['after']}")
        return 0
    out = ROOT / options.out
    out.mkdir(parents=True, exist_ok=True)
    kept = out / "results.jsonl"
    results = {}
    if kept.exists():
        for line in kept.read_text().splitlines():
            one = json.loads(line)
            results[one["id"]] = (one["verdict"], one["by"])
    explained = {}
    if Path(options.explained).exists():
        for line in Path(options.explained).read_text().splitlines():
            if line and not line.startswith("#"):
                explained[line.split(" ", 1)[0]] = line.split(" ", 1)[1]
    again = set(filter(None, options.only.split(",")))
    wanted = ("open",) if not options.quick else ()
    todo = [m for m in drawn if (m["id"] in again if again else m["id"] not in results or results[m["id"]][0] in wanted)]
    if not options.report and todo:
        build = Build((ROOT / options.build).resolve())
        for name, program in build.programs.items() if not results else ():
            if subprocess.run([build.folder / program["target"], "--gtest_brief=1"], capture_output=True).returncode != 0:
                sys.exit(f"{name} fails without a mutant")

        def one(mutant):
            if time.monotonic() - started > options.seconds:
                return
            verdict, by = judge(build, mutant, out, options.limit, options.most_objects, options.quick)
            subprocess.run(["rm", "-rf", out / mutant["id"]], check=True)
            with kept.open("a") as file:
                file.write(json.dumps({"id": mutant["id"], "verdict": verdict, "by": by}) + "\n")
            results[mutant["id"]] = (verdict, by)
            print(f"{len(results)}: {mutant['file']}:{mutant['line']} ({mutant['operator']}): {verdict} {by}", file=sys.stderr, flush=True)
        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(one, todo))
    print(report(drawn, results, explained))
    survived = sum(results.get(m["id"], ("",))[0] in ("survived", "open") and m["id"] not in explained for m in drawn)
    killed = sum(results.get(m["id"], ("",))[0] == "killed" for m in drawn)
    return 0 if killed >= 9 * survived else 1


if __name__ == "__main__":
    sys.exit(main())
