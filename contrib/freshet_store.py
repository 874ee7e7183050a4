#!/usr/bin/python3
"""A second reader of Freshet's stores, written from docs/format.md: nothing of the engine, nothing of LMDB.

It wants Python 3.9 or later, python3-xxhash and python3-zstandard, and takes its time: some 0.7 million samples a second.

    freshet_store.py info STORE              what the store holds, as JSON
    freshet_store.py digest STORE            as `freshet store digest`
    freshet_store.py framemd5 STORE CLIP     MD5 of every frame of a clip, a line each
    freshet_store.py column STORE CLIP NAME  a column's bytes, to standard output
    freshet_store.py blob STORE NAME         a blob's bytes, to standard output

From Python: Store(path).clips, .frames(clip, stream, plane), .column(clip, name), .blob(name), .digest().
What is not as the format says is a Damaged; a file that is no store, or of another version, is a NoStore.
"""

import hashlib
import json
import mmap
import struct
import sys

import zstandard
from xxhash import xxh3_64_intdigest as hash64
from xxhash import xxh3_128_hexdigest as hash128

STREAMS = ("frames", "flow", "average")
TABLES = ("meta", "clips", "tiles", "columns", "blobs")
NO_PAGE = (1 << 64) - 1
SLAB = 16  # frames of a tile
CONTEXT_BOUNDS = (0, 1, 3, 5, 7, 10, 14, 19, 26, 36, 50, 70, 98, 140, 200, 320)
MAX_RECORD = 1 << 30  # bytes that a record may say it holds


class NoStore(Exception):
    pass


class Damaged(Exception):
    pass


def expect(condition, fault):
    if not condition:
        raise Damaged(fault)


class Cursor:
    """Numbers and strings taken off the front of bytes."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, kind):
        size = struct.calcsize("<" + kind)
        expect(self.at + size <= len(self.data), "a record ends too early")
        value, = struct.unpack_from("<" + kind, self.data, self.at)
        self.at += size
        return value

    def bytes(self, size):
        expect(self.at + size <= len(self.data), "a record ends too early")
        self.at += size
        return self.data[self.at - size:self.at]

    def string(self):
        return self.bytes(self.take("I"))

    def varint(self):
        value, shift = 0, 0
        while True:
            byte = self.take("B")
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value
            expect(shift < 63, "a varint has no end")

    def finish(self):
        expect(self.at == len(self.data), "a record goes on after its end")


def expand(stored, raw_size):
    """One zstd frame with content size and checksum."""
    try:
        parameters = zstandard.get_frame_parameters(stored)
        expect(parameters.content_size == raw_size and parameters.has_checksum, "a zstd frame says another size")
        raw = zstandard.ZstdDecompressor().decompress(stored, max_output_size=raw_size)
    except zstandard.ZstdError as error:
        raise Damaged(f"a zstd frame does not decode: {error}") from error
    expect(len(raw) == raw_size, "a zstd frame has another size")
    return raw


def unshuffle(data, element):
    count = len(data) // element
    raw = bytearray(data)
    for k in range(element):
        raw[k:count * element:element] = data[k * count:(k + 1) * count]
    return bytes(raw)


class Pages:
    """The entries of the five databases, read from the file's B+trees."""

    def __init__(self, data):
        self.data = data
        if len(data) < 152 or struct.unpack_from("<II", data, 16) != (0xBEEFC0DE, 1):
            raise NoStore("it is no LMDB file")
        self.page_bytes, = struct.unpack_from("<I", data, 40)
        expect(512 <= self.page_bytes <= 65536 and self.page_bytes & (self.page_bytes - 1) == 0, "page size")
        newest = max((0, self.page_bytes), key=lambda at: struct.unpack_from("<Q", data, at + 144)[0])
        self.tables = {}
        for key, value in self.tree(struct.unpack_from("<Q", data, newest + 88 + 40)[0]):
            expect(len(value) == 48, "the main tree holds something else than a database")
            self.tables[key.decode("latin-1")] = struct.unpack_from("<Q", value, 40)[0]
        if "meta" not in self.tables:
            raise NoStore("it is an LMDB file but no store")
        expect(sorted(self.tables) == sorted(TABLES), "its databases are not those of a store")

    def table(self, name):
        return self.tree(self.tables[name])

    def tree(self, root, depth=0):
        if root == NO_PAGE:
            return
        expect(depth < 32, "a tree is too deep")
        at = root * self.page_bytes
        expect(1 < root and at + self.page_bytes <= len(self.data), f"page {root} lies outside the file")
        number, _, kind, lower, upper = struct.unpack_from("<QHHHH", self.data, at)
        expect(number == root and kind in (1, 2) and 16 <= lower <= upper <= self.page_bytes,
               f"page {root} is no page of keys")
        for i in range(16, lower, 2):
            place, = struct.unpack_from("<H", self.data, at + i)
            expect(upper <= place <= self.page_bytes - 8, f"page {root} has an entry outside it")
            low, high, flags, key_bytes = struct.unpack_from("<HHHH", self.data, at + place)
            expect(place + 8 + key_bytes <= self.page_bytes, f"page {root} has an entry outside it")
            if kind == 1:
                yield from self.tree(low | high << 16 | flags << 32, depth + 1)
                continue
            start = at + place + 8
            key, size = self.data[start:start + key_bytes], low | high << 16
            if flags & 1:  # on pages of its own
                first, = struct.unpack_from("<Q", self.data, start + key_bytes)
                value_at = first * self.page_bytes + 16
            else:
                value_at = start + key_bytes
            expect(value_at + size <= len(self.data), f"page {root} has a value outside the file")
            yield key, self.data[value_at:value_at + size]


