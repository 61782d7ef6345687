#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares two runs of bench_seeds: triangles at equal true deviation, before and after.

    bench_seeds SCENE... --json before.json     (of the code before)
    bench_seeds SCENE... --json after.json      (of the code after)
    bench/quality/compare_seeds.py before.json after.json

A partition is partly luck: any change of it moves a small mesh's cuts by some percent. So a mesh is compared by the mean
of its logarithms over all seeds and figures, and held against how much that mean varies from seed to seed.
"""
import argparse
import json
import math
import statistics
from collections import defaultdict


def by_mesh(path):
    """mesh -> seed -> figure -> logarithm of the triangles."""
    meshes = defaultdict(lambda: defaultdict(dict))
    for one in json.load(open(path))["cuts"]:
        if one["triangles"] > 0:
            meshes[f'{one["scene"]}/{one["mesh"]}'][one["seed"]][one["figure"], one["x"]] = math.log(one["triangles"])
    return meshes


def seed_means(seeds, figures):
    return [statistics.fmean(found[f] for f in figures) for found in seeds.values()]


def standard_error(values):
    return statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    options = parser.parse_args()
    before, after = by_mesh(options.before), by_mesh(options.after)
    ratios, errors = [], []
    print(f'{"mesh":40} {"after/before":>12} {"+-":>7} {"noise of one seed":>18}')
    for mesh in sorted(before.keys() & after.keys()):
        # Figures that every seed of both runs reached, or means would be of different things.
        figures = set.intersection(*(set(found) for seeds in (before[mesh], after[mesh]) for found in seeds.values()))
        if not figures:
            print(f"{mesh:40} {'no figure that all seeds reach':>12}")
            continue
        a, b = seed_means(before[mesh], figures), seed_means(after[mesh], figures)
        ratio, error = statistics.fmean(b) - statistics.fmean(a), math.hypot(standard_error(a), standard_error(b))
        ratios.append(ratio)
        errors.append(error)
        noise = statistics.stdev(a) if len(a) > 1 else float("nan")
        mark = "  beyond twice its error" if abs(ratio) > 2 * error else ""
        print(f"{mesh:40} {math.exp(ratio):12.4f} {error:7.2%} {noise:18.2%}{mark}")
    if ratios:
        overall = math.sqrt(sum(e * e for e in errors)) / len(errors)
        print(f'{"geometric mean":40} {math.exp(statistics.fmean(ratios)):12.4f} {overall:7.2%}')


if __name__ == "__main__":
    main()
