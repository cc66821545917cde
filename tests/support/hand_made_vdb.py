# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""VDB files made from the format's definition: grids of all types that are read, with active
tiles."""
import struct
import zlib

BALL = [(x, y, z) for x in range(-9, 10) for y in range(-9, 10) for z in range(-9, 10)
        if x * x + y * y + z * z <= 81]


def text(string):
    data = string if isinstance(string, bytes) else string.encode()
    return struct.pack("<I", len(data)) + data


def index(p, node, log2):
    """Where the voxel p lies in a node of (2^log2)^3 entries of (2^node)^3 voxels."""
    within = (1 << log2) - 1
    x, y, z = (c >> node & within for c in p)
    return (x << 2 * log2) + (y << log2) + z


class Tree:
    """A tree of OpenVDB below the origin's root entry: voxels and tiles of 8^3 and 128^3 voxels."""

    def __init__(self, code, background, zipped_blocks=True):
        self.code, self.background, self.zip = code, background, zipped_blocks
        self.leaves, self.tiles = {}, {3: {}, 7: {}}  # by log2 of their edge

    def set(self, p, value, active=True):
        leaf = self.leaves.setdefault(tuple(c >> 3 for c in p), {})
        leaf[index(p, 0, 3)] = (value, active)

    def value(self, value):
        return struct.pack("<" + self.code, *(value if isinstance(value, tuple) else (value,)))

    def block(self, entries, count):
        """All values of a node, whether active or not."""
        background = self.value(self.background)
        data = b"".join(self.value(entries[i][0]) if i in entries else background
                        for i in range(count))
        if not self.zip:
            return b"\6" + data
        packed = zlib.compress(data)
        packed = struct.pack("<q", len(packed)) + packed if len(packed) < len(data) else (
            struct.pack("<q", -len(data)) + data)
        return b"\6" + packed

    @staticmethod
    def mask(bits, count):
        return sum(1 << i for i in bits).to_bytes(count // 8, "little")

    def internal(self, node, log2, children, tiles):
        """`children` and `tiles`: by the coordinates of their lowest voxel."""
        count = 1 << 3 * log2
        inside = {index(p, node, log2): (value, True) for p, value in tiles.items()}
        return (self.mask([index(p, node, log2) for p in children], count) + self.mask(inside,
                                                                                       count) +
                self.block(inside, count))

    def bytes(self):
        """Topology and buffers."""
        lower = {}
        for leaf in self.leaves:
            lower.setdefault(tuple(c >> 4 for c in leaf),
                             ([], {}))[0].append(tuple(c << 3 for c in leaf))
        for p, value in self.tiles[3].items():
            lower.setdefault(tuple(c >> 7 for c in p), ([], {}))[1][p] = value
        topology = struct.pack("<i", 1) + self.value(self.background) + struct.pack("<II3i", 0, 1,
                                                                                    0, 0, 0)
        nodes = {tuple(c << 7 for c in p): content for p, content in lower.items()}
        topology += self.internal(7, 5, nodes, self.tiles[7])
        buffers = b""
        for p in sorted(nodes, key=lambda p: index(p, 7, 5)):
            leaves, tiles = nodes[p]
            topology += self.internal(3, 4, leaves, tiles)
            for origin in sorted(leaves, key=lambda p: index(p, 3, 4)):
                voxels = self.leaves[tuple(c >> 3 for c in origin)]
                mask = self.mask([i for i, (_, active) in voxels.items() if active], 512)
                topology += mask
                buffers += mask
                if self.code == "?":
                    values = self.mask([i for i, (value, _) in voxels.items() if value], 512)
                    buffers += struct.pack("<3i", *origin) + values
                else:
                    buffers += self.block(voxels, 512)
        return topology, buffers


def vdb(grids, edge=1.0):
    """`grids`: name, type, tree, and more metadata as pairs of name and (type, bytes)."""
    # Magic number, versions of format and library, offsets, a UUID; no metadata; how many grids.
    out = struct.pack("<qIII?", 0x56444220, 224, 10, 0,
                      True) + b"00000000-0000-4000-8000-000000000000"
    out += struct.pack("<Ii", 0, len(grids))
    scale = [edge, edge, 1 / edge, 1 / edge**2, 0.5 / edge]  # of a ScaleMap, each for x, y and z
    transform = text("UniformScaleMap") + b"".join(struct.pack("<3d", v, v, v) for v in scale)
    for name, kind, tree, metadata in grids:
        metadata = {"name": ("string", name.encode()), **metadata}
        head = struct.pack("<I", 1 if tree.zip else 0) + struct.pack("<I", len(metadata))
        for key, (type_name, data) in metadata.items():
            head += text(key) + text(type_name) + text(data)
        topology, buffers = tree.bytes()
        descriptor = text(name) + text(f"Tree_{kind}_5_4_3") + text("")
        start = len(out) + len(descriptor) + 24
        body = head + transform + topology
        out += descriptor + struct.pack("<qqq", start, start + len(body),
                                        start + len(body) + len(buffers))
        out += body + buffers
    return out


DOMAIN = {"madf_domain_min": ("vec3i", struct.pack("<3i", 0, 0, 0)),
          "madf_domain_max": ("vec3i", struct.pack("<3i", 47, 31, 31))}


def two_balls(code, background, value, zipped_blocks=True, tiles=()):
    """Balls at x = 12 and 27; `value` of which (0, 1) and the place in it. `tiles`: edge's log2,
    origin."""
    tree = Tree(code, background, zipped_blocks)
    for which, center in enumerate(((12, 14, 15), (27, 16, 15))):
        for p in BALL:
            tree.set(tuple(a + b for a, b in zip(center, p)), value(which, p))
    for log2, origin, tile_value in tiles:
        tree.tiles[log2][origin] = tile_value
    return tree


def level_set():
    tree = Tree("f", 3.0)
    for x in range(4, 28):
        for y in range(4, 28):
            for z in range(4, 28):
                distance = ((x - 15)**2 + (y - 15)**2 + (z - 16)**2)**0.5 - 9
                if abs(distance) < 3:
                    tree.set((x, y, z), distance)
                elif distance < 0:
                    tree.set((x, y, z), -3.0, active=False)
    return tree


def vdb_files():
    def label(which, p):
        return which + 1

    def fog(which, p):
        return 0.125 * (which + 1) + 0.0625 * (p[2] % 4)
    far = (3, (40, 0, 0), 3), (3, (40, 8, 0), 3), (3, (40, 16, 8), 5)
    return {
        "labels.vdb": vdb([("grain", "int32", two_balls("i", 0, label), DOMAIN)], 0.01),
        "plain.vdb": vdb([("grain", "int32", two_balls("i", 0, label, zipped_blocks=False), {})]),
        "tiles.vdb": vdb([("grain", "int32", two_balls("i", 0, label, tiles=far), DOMAIN)], 0.01),
        "large_tile.vdb": vdb([("grain", "int32",
                                two_balls("i", 0, label, tiles=[(7, (128, 0, 0), 9)]), {})]),
        "object.vdb": vdb([("object", "bool", two_balls("?", False, lambda which, p: True, tiles=[
            (3, (40, 0, 0), True), (7, (0, 0, 128), True)]), {})]),
        "fog.vdb": vdb([("density", "float", two_balls("f", 0.0, fog, tiles=[(3, (40, 0, 0), 0.5)]),
                         {
            "class": ("string", b"fog volume"), **DOMAIN})]),
        "level_set.vdb": vdb([("surface", "float", level_set(),
                               {"class": ("string", b"level set")})], 0.5),
        "many.vdb": vdb([
            ("int64", "int64", two_balls("q", 0, label), DOMAIN),
            ("double", "double", two_balls("d", -1.0, fog), DOMAIN),
            ("vector", "vec3s", two_balls("3f", (0.0, 0.0, 0.0), lambda which,
                                          p: (1.0, which, 0.5)), {}),
            ("label", "int32", two_balls("i", 0, label), {})]),
        "unknown_type.vdb": vdb([("points", "ptdataidx32", two_balls("i", 0, label), {}),
                                 ("grain", "int32", two_balls("i", 0, label), DOMAIN)]),
    }