class Record:
    def __init__(self, store_id, table, key, value):
        self.name = f"{table} {key.hex()}"
        expect(len(value) >= 48, f"{self.name}: shorter than its header")
        (magic, self.codec, self.flags, _, self.parameter, _, self.raw_bytes, self.total_bytes, self.stored_bytes,
         self.hash) = struct.unpack_from("<IBBHIIQQQQ", value)
        self.payload = value[48:]
        expect(magic == 0x31525246 and self.codec <= 3 and self.stored_bytes == len(self.payload),
               f"{self.name}: its header is garbled")
        hashed = self.payload[:12 * self.parameter] if self.codec == 3 else self.payload
        where = struct.pack("<BBH", TABLES.index(table), 0, len(key))
        expect(hash64(value[:40] + where + key + hashed, store_id) == self.hash,
               f"{self.name}: its hash does not fit its bytes and its place")

    def raw(self):
        expect(self.raw_bytes <= MAX_RECORD and self.codec < 3, f"{self.name}: its codec or its size")
        if self.codec == 0:
            expect(len(self.payload) == self.raw_bytes, f"{self.name}: its size")
            return self.payload
        data = expand(self.payload, self.raw_bytes)
        return unshuffle(data, self.parameter) if self.codec == 2 else data


class Sum:
    """Records counted, and their hashes added."""

    def __init__(self, records=0, hashes=0):
        self.records, self.hashes = records, hashes

    def add(self, record):
        self.records += 1
        self.hashes = (self.hashes + record.hash) & NO_PAGE

    def __eq__(self, other):
        return (self.records, self.hashes) == (other.records, other.hashes)


def take_sum(cursor):
    return Sum(cursor.take("I"), cursor.take("Q"))


class Array:
    """What is said of a column or a blob."""

    def __init__(self, cursor):
        self.element, self.flags, self.bytes = cursor.take("I"), cursor.take("B"), cursor.take("Q")
        self.sum = take_sum(cursor)


def take_arrays(cursor):
    arrays = {}
    for _ in range(cursor.take("I")):
        name = cursor.string()
        arrays[name] = Array(cursor)
    expect(list(arrays) == sorted(arrays), "names are out of order")
    return arrays


