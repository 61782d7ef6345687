# SPDX-License-Identifier: GPL-3.0-or-later
"""XXH3-64 and XXH3-128 of xxHash 0.8 with seed 0 and the default secret, slow and plain, for the independent reader."""

import struct

MASK = (1 << 64) - 1
P32_1, P32_2, P32_3 = 0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D
P1, P2, P3 = 0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9
P4, P5 = 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5
MX1, MX2 = 0x165667919E3779F9, 0x9FB21C651E98DF25

SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671f"
    "cb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c"
    "3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8"
    "a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364"
    "eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e"
    "2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e")
assert len(SECRET) == 192


def u32(data, at):
    return struct.unpack_from("<I", data, at)[0]


def u64(data, at):
    return struct.unpack_from("<Q", data, at)[0]


def swap32(x):
    return int.from_bytes(x.to_bytes(4, "little"), "big")


def swap64(x):
    return int.from_bytes(x.to_bytes(8, "little"), "big")


def rotate(x, count, bits=64):
    return ((x << count) | (x >> (bits - count))) & ((1 << bits) - 1)


def fold(a, b):
    product = a * b
    return (product & MASK) ^ (product >> 64)


def avalanche(h):
    h ^= h >> 37
    h = h * MX1 & MASK
    return h ^ h >> 32


def avalanche64(h):
    h ^= h >> 33
    h = h * P2 & MASK
    h ^= h >> 29
    h = h * P3 & MASK
    return h ^ h >> 32


def mix16(data, at, secret):
    return fold(u64(data, at) ^ u64(SECRET, secret), u64(data, at + 8) ^ u64(SECRET, secret + 8))


