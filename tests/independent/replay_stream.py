# SPDX-License-Identifier: GPL-3.0-or-later
"""Replays what `meshlode stream --log` says, with the pages as the Python reader finds them in the asset.

    python3 replay_stream.py MESHLODE SCENE.glb

Of each run: the pool is never exceeded, the link sends one page at a time at its speed, what arrives is drawn no earlier,
what was evicted is not drawn, the roots stay, and the bytes add up. Exit code 1 with the first finding."""

import json
import math
import os
import subprocess
import sys
import tempfile

from lode import Lode

TERMINAL = 1


def expect(holds, *words):
    if not holds:
        sys.exit("FAILED: " + " ".join(str(word) for word in words))


def replay(pages, roots, document, run):
    log, fps = run["log"], document["path"]["frames_per_second"]
    pool = run["pool_bytes"] if run["pool_bytes"] is not None else math.inf
    requests, arrival = log["requests"], {page: 0 for page in roots}
    used = sum(pages[page]["bytes"] for page in roots)
    expect(used <= pool, "the roots do not fit")
    at, free_us, loaded, loads, peak = 0, 0, 0, {}, used
    frames = document["path"]["frames"]
    expect(len(log["drawn_pages"]) == len(log["max_px"]) == len(log["missing_pages"]) == frames, "frames are missing")
    for frame in range(frames):
        now = frame * 1000000 // fps
        following = (frame + 1) * 1000000 // fps
        for page in log["drawn_pages"][frame]:
            expect(page in arrival, "frame", frame, "draws page", page, "which is not there")
            expect(arrival[page] <= now, "frame", frame, "draws page", page, "before it arrives")
        while at < len(requests) and requests[at]["sent_us"] < following:
            request, at = requests[at], at + 1
            page = request["page"]
            expect(request["sent_us"] >= max(now, free_us), "request", at, "is sent while the link is busy")
            for evicted in request.get("evicted", []):
                expect(evicted in arrival and arrival[evicted] <= now, "page", evicted, "is evicted and not there")
                expect(evicted not in roots, "page", evicted, "is evicted and a root")
                del arrival[evicted]
                used -= pages[evicted]["bytes"]
            expect(page not in arrival, "page", page, "is requested and there, or on its way")
            stored = pages[page]["stored_bytes"]
            free_us = request["sent_us"] + math.ceil(stored / run["megabytes_per_second"])
            expect(request["arrival_us"] == free_us + round(run["latency_ms"] * 1000), "page", page, "arrives at",
                   request["arrival_us"], "and not at", free_us, "and the latency")
            arrival[page] = request["arrival_us"]
            used += pages[page]["bytes"]
            peak = max(peak, used)
            expect(used <= pool, "the pool holds", used, "bytes")
            loaded += stored
            loads[page] = loads.get(page, 0) + 1
    expect(at == len(requests), "requests are sent after the last frame")
    expect(loaded == run["load"]["bytes"] and at == run["load"]["requests"], "loaded bytes do not add up")
    expect(at - len(loads) == run["load"]["reloads"], "reloads do not add up")
    expect(peak == run["load"]["peak_pool_bytes"], "the pool's peak is", peak)
    return at


def main():
    meshlode, scene = sys.argv[1:3]
    requests = runs = evictions = 0
    with tempfile.TemporaryDirectory() as folder:
        asset = os.path.join(folder, "a.lode")
        subprocess.run([meshlode, "build", "--quiet", scene, "-o", asset, "--preset", "fast", "--page-size", "16"],
                       check=True)
        with open(asset, "rb") as file:
            tables = Lode(file.read()).tables
        pages = tables["PAGT"]
        roots = {group["page"] for group in tables["GRUP"] if group["flags"] & TERMINAL}
        for path in ("fly", "teleport", "turn"):
            text = subprocess.run([meshlode, "stream", asset, "--builtin", path, "--pool", "all,1/2,1/4", "--bandwidth",
                                   "0.5,20", "--latency", "0.5,30", "--format", "json", "--log"],
                                  check=True, stdout=subprocess.PIPE).stdout
            document = json.loads(text)
            expect([(page["bytes"], page["stored_bytes"]) for page in pages] ==
                   [(page["bytes"], page["stored_bytes"]) for page in document["pages"]], "pages differ")
            for run in document["runs"]:
                expect(run["fits"], "the roots fit a quarter")
                requests += replay(pages, roots, document, run)
                evictions += sum(len(request.get("evicted", [])) for request in run["log"]["requests"])
                runs += 1
    expect(evictions > 0, "nothing was evicted: the pools were too large to try it")
    print(f"{runs} runs, {requests} requests, {evictions} evictions replayed")


main()
