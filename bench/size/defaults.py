#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The earlier defaults (--codec none --aggregate never) and those of now, as the table of docs/log/size.md.

    bench/size/defaults.py build/release/meshlode build/release/libmeshlode.so MODELS DATA [name …]

Triangles are those of the cut at one pixel of error where the whole scene is framed in pictures of 720, 120 and 30 pixels in
height: one, six and 24 times as far away. Load time is that of opening the file and of all its pages, unpacked
(meshlode_load_page) or, of an asset that `repack --codec none` stored anew, viewed where they lie (meshlode_view_page), both
checked. Times are of the processor: a build's best of three, loading's best of nine."""
import ctypes
import os
import re
import subprocess
import sys
import tempfile
import time

SIZES = ["1280x720", "213x120", "53x30"]
MODELS = ["FlightHelmet/FlightHelmet.gltf", "bunny.glb"]
PAGE_BYTES = 128 << 10  # format::kMaxPageBytes


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def load_ms(library, path, viewed):
    error, count = ctypes.create_string_buffer(4096), ctypes.c_uint32()
    out, view = (ctypes.c_uint32 * (PAGE_BYTES // 4))(), ctypes.c_void_p()
    best = float("inf")
    for _ in range(9):
        start = time.thread_time()
        asset = ctypes.c_void_p()
        assert library.meshlode_open_file(path.encode(), ctypes.byref(asset), error) == 0, error.value
        library.meshlode_pages(asset, ctypes.byref(count))
        for page in range(count.value):
            if viewed:
                status = library.meshlode_view_page(asset, page, ctypes.byref(view), error)
            else:
                status = library.meshlode_load_page(asset, page, out, ctypes.c_size_t(PAGE_BYTES), error)
            assert status == 0, error.value
        best = min(best, time.thread_time() - start)
        library.meshlode_close(asset)
    return 1000.0 * best


def measure(program, library, scene, options, folder):
    asset, plain = os.path.join(folder, "a.lode"), os.path.join(folder, "plain.lode")
    seconds = []
    for _ in range(3):
        start = os.times()
        run(program, "build", scene, "-o", asset, "--quiet", *options)
        end = os.times()
        seconds.append(end.children_user + end.children_system - start.children_user - start.children_system)
    cuts = []
    for size in SIZES:
        told = run(program, "render", asset, "-o", os.path.join(folder, "a.png"), "--size", size, "--pixel-error", "1")
        cuts.append(int(re.search(r"(\d+) triangles", told).group(1)))
    run(program, "repack", "--quiet", asset, "-o", plain, "--codec", "none")
    return os.path.getsize(asset), cuts, min(seconds), load_ms(library, asset, False), load_ms(library, plain, True)


def main():
    program, path, models, data, names = *sys.argv[1:5], sys.argv[5:]
    library = ctypes.CDLL(os.path.abspath(path))
    library.meshlode_pages.restype = ctypes.c_void_p
    scenes = [os.path.join(data, file) for file in sorted(os.listdir(data)) if file.endswith(".glb")]
    scenes += [os.path.join(models, file) for file in MODELS]
    print("| scene | defaults | bytes | triangles at 720 px | 120 px | 30 px | build, processor s | load, ms | load by `repack --codec none`, ms |")
    print("| --- | --- " + "| ---: " * 7 + "|")
    for scene in scenes:
        name = os.path.splitext(os.path.basename(scene))[0]
        if names and name not in names:
            continue
        for title, options in (("before", ["--codec", "none", "--aggregate", "never"]), ("now", [])):
            with tempfile.TemporaryDirectory() as folder:
                size, cuts, seconds, stored, plain = measure(program, library, scene, options, folder)
            print(f"| {name} | {title} | {size:,} | " + " | ".join(f"{count:,}" for count in cuts) +
                  f" | {seconds:.2f} | {stored:.2f} | {plain:.2f} |", flush=True)


if __name__ == "__main__":
    main()