def accumulate(data):
    """The eight lanes of an input of more than 240 bytes."""
    lanes = [P32_3, P1, P2, P3, P4, P32_2, P5, P32_1]
    keys = [struct.unpack_from("<8Q", SECRET, 8 * i) for i in range(16)]
    last_key = struct.unpack_from("<8Q", SECRET, 192 - 64 - 7)
    scramble_key = struct.unpack_from("<8Q", SECRET, 192 - 64)

    def stripe(at, key):
        values = struct.unpack_from("<8Q", data, at)
        for i in range(8):
            mixed = values[i] ^ key[i]
            lanes[i ^ 1] = (lanes[i ^ 1] + values[i]) & MASK
            lanes[i] = (lanes[i] + (mixed & 0xFFFFFFFF) * (mixed >> 32)) & MASK

    size = len(data)
    blocks = (size - 1) // 1024
    for block in range(blocks):
        for i in range(16):
            stripe(block * 1024 + i * 64, keys[i])
        for i in range(8):
            lanes[i] = (lanes[i] ^ lanes[i] >> 47 ^ scramble_key[i]) * P32_1 & MASK
    for i in range((size - 1 - blocks * 1024) // 64):
        stripe(blocks * 1024 + i * 64, keys[i])
    stripe(size - 64, last_key)
    return lanes


def merge(lanes, secret, start):
    for i in range(4):
        start += fold(lanes[2 * i] ^ u64(SECRET, secret + 16 * i), lanes[2 * i + 1] ^ u64(SECRET, secret + 16 * i + 8))
    return avalanche(start & MASK)


def xxh3_64(data):
    data = bytes(data)
    n = len(data)
    if n == 0:
        return avalanche64(u64(SECRET, 56) ^ u64(SECRET, 64))
    if n <= 3:
        combined = data[0] << 16 | data[n >> 1] << 24 | data[n - 1] | n << 8
        return avalanche64(combined ^ u32(SECRET, 0) ^ u32(SECRET, 4))
    if n <= 8:
        h = (u32(data, n - 4) + (u32(data, 0) << 32)) ^ u64(SECRET, 8) ^ u64(SECRET, 16)
        h ^= rotate(h, 49) ^ rotate(h, 24)
        h = h * MX2 & MASK
        h ^= (h >> 35) + n
        h = h * MX2 & MASK
        return h ^ h >> 28
    if n <= 16:
        low = u64(data, 0) ^ u64(SECRET, 24) ^ u64(SECRET, 32)
        high = u64(data, n - 8) ^ u64(SECRET, 40) ^ u64(SECRET, 48)
        return avalanche((n + swap64(low) + high + fold(low, high)) & MASK)
    if n <= 128:
        h = n * P1
        for i in range((n - 1) // 32, -1, -1):
            h += mix16(data, 16 * i, 32 * i) + mix16(data, n - 16 * (i + 1), 32 * i + 16)
        return avalanche(h & MASK)
    if n <= 240:
        h = n * P1
        for i in range(8):
            h += mix16(data, 16 * i, 16 * i)
        h = avalanche(h & MASK)
        for i in range(8, n // 16):
            h += mix16(data, 16 * i, 16 * (i - 8) + 3)
        h += mix16(data, n - 16, 136 - 17)
        return avalanche(h & MASK)
    return merge(accumulate(data), 11, n * P1 & MASK)


def xxh3_128(data):
    """(high << 64) | low."""
    data = bytes(data)
    n = len(data)
    if n == 0:
        low = avalanche64(u64(SECRET, 64) ^ u64(SECRET, 72))
        high = avalanche64(u64(SECRET, 80) ^ u64(SECRET, 88))
    elif n <= 3:
        combined = data[0] << 16 | data[n >> 1] << 24 | data[n - 1] | n << 8
        low = avalanche64(combined ^ u32(SECRET, 0) ^ u32(SECRET, 4))
        high = avalanche64(rotate(swap32(combined), 13, 32) ^ u32(SECRET, 8) ^ u32(SECRET, 12))
    elif n <= 8:
        keyed = (u32(data, 0) + (u32(data, n - 4) << 32)) ^ u64(SECRET, 16) ^ u64(SECRET, 24)
        product = keyed * (P1 + (n << 2))
        low, high = product & MASK, product >> 64
        high = (high + (low << 1)) & MASK
        low ^= high >> 3
        low ^= low >> 35
        low = low * MX2 & MASK
        low ^= low >> 28
        high = avalanche(high)
    elif n <= 16:
        first, last = u64(data, 0), u64(data, n - 8)
        product = (first ^ last ^ u64(SECRET, 32) ^ u64(SECRET, 40)) * P1
        low, high = product & MASK, product >> 64
        low = (low + ((n - 1) << 54)) & MASK
        last ^= u64(SECRET, 48) ^ u64(SECRET, 56)
        high = (high + last + (last & 0xFFFFFFFF) * (P32_2 - 1)) & MASK
        low ^= swap64(high)
        product = low * P2
        low, high = avalanche(product & MASK), avalanche(((product >> 64) + high * P2) & MASK)
    elif n <= 240:
        low, high = n * P1 & MASK, 0

        def mix32(a, b, secret):
            nonlocal low, high
            low = (low + mix16(data, a, secret)) & MASK
            low ^= (u64(data, b) + u64(data, b + 8)) & MASK
            high = (high + mix16(data, b, secret + 16)) & MASK
            high ^= (u64(data, a) + u64(data, a + 8)) & MASK

        if n <= 128:
            for i in range((n - 1) // 32, -1, -1):
                mix32(16 * i, n - 16 * (i + 1), 32 * i)
        else:
            for i in range(4):
                mix32(32 * i, 32 * i + 16, 32 * i)
            low, high = avalanche(low), avalanche(high)
            for i in range(4, n // 32):
                mix32(32 * i, 32 * i + 16, 3 + 32 * (i - 4))
            mix32(n - 16, n - 32, 136 - 17 - 16)
        low, high = avalanche((low + high) & MASK), -avalanche((low * P1 + high * P4 + n * P2) & MASK) & MASK
    else:
        lanes = accumulate(data)
        low = merge(lanes, 11, n * P1 & MASK)
        high = merge(lanes, 192 - 64 - 11, ~(n * P2) & MASK)
    return high << 64 | low


def canonical_128(data):
    """The 16 bytes as xxHash writes them: the high half first, each big-endian."""
    return xxh3_128(data).to_bytes(16, "big")
