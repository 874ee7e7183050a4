"""XXH3 with 64 and 128 bits, as https://github.com/Cyan4973/xxHash/blob/dev/doc/xxhash_spec.md says, in plain Python.

Slow (some 20 MB/s) and without dependencies: it is here so that a store can be read by nothing but the standard
library. hash64(b"") = 2d06800538d394c2, hash128(b"") = 99aa06d3014798d86001c324468d497f.
"""

import struct

MASK = (1 << 64) - 1
P32 = (0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
P64 = (0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5)
MIX_1, MIX_2 = 0x165667919E3779F9, 0x9FB21C651E98DF25

SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671f"
    "cb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c"
    "3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8"
    "a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364"
    "eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e"
    "2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e")


def u32(data, at=0):
    return int.from_bytes(data[at:at + 4], "little")


def u64(data, at=0):
    return int.from_bytes(data[at:at + 8], "little")


def swap32(x):
    return int.from_bytes(x.to_bytes(4, "little"), "big")


def swap64(x):
    return int.from_bytes(x.to_bytes(8, "little"), "big")


def rotl64(x, n):
    return (x << n | x >> (64 - n)) & MASK


def fold(a, b):
    product = a * b
    return (product ^ product >> 64) & MASK


def avalanche(h):
    h ^= h >> 37
    h = h * MIX_1 & MASK
    return h ^ h >> 32


def avalanche_xxh64(h):
    h ^= h >> 33
    h = h * P64[1] & MASK
    h ^= h >> 29
    h = h * P64[2] & MASK
    return h ^ h >> 32


def mix16(data, at, secret_at, seed):
    return fold(u64(data, at) ^ (u64(SECRET, secret_at) + seed & MASK),
                u64(data, at + 8) ^ (u64(SECRET, secret_at + 8) - seed & MASK))


def seeded_secret(seed):
    if seed == 0:
        return SECRET
    parts = []
    for at in range(0, len(SECRET), 16):
        parts.append((u64(SECRET, at) + seed & MASK).to_bytes(8, "little"))
        parts.append((u64(SECRET, at + 8) - seed & MASK).to_bytes(8, "little"))
    return b"".join(parts)


def accumulate(acc, data, at, key, key_at):
    """One stripe of 64 bytes."""
    words = struct.unpack_from("<8Q", data, at)
    secret = struct.unpack_from("<8Q", key, key_at)
    for i in range(8):
        word = words[i]
        mixed = word ^ secret[i]
        acc[i ^ 1] += word
        acc[i] += (mixed & 0xFFFFFFFF) * (mixed >> 32)
    for i in range(8):
        acc[i] &= MASK