class Plane:
    def __init__(self, cursor):
        self.width, self.height = cursor.take("I"), cursor.take("I")
        self.sample_bytes, self.edge_log2 = cursor.take("B"), cursor.take("B")
        expect(0 < self.width <= 65536 and 0 < self.height <= 65536 and self.sample_bytes in (1, 2)
               and 4 <= self.edge_log2 <= 8, "a plane's size")


class StreamShape:
    def __init__(self, cursor):
        self.frames = cursor.take("I")
        self.planes = [Plane(cursor) for _ in range(cursor.take("B"))]


class Clip:
    TEXTS = ("name", "class_name", "licence", "source_hash", "pixel_format", "metadata")

    def __init__(self, number, data):
        cursor = Cursor(data)
        self.number = number
        self.texts = [cursor.string() for _ in self.TEXTS]
        self.width, self.height, self.frame_count = (cursor.take("I") for _ in range(3))
        self.fps = cursor.take("q"), cursor.take("q")
        self.rows = cursor.take("Q")
        self.streams = [StreamShape(cursor) for _ in STREAMS]
        self.tile_sums = [take_sum(cursor) for _ in STREAMS]
        self.columns = take_arrays(cursor)
        cursor.finish()

    def text(self, which):
        return self.texts[self.TEXTS.index(which)].decode("utf-8", "surrogateescape")


def med(a, b, c):
    low, high = (a, b) if a < b else (b, a)
    return high if c <= low else low if c >= high else a + b - c


