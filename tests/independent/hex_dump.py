# SPDX-License-Identifier: GPL-3.0-or-later
"""hex_dump.py FORMAT_MD FILE: is every line of the worked dump in docs/reference/format.md what the built file has at that place?"""

import re
import sys


def main(text_path, file_path):
    with open(file_path, "rb") as file:
        data = file.read()
    lines = wrong = 0
    with open(text_path, encoding="utf-8") as file:
        for line in file:
            found = re.match(r"([0-9A-F]{6})  ((?:[0-9A-F]{2} )+) *(.*)$", line)
            if not found:
                continue
            lines += 1
            at, told = int(found.group(1), 16), bytes.fromhex(found.group(2))
            if data[at:at + len(told)] != told:
                wrong += 1
                print(f"{found.group(1)} {found.group(3)}: the file has {data[at:at + len(told)].hex(' ')}")
    print(f"{lines} lines, {wrong} wrong")
    return 0 if lines > 50 and wrong == 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
