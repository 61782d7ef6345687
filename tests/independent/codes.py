# SPDX-License-Identifier: GPL-3.0-or-later
"""Prefix codes, stored sections and LZ4 blocks (docs/reference/codecs.md, sections 1 and 2)."""

import struct

from rules import check

MAX_CODE_BITS = 10


def unfold(value):
    return value >> 1 if value & 1 == 0 else -(value >> 1) - 1


def make_code(lengths, place):
    """For every MAX_CODE_BITS bits that can follow: (symbol, length of its word). None where all lengths are 0."""
    check(all(length <= MAX_CODE_BITS for length in lengths), place, "a code word is too long")
    used = [symbol for symbol, length in enumerate(lengths) if length > 0]
    if not used:
        return None
    if len(used) == 1:
        check(lengths[used[0]] == 1, place, "a lone symbol has one bit")
        return [(used[0], 1)] * (1 << MAX_CODE_BITS)
    check(sum(1 << (MAX_CODE_BITS - lengths[s]) for s in used) == 1 << MAX_CODE_BITS, place, "is no complete code")
    table = [None] * (1 << MAX_CODE_BITS)
    word, before = 0, 0
    for length, symbol in sorted((lengths[s], s) for s in used):
        word <<= length - before
        before = length
        reversed_word = int(format(word, f"0{length}b")[::-1], 2)
        for rest in range(1 << (MAX_CODE_BITS - length)):
            table[reversed_word | rest << length] = (symbol, length)
        word += 1
    return table


class Stream:
    """Bit k is bit k mod 8 of byte k / 8."""

    def __init__(self, data, place):
        self.data, self.place, self.at = data, place, 0

    def peek(self, at, count):
        first = at // 8
        return int.from_bytes(self.data[first:first + 8], "little") >> at % 8 & ((1 << count) - 1)

    def take(self, count):
        value = self.peek(self.at, count)
        self.at += count
        check(self.at <= 8 * len(self.data), self.place, "a stream ends early")
        return value

    def symbol(self, code):
        if code is None:
            return 0
        symbol, length = code[self.peek(self.at, MAX_CODE_BITS)]
        self.take(length)
        return symbol

    def number(self, code):
        symbol = self.symbol(code)
        if symbol < 4:
            return symbol
        k = symbol // 4 + 1
        return (4 + symbol % 4) << (k - 2) | self.take(k - 2)


class Columns:
    """Columns, one after another."""

    def __init__(self, data, place):
        self.data, self.place, self.at = data, place, 0

    def bytes(self, count):
        check(self.at + count <= len(self.data), self.place, "a column ends early")
        self.at += count
        return self.data[self.at - count:self.at]

    def column(self, count):
        mode = self.bytes(1)[0]
        if mode == 0:
            return self.bytes(count)
        if mode == 1:
            return self.bytes(1) * count
        check(mode == 2, self.place, "a column's mode")
        first, symbols = self.bytes(1)[0], self.bytes(1)[0] + 1
        check(first + symbols <= 256, self.place, "more than 256 symbols")
        packed = self.bytes((symbols + 1) // 2)
        lengths = [0] * first + [packed[s // 2] >> s % 2 * 4 & 15 for s in range(symbols)]
        code = make_code(lengths, self.place)
        stream = Stream(self.bytes(struct.unpack("<I", self.bytes(4))[0]), self.place)
        return bytes(stream.symbol(code) for _ in range(count))

    def end(self):
        check(self.at == len(self.data), self.place, "bytes are left over")


def decode_section(data, record_bytes, decoded_bytes, place):
    """Codec 1 of a section."""
    check(0 < decoded_bytes < 256 * (len(data) + 1), place, "shrank beyond belief")
    columns = Columns(data, place)
    if record_bytes == 0:
        out = columns.column(decoded_bytes)
        columns.end()
        return out
    count = decoded_bytes // record_bytes
    out = bytearray(decoded_bytes)
    for c in range(record_bytes):
        out[c::record_bytes] = columns.column(count)
    columns.end()
    for lane in range(0, record_bytes, 2):
        value = 0
        for at in range(lane, decoded_bytes, record_bytes):
            value = value + unfold(out[at] | out[at + 1] << 8) & 0xFFFF
            out[at:at + 2] = struct.pack("<H", value)
    return bytes(out)


def decode_lz4(data, size, place):
    """One raw LZ4 block: tokens of literals and matches."""
    out, at = bytearray(), 0

    def byte():
        nonlocal at
        check(at < len(data), place, "an LZ4 block ends early")
        at += 1
        return data[at - 1]

    def length(nibble):
        total = nibble
        if nibble == 15:
            while True:
                more = byte()
                total += more
                if more != 255:
                    break
        return total

    while True:
        token = byte()
        literals = length(token >> 4)
        check(at + literals <= len(data), place, "an LZ4 block ends early")
        out += data[at:at + literals]
        at += literals
        if at == len(data):
            break
        offset = byte() | byte() << 8
        check(offset <= len(out), place, "an LZ4 match before the start")
        count = length(token & 15) + 4
        for _ in range(count):
            out.append(out[-offset] if offset else 0)  # the text leaves 0 to the page's checksum
        check(len(out) <= size, place, "an LZ4 block is too long")
    check(len(out) == size, place, "an LZ4 block has another size")
    return bytes(out)