class Tile:
    """A box of one plane, over up to 16 frames."""

    def __init__(self, width, height, frames, sample_bytes):
        self.width, self.height, self.frames, self.sample_bytes = width, height, frames, sample_bytes

    def decode(self, coded):
        """Frames of rows of samples, as they were before."""
        limit = 64 + 4 * self.width * self.height * self.frames * self.sample_bytes + 65536
        size = zstandard.get_frame_parameters(coded).content_size
        expect(size <= limit, "a tile is larger than any of its shape")
        self.read_parts(Cursor(expand(coded, size)))
        outside = [0] * self.width
        before, before_sums = [outside] * self.height, None
        frames = []
        for f in range(self.frames):
            frame, sums = self.decode_frame(f, before, before_sums)
            frames.append(frame)
            before, before_sums = frame, sums
        expect(all(at == len(symbols) for at, symbols in zip(self.used, self.symbols)), "symbols are left over")
        expect(self.large_at == len(self.large), "large symbols are left over")
        if self.signed:
            frames = [[[s ^ 0x8000 for s in row] for row in frame] for frame in frames]
        return frames

    def read_parts(self, cursor):
        starts = cursor.take("H")
        expect(starts & 1, "the first context begins no group")
        counts = [cursor.varint() for _ in range(16)]
        groups = []
        for c in range(16):
            if starts >> c & 1:
                groups.append([])
            groups[-1].append(c)
        sizes = [cursor.varint() for _ in groups]
        side = Cursor(cursor.bytes(cursor.varint()))
        self.symbols = [b""] * 16
        for group, size in zip(groups, sizes):
            packing = size & 3
            symbols = self.unpack(cursor.bytes(size >> 2), sum(counts[c] for c in group), packing)
            for c in group:
                self.symbols[c], symbols = symbols[:counts[c]], symbols[counts[c]:]
        cursor.finish()
        self.used = [0] * 16
        self.signed = side.take("B")
        expect(self.signed <= 1, "the tile's first byte of side information")
        self.blocks_across = (self.width + 7) // 8
        self.blocks_down = (self.height + 7) // 8
        self.predictors = side.bytes(self.frames * self.blocks_across * self.blocks_down)
        rest = side.bytes(len(side.data) - side.at)
        expect(len(rest) % 2 == 0, "half a large symbol")
        self.large = struct.unpack(f"<{len(rest) // 2}H", rest)
        self.large_at = 0

    @staticmethod
    def unpack(data, count, packing):
        expect(packing <= 2, "an unknown packing")
        if packing == 0:
            expect(len(data) == count, "symbols are missing")
            return data
        bits = 8 >> packing
        top = (1 << bits) - 1
        packed = (count * bits + 7) // 8
        given = iter(data[packed:])
        symbols = bytearray()
        try:
            for i in range(count):
                symbol = data[i * bits // 8] >> i * bits % 8 & top
                symbols.append(next(given) if symbol == top else symbol)
        except (StopIteration, IndexError) as error:
            raise Damaged("symbols are missing") from error
        expect(next(given, None) is None, "symbols are left over")
        return bytes(symbols)

    def decode_frame(self, f, before, before_sums):
        across, width = self.blocks_across, self.width
        mask = 0xFF if self.sample_bytes == 1 else 0xFFFF
        frame, sums = [], []
        above = nothing = [0] * width
        for y in range(self.height):
            row, row_sums = [0] * width, [0] * across
            past, past_above = before[y], before[y - 1] if y > 0 else nothing
            # What lies to the left of this row and of the one above, now and in the frame before.
            corner = frame[y - 2][0] if y > 1 else 0
            past_corner = before[y - 2][0] if y > 1 else 0
            n, nn, p, ps = self.sums_around(y, sums, before_sums)
            predictors = self.predictors[(f * self.blocks_down + y // 8) * across:][:across]
            for g in range(across):
                predictor = predictors[g]
                left, right = max(g - 1, 0), min(g + 1, across - 1)
                xs = range(8 * g, min(8 * g + 8, width))
                if predictor == 5:
                    for x in xs:
                        row[x] = past[x]
                    continue
                activity = (6 * n[g] + n[left] + n[right] + 4 * nn[g] + 2 * p[g] + 2 * ps[g]) >> 4
                context = max(c for c in range(16) if CONTEXT_BOUNDS[c] <= activity)
                symbols, at = self.symbols[context], self.used[context]
                self.used[context] += len(xs)
                expect(self.used[context] <= len(symbols), "symbols are missing")
                for x in xs:
                    symbol = symbols[at]
                    at += 1
                    row_sums[g] += symbol
                    if symbol == 255 and self.sample_bytes == 2:
                        expect(self.large_at < len(self.large), "large symbols are missing")
                        symbol = self.large[self.large_at]
                        self.large_at += 1
                    error = symbol >> 1 if symbol & 1 == 0 else -(symbol + 1 >> 1)
                    row[x] = self.predict(predictor, x, row, above, corner, past, past_above, past_corner) + error & mask
            frame.append(row)
            sums.append(row_sums)
            above = row
        return frame, sums

    def sums_around(self, y, sums, before):
        """Sums of the groups above, two above, in the frame before, and below there."""
        nothing = [0] * self.blocks_across
        p = before[y] if before else None
        n = sums[y - 1] if y > 0 else p if p else nothing
        nn = sums[y - 2] if y > 1 else n
        if not before:
            return n, nn, n, n
        return n, nn, p, before[y + 1] if y + 1 < self.height else p

    @staticmethod
    def predict(predictor, x, row, above, corner, past, past_above, past_corner):
        north = above[x]
        west, north_west = (row[x - 1], above[x - 1]) if x > 0 else (north, corner)
        if predictor == 0:
            return med(west, north, north_west)
        if predictor == 1:
            return past[x]
        if predictor == 2:
            p_north = past_above[x]
            p_west, p_north_west = (past[x - 1], past_above[x - 1]) if x > 0 else (p_north, past_corner)
            return past[x] + med(west - p_west, north - p_north, north_west - p_north_west)
        if predictor == 3:
            return 3 * (west + north) - 2 * north_west + 2 >> 2
        if predictor == 4:
            return med(west, north, north_west) + past[x] >> 1
        raise Damaged("an unknown predictor")


class Store:
    def __init__(self, path):
        with open(path, "rb") as file:
            try:
                data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
            except ValueError as error:
                raise NoStore("it is empty") from error
        self.pages = Pages(data)
        meta = dict(self.pages.table("meta"))
        identity = meta.get(b"store", b"")
        if identity[:8] != b"FRESHET\n":
            raise NoStore("it is an LMDB file but no store")
        version, = struct.unpack_from("<I", identity, 8)
        if version != 3:
            raise NoStore(f"its format version is {version}, expected 3")
        expect(len(identity) == 32 and hash64(identity[:24]) == struct.unpack_from("<Q", identity, 24)[0],
               "its identity is garbled")
        self.store_id, = struct.unpack_from("<Q", identity, 16)
        expect(sorted(meta) == [b"account", b"settings", b"store"], "the records of meta are not those of a store")
        self.settings = self.record("meta", b"settings", meta[b"settings"]).raw()
        account = Cursor(self.record("meta", b"account", meta[b"account"]).raw())
        self.next_clip, clips_sum, self.blobs = account.take("I"), take_sum(account), take_arrays(account)
        account.finish()
        self.tables = {name: dict(self.pages.table(name)) for name in ("tiles", "columns", "blobs")}
        self.clips, found = [], Sum()
        for key, value in self.pages.table("clips"):
            record = self.record("clips", key, value)
            found.add(record)
            self.clips.append(Clip(int.from_bytes(key, "big"), record.raw()))
        expect(found == clips_sum, "the clips are not those that were written")

    def record(self, table, key, value):
        return Record(self.store_id, table, key, value)

    def find(self, name):
        for clip in self.clips:
            if clip.text("name") == name:
                return clip
        raise KeyError(name)

    def records(self, table, prefix, tail_bytes):
        """Records whose keys are the prefix and so many more bytes, in order."""
        return [(key, self.record(table, key, self.tables[table][key])) for key in sorted(self.tables[table])
                if key.startswith(prefix) and len(key) == len(prefix) + tail_bytes]

    def tiles(self, clip, stream):
        """Coded tiles, in order."""
        coded, found = [], Sum()
        for key, record in self.records("tiles", struct.pack(">IB", clip.number, stream), 4):
            expect(record.codec == 3 and int.from_bytes(key[5:], "big") == len(coded), "tiles are missing")
            found.add(record)
            at = 12 * record.parameter
            for t in range(record.parameter):
                size, tile_hash = struct.unpack_from("<IQ", record.payload, 12 * t)
                tile = record.payload[at:at + size]
                expect(hash64(tile, self.store_id) == tile_hash, f"{record.name}: the hash of tile {t}")
                coded.append(tile)
                at += size
            expect(at == len(record.payload), f"{record.name}: its directory")
        expect(found == clip.tile_sums[stream], "the tiles are not those that were written")
        return coded

    def planes(self, clip, stream):
        """For each plane its frames, rows packed, as bytes."""
        shape = clip.streams[stream]
        coded, number = self.tiles(clip, stream), 0
        planes = [[bytearray(p.width * p.height * p.sample_bytes) for _ in range(shape.frames)]
                  for p in shape.planes]
        for first in range(0, shape.frames, SLAB):
            for plane, out in zip(shape.planes, planes):
                edge = 1 << plane.edge_log2
                for y in range(0, plane.height, edge):
                    for x in range(0, plane.width, edge):
                        tile = Tile(min(edge, plane.width - x), min(edge, plane.height - y),
                                    min(SLAB, shape.frames - first), plane.sample_bytes)
                        expect(number < len(coded), "tiles are missing")
                        for f, frame in enumerate(tile.decode(coded[number])):
                            for r, row in enumerate(frame):
                                at = ((y + r) * plane.width + x) * plane.sample_bytes
                                packed = bytes(row) if plane.sample_bytes == 1 else struct.pack(f"<{len(row)}H", *row)
                                out[first + f][at:at + len(packed)] = packed
                        number += 1
        expect(number == len(coded), "there are more tiles than the stream has")
        return planes

    def array(self, table, prefix, account):
        chunks, found = [], Sum()
        for key, record in self.records(table, prefix, 4):
            expect(int.from_bytes(key[-4:], "big") == len(chunks), "a chunk is missing")
            expect((record.total_bytes, record.parameter, record.flags)
                   == (account.bytes, account.element, account.flags), f"{record.name}: it is of another array")
            found.add(record)
            chunks.append(record.raw())
        data = b"".join(chunks)
        expect(found == account.sum and len(data) == account.bytes, "chunks are not those that were written")
        return data

    def column(self, clip, name):
        return self.array("columns", struct.pack(">I", clip.number) + name + b"\0", clip.columns[name])

    def blob(self, name):
        return self.array("blobs", name + b"\0", self.blobs[name])

    def clip_digest(self, clip):
        parts = []
        for text in clip.texts:
            parts += [struct.pack("<Q", len(text)), text]
        parts.append(struct.pack("<3Q2qQ", clip.width, clip.height, clip.frame_count, *clip.fps, clip.rows))
        for s, shape in enumerate(clip.streams):
            parts.append(struct.pack("<2Q", len(shape.planes), shape.frames))
            for plane, frames in zip(shape.planes, self.planes(clip, s)):
                parts.append(struct.pack("<3Q", plane.width, plane.height, plane.sample_bytes))
                parts += frames
        for name in sorted(clip.columns, key=lambda n: n + b"\0"):
            data = self.column(clip, name)
            parts += [struct.pack("<Q", len(name)), name, struct.pack("<2Q", clip.columns[name].element, len(data)),
                      data]
        return bytes.fromhex(hash128(b"".join(parts)))

    def digest(self):
        start = b"freshet digest 1"
        parts = [struct.pack("<Q", len(start)), start, struct.pack("<Q", len(self.settings)), self.settings,
                 struct.pack("<Q", len(self.clips))]
        source, name = Clip.TEXTS.index("source_hash"), Clip.TEXTS.index("name")
        parts += [self.clip_digest(clip) for clip in sorted(self.clips, key=lambda c: (c.texts[source], c.texts[name]))]
        for blob, account in self.blobs.items():
            if account.flags & 1 == 0:
                data = self.blob(blob)
                parts += [struct.pack("<Q", len(blob)), blob, struct.pack("<Q", len(data)), data]
        return hash128(b"".join(parts))

    def info(self):
        def described(clip):
            fields = {which: clip.text(which) for which in Clip.TEXTS}
            fields.update(width=clip.width, height=clip.height, frames=clip.frame_count, fps=clip.fps, rows=clip.rows,
                          columns={name.decode("latin-1"): account.bytes for name, account in clip.columns.items()})
            return fields
        return {"settings": self.settings.decode("utf-8", "replace"), "clips": [described(c) for c in self.clips],
                "blobs": {name.decode("latin-1"): account.bytes for name, account in self.blobs.items()}}


def main(arguments):
    commands = {"info": 1, "digest": 1, "framemd5": 2, "column": 3, "blob": 2}
    if len(arguments) < 2 or commands.get(arguments[0]) != len(arguments) - 1:
        print(__doc__, file=sys.stderr)
        return 2
    command, path, *names = arguments
    try:
        store = Store(path)
        if command == "info":
            print(json.dumps(store.info(), indent=2))
        elif command == "digest":
            print(store.digest())
        elif command == "framemd5":
            for frame in zip(*store.planes(store.find(names[0]), 0)):
                print(hashlib.md5(b"".join(frame)).hexdigest())
        elif command == "column":
            sys.stdout.buffer.write(store.column(store.find(names[0]), names[1].encode()))
        else:
            sys.stdout.buffer.write(store.blob(names[0].encode()))
    except Damaged as fault:
        print(f"{path}: {fault}", file=sys.stderr)
        return 3
    except (NoStore, OSError, KeyError) as fault:
        print(f"{path}: {fault}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
