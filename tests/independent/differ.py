# SPDX-License-Identifier: GPL-3.0-or-later
"""differ.py CANONICAL_DUMP FILE STRIDE: do both readers draw the same line between what a file may say and what not?

One byte of the file is changed, every STRIDE bytes, in three ways, and all checksums are made true again, so that the
rules behind them decide. Both readers must then refuse the file, or both read the same integers from it. Where they differ
the text leaves something open, or one of the two does not follow it."""

import os
import struct
import subprocess
import sys
import tempfile

import lode
from xxh3 import xxh3_64


def reseal(data):
    """Makes checksums fit as far as the tables still make sense."""
    count, = struct.unpack_from("<I", data, 12)
    if 64 + 64 * count > len(data):
        return
    entries = {}
    for i in range(count):
        at = 64 + 64 * i
        entries[bytes(data[at:at + 4])] = at, *struct.unpack_from("<QQ", data, at + 16), data[at + 12]

    def sum_of(offset, size):
        return xxh3_64(data[offset:offset + size]) if offset + size <= len(data) else 0

    if b"PAGT" in entries and entries[b"PAGT"][3] == 0:  # a stored table is left alone, and with it its pages
        _, offset, size, _ = entries[b"PAGT"]
        for at in range(offset, min(offset + size, len(data)) - 63, 64):
            stored, length = struct.unpack_from("<QI", data, at)
            checksum = sum_of(stored, length)
            struct.pack_into("<Q", data, at + 48, checksum)
            if struct.unpack_from("<I", data, at + 16)[0] == 0:
                struct.pack_into("<Q", data, at + 56, checksum)
    for name, (at, offset, size, _) in entries.items():
        if name != b"PAGE":
            struct.pack_into("<Q", data, at + 40, sum_of(offset, size))
    end = 64 + 64 * count
    struct.pack_into("<Q", data, 56, xxh3_64(bytes(data[:56]) + bytes(8) + bytes(data[64:end])))


class Dump:
    """canonical_dump, asked for one file after the other. One that it ends at is neither read nor refused."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "-"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def read(self, path):
        """(exit code, text, what is wrong); the code is None where the program has ended."""
        try:
            self.process.stdin.write(path.encode() + b"\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            return None, b"", "the program has ended"
        lines = []
        for line in self.process.stdout:
            if line.startswith(b"= "):
                code, _, reason = line[2:].decode(errors="replace").strip().partition(" ")
                return int(code), b"".join(lines), reason
            lines.append(line)
        return None, b"", f"the program has ended: {self.process.wait()}"


def main(arguments):
    dump, path, stride = Dump(arguments[0]), arguments[1], int(arguments[2])
    with open(path, "rb") as file:
        original = file.read()
    counts = {"refused": 0, "read": 0}
    differences = 0
    with tempfile.TemporaryDirectory() as folder:
        changed = os.path.join(folder, "changed.lode")
        for at in range(0, len(original), stride):
            for change in (0x01, 0x80, 0xFF):
                data = bytearray(original)
                data[at] ^= change
                reseal(data)
                with open(changed, "wb") as file:
                    file.write(data)
                code, dumped, reason = dump.read(changed)
                status, text = lode.read(bytes(data), is_complete=False)
                theirs = "ended" if code is None else "read" if code == 0 else "refused"
                ours = "read" if status == 0 else "refused"
                if theirs == ours and (ours == "refused" or text.encode() == dumped):
                    counts[ours] += 1
                    continue
                differences += 1
                print(f"byte {at} ^ {change:#04x}: C++ {theirs} {reason}; Python {ours} {text if status else ''}".strip())
    print(f"{os.path.basename(path)}: {counts['refused']} refused by both, {counts['read']} read alike, {differences} differ")
    return 0 if differences == 0 and counts["refused"] > 0 and counts["read"] > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
