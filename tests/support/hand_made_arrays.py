# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The samples of volumes that are made by hand, and these as arrays of Zarr and HDF5."""
import gzip
import struct
import zlib

NX, NY, NZ = 11, 7, 6
COUNT = NX * NY * NZ
SLICE = NX * NY
UM = 8.5


def values(low=0, high=200):
    """Half of the samples are 0, 1 or 2, the others anything from low to high."""
    state, result = 1, []
    for _ in range(COUNT):
        state = (state * 1664525 + 1013904223) % 2**32
        number = state >> 8
        result.append(number % 3 if state >> 31 else low + number % (high - low + 1))
    return result


RANGES = {"B": (0, 255), "b": (-128, 127), "H": (0, 65535), "h": (-32768, 32767),
          "I": (0, 2**32 - 1), "i": (-2**31, 2**31 - 1), "q": (-2**31, 2**31 - 1),
          "Q": (0, 2**32 - 1), "f": (-999, 999), "d": (-999, 999), "?": (0, 1)}


def samples(code, order="<"):
    scale = 0.5 if code in "fd" else 1
    return struct.pack(f"{order}{COUNT}{code}", *(v * scale for v in values(*RANGES[code])))


def zipped(data):
    return gzip.compress(data, mtime=0)


# --- Zarr

def blosc(data, size):
    """A frame that holds its bytes as they are."""
    return struct.pack("<BBBBIII", 2, 1, 2, size, len(data), len(data), len(data) + 16) + data


CODECS = {"null": lambda data, size: data, '{"id": "zlib", "level": 1}': lambda data,
          size: zlib.compress(data), '{"id": "gzip", "level": 1}': lambda data, size: zipped(data),
          '{"id": "blosc", "cname": "lz4"}': blosc}


def zarr(kind, data, codec="null", chunk=(4, 3, 5), order="C", separator=".", leading=0, skip=()):
    """The files of an array. `chunk` in x, y, z; `skip`: chunks that are not there."""
    size = len(data) // COUNT
    cx, cy, cz = chunk
    ones = "1, " * leading
    text = (
        f'{{"chunks": [{ones}{cz}, {cy}, {cx}], "compressor": {codec}, "dtype": "{kind}", '
        f'"fill_value": 7, "filters": null, "order": "{order}", "shape": [{ones}{NZ}, {NY}, {NX}], '
        f'"zarr_format": 2, "dimension_separator": "{separator}"}}')
    files = {".zarray": text.encode()}
    for number in ((i, j, k) for k in range(-(-NZ // cz)) for j in range(-(-NY // cy))
                   for i in range(-(-NX // cx))):
        if number in skip:
            continue
        x0, y0, z0 = (n * c for n, c in zip(number, chunk))
        places = [(x, y, z) for z in range(cz) for y in range(cy) for x in range(cx)]
        if order == "F":
            places = [(x, y, z) for x in range(cx) for y in range(cy) for z in range(cz)]
        content = b""
        for x, y, z in ((x0 + x, y0 + y, z0 + z) for x, y, z in places):
            at = ((z * NY + y) * NX + x) * size
            content += data[at:at + size] if x < NX and y < NY and z < NZ else b"k" * size
        key = separator.join(["0"] * leading + [str(n) for n in reversed(number)])
        files[key] = CODECS[codec](content, size)
    return files


def ome_zarr(path):
    scale = f'{{"type": "scale", "scale": [1, {UM}, {UM}, {UM}]}}'
    axes = ", ".join(f'{{"name": "{axis}", "type": "space", "unit": "micrometer"}}'
                     for axis in "zyx")
    return (
        f'{{"multiscales": [{{"version": "0.4", "axes": [{{"name": "c", "type": "channel"}}, '
        f'{axes}], "datasets": [{{"path": "{path}", '
        f'"coordinateTransformations": [{scale}]}}]}}]}}').encode()


# --- HDF5

def lookup3(data):
    """Bob Jenkins' hash, which HDF5 takes for its check sums."""
    mask = 2**32 - 1

    def rotated(value, bits):
        return (value << bits | value >> 32 - bits) & mask

    a = b = c = 0xdeadbeef + len(data) & mask
    words = struct.unpack(f"<{-(-len(data) // 12) * 3}I", data + bytes(-len(data) % 12))
    for i in range(0, len(words), 3):
        a, b, c = a + words[i] & mask, b + words[i + 1] & mask, c + words[i + 2] & mask
        if i + 3 < len(words):
            for bits in (4, 6, 8, 16, 19, 4):
                a, c = (a - c & mask) ^ rotated(c, bits), c + b & mask
                a, b, c = b, c, a
    for bits in (14, 11, 25, 16, 4, 14, 24):
        c = (c ^ b) - rotated(b, bits) & mask
        a, b, c = b, c, a
    return b


def checked(data):
    return data + struct.pack("<I", lookup3(data))


def hdf5_object(*messages):
    body = b"".join(struct.pack("<BHB", kind, len(data), 0) + data for kind, data in messages)
    return checked(b"OHDR\2\2" + struct.pack("<I", len(body)) + body)


def hdf5_group(links):
    """`links`: pairs of name and place of an object."""
    undefined = b"\xff" * 8
    return hdf5_object((2, b"\0\0" + 2 * undefined), (10, b"\0\0"),
                       *((6, bytes([1, 0, len(name)]) + name.encode() + struct.pack("<Q", place))
                         for name, place in links))


def hdf5_dataset(place, size, edge=0.0):
    """uint16 samples that lie at a place of the file."""
    uint16 = bytes([0x10, 0, 0, 0]) + struct.pack("<IHH", 2, 0, 16)
    float64 = bytes([0x11, 0x20, 63, 0]) + struct.pack("<IHHBBBBI", 8, 0, 64, 52, 11, 0, 52, 1023)
    messages = [(1, bytes([2, 3, 0, 1]) + struct.pack("<3Q", NZ, NY, NX)), (3, uint16),
                (5, b"\3\x0a"), (8, b"\3\1" + struct.pack("<QQ", place, size))]
    if edge:
        name, space = b"element_size_um\0", bytes([2, 1, 0, 1]) + struct.pack("<Q", 3)
        messages.append((12, struct.pack("<BBHHHB", 3, 0, len(name), len(float64), len(space),
                                         0) + name +
                         float64 + space + struct.pack("<3d", edge, edge, edge)))
    return hdf5_object(*messages)


def hdf5(data, edge=0.0, second=b""):
    """The dataset 'scan', and if there are samples for it 'more/labels'."""
    start = 48
    places = [start, start + len(data)]
    scan = hdf5_dataset(places[0], len(data), edge)
    at = places[1] + len(second)
    links, body = [("scan", at)], data + second + scan
    if second:
        labels = hdf5_dataset(places[1], len(second))
        group = hdf5_group([("labels", at + len(scan))])
        links.append(("more", at + len(scan) + len(labels)))
        body += labels + group
    root = start + len(body)
    body += hdf5_group(links)
    return checked(b"\x89HDF\r\n\x1a\n\2\x08\x08\0" +
                   struct.pack("<QQQQ", 0, 2**64 - 1, start + len(body), root)) + body