def long_accumulators(data, key):
    acc = [P32[2], P64[0], P64[1], P64[2], P64[3], P32[1], P64[4], P32[0]]
    stripes = (len(key) - 64) // 8
    block = 64 * stripes
    blocks = (len(data) - 1) // block
    last = struct.unpack_from("<8Q", key, len(key) - 64)
    for b in range(blocks):
        for s in range(stripes):
            accumulate(acc, data, b * block + 64 * s, key, 8 * s)
        for i in range(8):
            a = acc[i]
            acc[i] = ((a ^ a >> 47) ^ last[i]) * P32[0] & MASK
    for s in range((len(data) - 1 - block * blocks) // 64):
        accumulate(acc, data, blocks * block + 64 * s, key, 8 * s)
    accumulate(acc, data, len(data) - 64, key, len(key) - 64 - 7)
    return acc


def merge(acc, key, at, start):
    result = start
    for i in range(4):
        result += fold(acc[2 * i] ^ u64(key, at + 16 * i), acc[2 * i + 1] ^ u64(key, at + 16 * i + 8))
    return avalanche(result & MASK)


def small_parts(data):
    n = len(data)
    return data[0] << 16 | data[n >> 1] << 24 | data[n - 1] | n << 8


def hash64(data, seed=0):
    data = bytes(data)
    n = len(data)
    if n == 0:
        return avalanche_xxh64(seed ^ u64(SECRET, 56) ^ u64(SECRET, 64))
    if n <= 3:
        return avalanche_xxh64(small_parts(data) ^ ((u32(SECRET) ^ u32(SECRET, 4)) + seed & MASK))
    if n <= 8:
        seed ^= swap32(seed & 0xFFFFFFFF) << 32
        flip = (u64(SECRET, 8) ^ u64(SECRET, 16)) - seed & MASK
        h = (u32(data, n - 4) + (u32(data) << 32)) ^ flip
        h ^= rotl64(h, 49) ^ rotl64(h, 24)
        h = h * MIX_2 & MASK
        h ^= (h >> 35) + n
        h = h * MIX_2 & MASK
        return h ^ h >> 28
    if n <= 16:
        low = u64(data) ^ ((u64(SECRET, 24) ^ u64(SECRET, 32)) + seed & MASK)
        high = u64(data, n - 8) ^ ((u64(SECRET, 40) ^ u64(SECRET, 48)) - seed & MASK)
        return avalanche(n + swap64(low) + high + fold(low, high) & MASK)
    if n <= 128:
        h = n * P64[0]
        for i in reversed(range((n - 1) // 32 + 1)):
            h += mix16(data, 16 * i, 32 * i, seed) + mix16(data, n - 16 * (i + 1), 32 * i + 16, seed)
        return avalanche(h & MASK)
    if n <= 240:
        h = n * P64[0]
        for i in range(8):
            h += mix16(data, 16 * i, 16 * i, seed)
        h = avalanche(h & MASK)
        for i in range(8, n // 16):
            h += mix16(data, 16 * i, 16 * (i - 8) + 3, seed)
        return avalanche(h + mix16(data, n - 16, 136 - 17, seed) & MASK)
    key = seeded_secret(seed)
    return merge(long_accumulators(data, key), key, 11, n * P64[0] & MASK)


def mix32(acc, data, first, second, secret_at, seed):
    low, high = acc
    low = (low + mix16(data, first, secret_at, seed) & MASK) ^ (u64(data, second) + u64(data, second + 8) & MASK)
    high = ((high + mix16(data, second, secret_at + 16, seed) & MASK)
            ^ (u64(data, first) + u64(data, first + 8) & MASK))
    return low, high


def hash128(data, seed=0):
    """The hash in its canonical form, 32 hex digits."""
    low, high = parts128(bytes(data), seed)
    return f"{high:016x}{low:016x}"


def parts128(data, seed):
    n = len(data)
    if n == 0:
        return (avalanche_xxh64(seed ^ u64(SECRET, 64) ^ u64(SECRET, 72)),
                avalanche_xxh64(seed ^ u64(SECRET, 80) ^ u64(SECRET, 88)))
    if n <= 3:
        first = small_parts(data)
        turned = swap32(first)
        second = (turned << 13 | turned >> 19) & 0xFFFFFFFF
        return (avalanche_xxh64(first ^ ((u32(SECRET) ^ u32(SECRET, 4)) + seed & MASK)),
                avalanche_xxh64(second ^ ((u32(SECRET, 8) ^ u32(SECRET, 12)) - seed & MASK)))
    if n <= 8:
        seed ^= swap32(seed & 0xFFFFFFFF) << 32
        keyed = (u32(data) + (u32(data, n - 4) << 32)) ^ ((u64(SECRET, 16) ^ u64(SECRET, 24)) + seed & MASK)
        product = keyed * (P64[0] + (n << 2))
        low, high = product & MASK, product >> 64
        high = high + (low << 1) & MASK
        low ^= high >> 3
        low ^= low >> 35
        low = low * MIX_2 & MASK
        return low ^ low >> 28, avalanche(high)
    if n <= 16:
        flip_low = (u64(SECRET, 32) ^ u64(SECRET, 40)) - seed & MASK
        flip_high = (u64(SECRET, 48) ^ u64(SECRET, 56)) + seed & MASK
        first, last = u64(data), u64(data, n - 8)
        product = (first ^ last ^ flip_low) * P64[0]
        low, high = product & MASK, product >> 64
        low = low + (n - 1 << 54) & MASK
        last ^= flip_high
        high = high + last + (last & 0xFFFFFFFF) * (P32[1] - 1) & MASK
        low ^= swap64(high)
        product = low * P64[1]
        return avalanche(product & MASK), avalanche((product >> 64) + high * P64[1] & MASK)
    if n <= 240:
        acc = n * P64[0] & MASK, 0
        if n <= 128:
            for i in reversed(range((n - 1) // 32 + 1)):
                acc = mix32(acc, data, 16 * i, n - 16 * (i + 1), 32 * i, seed)
        else:
            for i in range(4):
                acc = mix32(acc, data, 32 * i, 32 * i + 16, 32 * i, seed)
            acc = avalanche(acc[0]), avalanche(acc[1])
            for i in range(4, n // 32):
                acc = mix32(acc, data, 32 * i, 32 * i + 16, 3 + 32 * (i - 4), seed)
            acc = mix32(acc, data, n - 16, n - 32, 136 - 17 - 16, -seed & MASK)
        low = acc[0] + acc[1] & MASK
        high = acc[0] * P64[0] + acc[1] * P64[3] + (n - seed) * P64[1] & MASK
        return avalanche(low), -avalanche(high) & MASK
    key = seeded_secret(seed)
    acc = long_accumulators(data, key)
    return (merge(acc, key, 11, n * P64[0] & MASK),
            merge(acc, key, len(key) - 64 - 11, ~(n * P64[1]) & MASK))
