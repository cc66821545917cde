# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Volumes as files of every format that can be read, made from the formats' definitions alone.

write_all(folder) writes them and returns their names: (files of images, files of grids). The same
bytes come out on every machine. Axes are x, y, z with x fastest, and all of other length, so that
an exchange of two shows.
"""
import gzip
import os
import struct
import zlib

import hand_made_vdb
from hand_made_arrays import COUNT, NX, NY, NZ, SLICE, UM, hdf5, ome_zarr, samples, zarr, zipped


# --- volumes in one piece behind a header

def npy(kind, data, version=1, shape=f"({NZ}, {NY}, {NX})", fortran=False):
    text = f"{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}   \n".encode()
    length = struct.pack("<H" if version == 1 else "<I", len(text))
    return b"\x93NUMPY" + bytes([version, 0]) + length + text + data


def nrrd(kind, fields, data=b""):
    return (f"NRRD0004\n# made by hand\ntype: {kind}\ndimension: 3\nsizes: {NX} {NY} "
            f"{NZ}\n{fields}\n\n"
            .encode() + data)


def meta(kind, fields, data_file="LOCAL", data=b""):
    return (f"ObjectType = Image\nNDims = 3\nDimSize = {NX} {NY} {NZ}\nElementType = "
            f"{kind}\n{fields}ElementDataFile = {data_file}\n".encode() + data)


def isq(data, blocks=0):
    """Scanco: integers in the first block of 512 bytes, the samples after so many blocks more."""
    head = bytearray(512 * (1 + blocks))
    head[:16] = b"CTDATA-HEADER_V1"
    struct.pack_into("<i", head, 16, 3)
    struct.pack_into("<6i", head, 44, NX, NY, NZ, 10 * NX, 10 * NY, 10 * NZ)
    struct.pack_into("<i", head, 508, blocks)
    return bytes(head) + data + bytes(-len(data) % 512)


def nifti(kind, data, order="<", slope=0.0, intercept=0.0, units=0, edge=1.0):
    head = bytearray(352)
    struct.pack_into(order + "i", head, 0, 348)
    struct.pack_into(order + "5h", head, 40, 4, NX, NY, NZ, 1)
    struct.pack_into(order + "h", head, 70, kind)
    struct.pack_into(order + "3f", head, 80, edge, edge, edge)
    struct.pack_into(order + "3f", head, 108, 352, slope, intercept)
    head[123] = units
    head[344:347] = b"n+1"
    return bytes(head) + data


def dgtal(size_line, version, data):
    return (f"Center-X: 5\nCenter-Y: 3\nCenter-Z: 3\nX: {NX}\nY: {NY}\nZ: "
            f"{NZ}\n{size_line}\nAlpha-Color: 0\nVoxel-Endian: 0\nInt-Endian: 0123\nVersion: "
            f"{version}\n.\n".encode() + data)


def pyhst(fields):
    size = f"NUM_X = {NX}\nNUM_Y = {NY}\nNUM_Z = {NZ}\n"
    return f"! PyHST_SLAVE VOLUME INFO FILE\n{size}{fields}".encode()


# --- TIFF

def packbits(data):
    return b"".join(bytes([len(data[i:i + 128]) - 1]) + data[i:i + 128]
                    for i in range(0, len(data), 128))


def lzw(data):
    """Codes of nine bits alone: the table is cleared before they would have to grow."""
    codes = []
    for i in range(0, len(data), 200):
        codes += [256, *data[i:i + 200]]
    bits = "".join(f"{code:09b}" for code in codes + [257])
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))


COMPRESSIONS = {1: lambda data: data, 5: lzw, 8: zlib.compress, 32773: packbits}


def tiff(pages, bits=8, sample_format=1, order="<", big=False, compression=1, rows=3, tile=0,
         description="", resolution=0, photometric=1):
    """`pages`: the bytes of each slice, rows padded to whole bytes, in the byte order of the
    file."""
    word = "Q" if big else "I"
    row = (NX * bits + 7) // 8
    magic = {"<": b"II", ">": b"MM"}[order]
    out = magic + (struct.pack(order + "HHHQ", 43, 8, 0, 0) if big
                   else struct.pack(order + "HI", 42, 0))
    link = 8 if big else 4  # where the offset of the next directory belongs
    for page in pages:
        if tile:
            step = bits // 8
            parts = [b"".join(page[(y + j) * row:(y + j + 1) * row][x * step:(x + tile) * step]
                              .ljust(tile * step, b"\7") for j in range(tile))
                     for y in range(0, NY, tile) for x in range(0, NX, tile)]
        else:
            parts = [page[i:i + rows * row] for i in range(0, len(page), rows * row)]
        offsets, counts = [], []
        for part in (COMPRESSIONS[compression](part) for part in parts):
            offsets.append(len(out))
            counts.append(len(part))
            out += part + bytes(len(part) % 2)
        tags = {256: ("I", [NX]), 257: ("I", [NY]), 258: ("H", [bits]), 259: ("H", [compression]),
                262: ("H", [photometric]), 277: ("H", [1]), 339: ("H", [sample_format])}
        if tile:
            tags.update({322: ("I", [tile]), 323: ("I", [tile]), 324: (word, offsets),
                         325: (word, counts)})
        else:
            tags.update({273: (word, offsets), 278: ("I", [rows]), 279: (word, counts)})
        if description:
            tags[270] = ("s", description.encode() + b"\0")
        if resolution:
            tags[282] = tags[283] = ("R", [round(resolution * 10**9), 10**9])
        entries, extra = b"", b""
        begin = len(out) + (8 + 20 * len(tags) + 8 if big else 2 + 12 * len(tags) + 4)
        for tag, (kind, content) in sorted(tags.items()):
            number = {"s": 2, "H": 3, "I": 4, "R": 5, "Q": 16}[kind]
            if kind == "s":
                data, count = content, len(content)
            else:
                data = struct.pack(f"{order}{len(content)}{kind.replace('R', 'I')}", *content)
                count = len(content) // (2 if kind == "R" else 1)
            if len(data) > struct.calcsize(word):
                place = struct.pack(order + word, begin + len(extra))
                extra += data + bytes(len(data) % 2)
            else:
                place = data.ljust(struct.calcsize(word), b"\0")
            entries += struct.pack(order + "HH" + word, tag, number, count) + place
        out = out[:link] + struct.pack(order + word, len(out)) + out[link + struct.calcsize(word):]
        out += struct.pack(order + ("Q" if big else "H"), len(tags)) + entries
        link = len(out)
        out += struct.pack(order + word, 0) + extra
    return out


def slices(data):
    return [data[i:i + len(data) // NZ] for i in range(0, len(data), len(data) // NZ)]


def bit_rows(data):
    """A bit for each byte, rows padded to whole bytes."""
    rows = ("".join("1" if v else "0" for v in data[i:i + NX]) for i in range(0, len(data), NX))
    return b"".join(int(row.ljust((NX + 7) // 8 * 8, "0"), 2).to_bytes((NX + 7) // 8, "big")
                    for row in rows)


# --- pictures

def png(rows, bits=8, color=0):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I",
                                                                              zlib.crc32(kind
                                                                                         + content))
    row = len(rows) // NY
    lines = b"".join(b"\0" + rows[i:i + row] for i in range(0, len(rows), row))
    palette = chunk(b"PLTE", bytes(range(0, 96)) * 8) if color == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR",
                                         struct.pack(">IIBBBBB", NX, NY, bits, color, 0, 0, 0)) +
            palette + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def bmp(rows, bits=8, top_down=False):
    colors = b"" if bits == 24 else b"".join(bytes([i, i, i, 0]) for i in range(2**bits))
    row = len(rows) // NY
    lines = [rows[i:i + row] + bytes(-row % 4) for i in range(0, len(rows), row)]
    start = 54 + len(colors)
    pixels = b"".join(lines if top_down else lines[::-1])
    return (struct.pack("<2sIII", b"BM", start + len(pixels), 0, start) +
            struct.pack("<IiiHHIIiiII", 40, NX, -NY if top_down else NY, 1, bits, 0, 0, 0, 0, 0,
                        0) +
            colors + pixels)


# --- all of them

# What is no volume that can be read; the others are.
REFUSED = ("beside.dat", "colour_dir", "complex.nii", "empty_dir", "filters.zarr", "flat.npy",
           "fortran.npy", "group.zarr", "half.npy", "jpeg.tif", "list.mhd", "long.mha",
           "mixed_dir", "pyhst_lone.vol", "sheared.nrrd", "text.nrrd", "two.hdf5", "uneven_dir",
           "version1.vol", "version3.zarr")


def numpy_files():
    files = {}
    for code, name in zip("BbHhIifd?qQ", ("|u1", "|i1", "u2", "i2", "u4", "i4", "f4", "f8", "|b1",
                                          "i8", "u8")):
        for order, letter in (("<", "little"), (">", "big")):
            if name[0] != "|":
                files[f"{name}_{letter}.npy"] = npy(order + name, samples(code, order))
            elif order == "<":
                files[f"{name[1:]}.npy"] = npy(name, samples(code))
    files["version2.npy"] = npy("|u1", samples("B"), version=2)
    files["fortran.npy"] = npy("|u1", samples("B"), fortran=True)
    files["flat.npy"] = npy("|u1", samples("B"), shape=f"({COUNT},)")
    files["half.npy"] = npy("<f2", samples("h"))
    return files


def header_files():
    byte, short, large = samples("B"), samples("h"), samples("h", ">")
    spacing = 'spacings: 0.0085 0.0085 0.0085\nunits: "mm" "mm" "mm"'
    directions = ("space dimension: 3\nspace directions: (0,8.5,0) (8.5,0,0) (0,0,-8.5)\n"
                  'space units: "um" "um" "um"\nspace origin: (1,2,3)')
    raw = "endian: little\nencoding: raw"
    files = {
        "raw.nrrd": nrrd("short", f"{spacing}\n{raw}", short),
        "big.nrrd": nrrd("int16", f"{directions}\nendian: big\nencoding: raw", large),
        "gzip.nrrd": nrrd("uchar", "Encoding: gzip", zipped(byte)),
        "skip.nrrd": nrrd("short", f"{raw}\nline skip: 2\nbyte skip: 3", b"one\ntwo\nxyz" + short),
        "end.nrrd": nrrd("short", f"{raw}\nbyteskip: -1", b"something else" + short),
        "float.nrrd": nrrd("float", raw, samples("f")),
        "beside.nhdr": nrrd("short", f"{raw}\ndata file: beside.dat"),
        "beside.dat": short,
        "text.nrrd": nrrd("short", "encoding: ascii", b"1 2 3"),
        "sheared.nrrd": nrrd("short", f"space directions: (1,0,0) (1,1,0) (0,0,1)\n{raw}", short),
        "local.mha": meta("MET_SHORT", "ElementSpacing = 0.0085 0.0085 0.0085\nBinaryData = True\n",
                          data=short),
        "big.mha": meta("MET_SHORT", "BinaryDataByteOrderMSB = True\n", data=large),
        "zlib.mha": meta("MET_UCHAR", "CompressedData = True\nCompressedDataSize = 9\n",
                         data=zlib.compress(byte)),
        "end.mha": meta("MET_SHORT", "HeaderSize = -1\n", data=b"xyz" + short),
        "beside.mhd": meta("MET_SHORT", "ElementSize = 2 2 2\n", "beside.dat"),
        "list.mhd": meta("MET_SHORT", "", "LIST"),
        "long.mha": meta("MET_LONG", "", data=short),
        "flat.mha": meta("MET_SHORT", "ElementSpacing = 1 1 2\n", data=short),
        "plain.isq": isq(short),
        "blocks.isq": isq(short, 3),
        "plain.nii": nifti(4, short, units=2, edge=0.0085),
        "big.nii": nifti(4, large, ">", units=3, edge=8.5),
        "scaled.nii": nifti(2, byte, slope=0.5, intercept=-3),
        "wide.nii": nifti(1024, samples("q")),
        "packed.nii.gz": zipped(nifti(512, samples("H"), units=1, edge=1e-5)),
        "complex.nii": nifti(32, samples("f") * 2),
        "version2.vol": dgtal("Voxel-Size: 1", 2, byte),
        "version3.vol": dgtal("Voxel-Size: 1", 3, zlib.compress(byte)),
        "version1.vol": dgtal("Voxel-Size: 1", 1, byte),
        "version2.longvol": dgtal("Lvoxel-Size: 4", 2, samples("I")),
        "version3.longvol": dgtal("Lvoxel-Size: 8", 3, zlib.compress(samples("Q"))),
    }
    for name, data, fields in (("float", samples("f"),
                                f"voxelSize = {UM}\nBYTEORDER = LOWBYTEFIRST\n"),
                               ("short", samples("H"), "ValMin = 1\n"),
                               ("byte", byte, "DATA_TYPE = uint8\n"),
                               ("big", samples("f", ">"), "BYTEORDER = HIGHBYTEFIRST\n")):
        files[f"pyhst_{name}.vol"] = data
        files[f"pyhst_{name}.vol.info"] = pyhst(fields)
    files["pyhst_lone.vol"] = byte
    files["hdf5.h5"] = hdf5(samples("H"), edge=UM)
    files["two.hdf5"] = hdf5(samples("H"), second=bytes(range(2)) * COUNT)
    return files


def tiff_files():
    byte = samples("B")
    imagej = f"ImageJ=1.53t\nimages={NZ}\nslices={NZ}\nunit=micron\nspacing={UM}\nloop=false\n"
    files = {"bits.tif": tiff(slices(bit_rows(samples("?"))), bits=1),
             "white.tif": tiff(slices(bit_rows(samples("?"))), bits=1, photometric=0),
             "imagej.tif": tiff(slices(byte), description=imagej, resolution=1 / UM),
             # ImageJ's stacks of 4 GB and more have one page, and all samples in one piece.
             "one_page.tif": tiff([byte], rows=NY * NZ, description=imagej, resolution=1 / UM),
             "tiled.tif": tiff(slices(samples("H")), bits=16, tile=16),
             "bigtiff.tif": tiff(slices(samples("I", ">")), bits=32, order=">", big=True),
             "jpeg.tif": tiff(slices(byte)).replace(struct.pack("<HHIHH", 259, 3, 1, 1, 0),
                                                    struct.pack("<HHIHH", 259, 3, 1, 7, 0))}
    for code, form in zip("BbHhIifd", (1, 2, 1, 2, 1, 2, 3, 3)):
        for order, name in (("<", "little"), (">", "big")):
            data = samples(code, order)
            files[f"{code}_{name}.tif" if code.islower() else f"u{code.lower()}_{name}.tif"] = tiff(
                slices(data), 8 * struct.calcsize(code), form, order)
    for number, name in ((5, "lzw"), (8, "deflate"), (32773, "packbits")):
        files[f"{name}.tif"] = tiff(slices(samples("H")), bits=16, compression=number)
    return files


def folders():
    """The files of each folder of slices and of each Zarr array."""
    byte, short = samples("B"), samples("H")
    gray = [b"".join(bytes([v, v, v]) for v in page) for page in slices(byte)]
    nibbles = [bytes(v % 16 for v in page) for page in slices(byte)]
    large = [samples("H", ">")[i:i + 2 * SLICE] for i in range(0, 2 * COUNT, 2 * SLICE)]
    log = f"[System]\nImage Pixel Size (um)= 99\n[Reconstruction]\nPixel Size (um)={UM}\n".encode()

    def numbered(pages, ending):
        return {f"slice{z + 8}.{ending}": page for z, page in enumerate(pages)}
    result = {
        "png_dir": {**numbered([png(p) for p in slices(byte)], "png"), "scan.log": log},
        "png16_dir": numbered([png(p, bits=16) for p in large], "png"),
        "png1_dir": numbered([png(p, bits=1) for p in slices(bit_rows(samples("?")))], "png"),
        "palette_dir": numbered([png(p, color=3) for p in slices(byte)], "png"),
        "grey_dir": numbered([png(p, color=2) for p in gray], "png"),
        "colour_dir": numbered([png(p[1:] + p[:1], color=2) for p in gray], "png"),
        "bmp_dir": {**numbered([bmp(p) for p in slices(byte)], "bmp"), "scan.log": log},
        "bmp24_dir": numbered([bmp(p, 24) for p in gray], "bmp"),
        "bmp1_dir": numbered([bmp(p, 1, top_down=True) for p in slices(bit_rows(samples("?")))],
                             "bmp"),
        "bmp4_dir": numbered([bmp(b"".join(bytes([a << 4 | b for a, b in zip(
            row[::2], row[1::2] + b"\0" * (NX % 2))])
            for row in (page[i:i + NX] for i in range(0, SLICE, NX))), 4) for page in nibbles],
            "bmp"),
        "tiff_dir": {**numbered([tiff([p]) for p in slices(byte)], "tif"), "scan.log": log},
        "mixed_dir": {"a.png": png(slices(byte)[0]), "b.bmp": bmp(slices(byte)[0])},
        "uneven_dir": {"a.png": png(slices(byte)[0]), "b.png": png(large[0], bits=16)},
        "empty_dir": {"notes.txt": b"no slices here\n"},
        "plain.zarr": zarr("|u1", byte),
        "zlib.zarr": zarr("<u2", short, '{"id": "zlib", "level": 1}', separator="/"),
        "gzip.zarr": zarr(">u2", samples("H", ">"), '{"id": "gzip", "level": 1}', order="F"),
        "blosc.zarr": zarr("<u2", short, '{"id": "blosc", "cname": "lz4"}', leading=2),
        "wide.zarr": zarr("<i8", samples("q"), chunk=(11, 7, 2)),
        "sparse.zarr": zarr("<u2", short, skip=[(0, 0, 0), (2, 1, 1)]),
        "filters.zarr": {name: data.replace(b'"filters": null', b'"filters": [{"id": "delta"}]')
                         for name, data in zarr("|u1", byte).items()},
    }
    result["ome.zarr"] = {".zgroup": b'{"zarr_format": 2}', ".zattrs": ome_zarr("0"),
                          **{f"0/{name}": data
                             for name, data in zarr("<u2", short, leading=1).items()}}
    result["group.zarr"] = {".zgroup": b'{"zarr_format": 2}',
                            **{f"{array}/{name}": data for array in "ab"
                               for name, data in zarr("|u1", byte).items()}}
    result["version3.zarr"] = {"zarr.json": b'{"zarr_format": 3, "node_type": "array"}'}
    return result


def plain_files():
    """What is no volume, and what is RAW."""
    state, garbage = 1, bytearray()
    for _ in range(3000):
        state = (state * 1664525 + 1013904223) % 2**32
        garbage.append(state >> 24)
    files = {"small.raw": samples("B"), "short.raw": samples("H"),
             "short_big.raw": samples("H", ">"), "float.raw": samples("f"),
             "nan.raw": struct.pack("<4f", 0, 1, float("nan"), 0),
             "half.raw": struct.pack("<4f", 0, 1, 1.5, 0),
             "huge.raw": struct.pack("<4f", 0, 1, 3e9, 0),
             "left.raw": struct.pack("<4f", 1, 1, 0, 0),
             "right.raw": struct.pack("<4f", 0, 0, 1, 1), "solid.raw": b"\1" * 40**3}
    for ending in ("vdb", "tif", "mhd", "mha", "nrrd", "npy", "png", "bmp", "isq", "nii", "nii.gz",
                   "vol", "longvol", "info", "h5", "raw", "xyz"):
        files["empty." + ending] = b""
        files["garbage." + ending] = bytes(garbage)
    return files


def write_all(folder):
    """Below `folder`. Returns the names of images (files and folders) and of VDB files."""
    images = {**numpy_files(), **header_files(), **tiff_files()}
    grids = hand_made_vdb.vdb_files()
    inside = folders()
    nested = {f"{name}/{file}": data for name, files in inside.items()
              for file, data in files.items()}
    for name, data in {**images, **grids, **nested, **plain_files()}.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(data)
    return sorted(images) + sorted(inside), sorted(grids)
