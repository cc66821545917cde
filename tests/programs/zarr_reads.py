# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Programs that know Zarr read our OME-Zarr: every level, voxel by voxel, against NumPy.

    zarr_reads.py COMMAND zarr       Python's zarr module, OME-Zarr 0.4
    zarr_reads.py COMMAND zarrita    zarrita, for browsers, by node: 0.4 to 0.6; and the command
                                     reads Zarr 3 that zarrita writes by each codec that it can

zarrita is looked for in the folder that VDB_MADF_ZARRITA names (`npm install zarrita` there).
"""

import hashlib
import json
import os
import shutil
import subprocess
import sys

from proof import Bench, check, skip

try:
    import numpy as np
except ImportError:
    skip("what reads Zarr: python3-numpy is not installed")

SHAPE = (70, 50, 150)  # z, y, x
LEVELS = 3
EDGES = (1.5, 2, 4)  # um: z, y, x


def labels():
    """Boxes of labels, in noise; large labels, and odd sizes."""
    random = np.random.RandomState(1)
    volume = np.zeros(SHAPE, np.int32)
    for label in (1, 2, 3, 4, 5, 70000, 2147483647):
        low = [random.randint(n - 20) for n in SHAPE]
        volume[tuple(slice(l, l + random.randint(5, 40)) for l in low)] = label
    return np.where(random.rand(*SHAPE) < 0.15, 0, volume).astype("<u4")


def level(volume, factor):
    """The most frequent value of those voxels of each block that lie in the volume, of equally
    frequent ones the smallest; and the part of these that is labeled, as 0 to 255."""

    def count(there):
        padded = np.pad(there, [(0, -n % factor) for n in there.shape])
        shape = [n // factor for n in padded.shape]
        blocks = padded.reshape(shape[0], factor, shape[1], factor, shape[2], factor)
        return blocks.sum(axis=(1, 3, 5))

    values = np.unique(volume)  # ascending; argmax takes the first
    most = values[np.argmax([count(volume == value) for value in values], axis=0)]
    part = np.floor(255 * count(volume > 0) / count(np.ones_like(volume)) + 0.5)
    return most.astype("<u4"), part.astype("u1")


def wanted():
    """Array of each level, by its path."""
    arrays, volume = {}, labels()
    for number in range(LEVELS):
        arrays[f"labels/grain/{number}"], arrays[str(number)] = level(volume, 2**number)
    return arrays


def write(bench, version):
    np.save(bench.path("labels.npy"), labels().astype("<i4"))
    path = bench.path(f"v{version}.ome.zarr")
    subprocess.run([bench.tool, "export", bench.path("labels.npy"), path, "--ome", version, "-q",
                    "--voxel-size", "x".join(f"{e}" for e in reversed(EDGES)) + "um"], check=True)
    return path


def check_attributes(attributes, name):
    image = attributes["multiscales"][0]
    system = image["coordinateSystems"][0] if name == "0.6" else image
    check([axis["name"] for axis in system["axes"]] == ["z", "y", "x"], f"{name}: axes")
    check(len(image["datasets"]) == LEVELS, f"{name}: levels")
    for number, dataset in enumerate(image["datasets"]):
        steps = dataset["coordinateTransformations"]
        scale, translation = steps[0]["transformations"] if name == "0.6" else steps
        check(scale["scale"] == [e * 2**number for e in EDGES], f"{name}: {scale}")
        check(translation["translation"] == [e * (2**number - 1) / 2 for e in EDGES],
              f"{name}: {translation}")


def proof_zarr(bench):
    try:
        import zarr
    except ImportError:
        skip("what Python's zarr reads: python3-zarr is not installed")
    group = zarr.open_group(write(bench, "0.4"), mode="r")
    for name, array in wanted().items():
        check(group[name].dtype == array.dtype, f"{name}: {group[name].dtype}")
        check(group[name].shape == array.shape and (group[name][:] == array).all(), name)
    for name in ("/", "labels/grain"):
        check_attributes(group[name].attrs, name)
    ids = sorted(int(i) for i in np.unique(labels()) if i)
    properties = group["labels/grain"].attrs["image-label"]["properties"]
    check([one["label-value"] for one in properties] == ids, "properties")
    counts = dict(zip(*np.unique(labels(), return_counts=True)))
    check(all(one["voxels"] == counts[one["label-value"]] for one in properties), "voxels")
    print("Python's zarr reads OME-Zarr 0.4")


READ = """
import * as zarr from "zarrita";
import { FileSystemStore } from "@zarrita/storage";
import { createHash } from "node:crypto";
const [path, ...names] = process.argv.slice(2);
const root = await zarr.open(new FileSystemStore(path), { kind: "group" });
const found = { attributes: root.attrs, arrays: {} };
for (const name of names) {
  const array = await zarr.open(root.resolve(name), { kind: "array" });
  const { data } = await zarr.get(array);
  const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  found.arrays[name] = [array.dtype, array.shape, createHash("sha256").update(bytes).digest("hex")];
}
console.log(JSON.stringify(found));
"""


WRITE = """
import * as zarr from "zarrita";
import { FileSystemStore } from "@zarrita/storage";
import { readFileSync } from "node:fs";
const [folder, samples, ...shape] = process.argv.slice(2);
// (zarrita itself only reads gzip.)
zarr.registry.set("gzip", () => import("numcodecs/gzip").then((module) => module.default));
const bytes = (endian) => ({ name: "bytes", configuration: { endian } });
const named = {
  little: [bytes("little")],
  big: [bytes("big")],
  transposed: [{ name: "transpose", configuration: { order: [1, 2, 0] } }, bytes("little")],
  gzip: [bytes("little"), { name: "gzip", configuration: { level: 5 } }],
  zstd: [bytes("little"), { name: "zstd", configuration: { level: 3, checksum: true } }],
  blosc: [bytes("little"), { name: "blosc", configuration: {
    cname: "lz4", clevel: 5, shuffle: 1, blocksize: 0 } }],  // 1: numcodecs' number for it
};
const file = readFileSync(samples);
const data = new Uint32Array(file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength));
for (const [name, codecs] of Object.entries(named)) {
  const array = await zarr.create(new FileSystemStore(`${folder}/${name}.zarr`), {
    shape: shape.map(Number), chunkShape: [32, 50, 17], dtype: "uint32", codecs, fillValue: 0,
    chunkSeparator: name == "big" ? "." : "/" });
  const stride = [array.shape[1] * array.shape[2], array.shape[2], 1];
  await zarr.set(array, null, { data, shape: array.shape, stride });
}
console.log(JSON.stringify(Object.keys(named)));
"""


def run_zarrita(script, *arguments):
    """What a script prints that uses zarrita, as JSON."""
    folder = os.environ.get("VDB_MADF_ZARRITA", "")
    if not shutil.which("node"):
        skip("what zarrita reads: nodejs is not installed")
    if not os.path.isdir(os.path.join(folder, "node_modules", "zarrita")):
        skip("what zarrita reads: VDB_MADF_ZARRITA names no folder with it (npm install zarrita)")
    # (Modules are looked for from the current folder on.)
    result = subprocess.run(["node", "--input-type=module", "-", *arguments], input=script,
                            cwd=folder, capture_output=True, text=True)
    check(result.returncode == 0, f"zarrita: {result.stderr}")
    return json.loads(result.stdout)


def proof_zarrita(bench):
    for version in ("0.4", "0.5", "0.6"):
        found = run_zarrita(READ, write(bench, version), *wanted())
        attributes = found["attributes"]
        check_attributes(attributes if version == "0.4" else attributes["ome"], version)
        for name, array in wanted().items():
            digest = hashlib.sha256(array.tobytes()).hexdigest()
            check(found["arrays"][name] == [str(array.dtype), list(array.shape), digest],
                  f"{version}: {name}: {found['arrays'][name]}")
    labels().tofile(bench.path("labels.raw"))
    for name in run_zarrita(WRITE, bench.folder, bench.path("labels.raw"), *map(str, SHAPE)):
        subprocess.run([bench.tool, "convert", bench.path(f"{name}.zarr"), bench.path("read.npy"),
                        "--type", "uint32", "-q"], check=True)
        check((np.load(bench.path("read.npy")) == labels()).all(), f"what zarrita wrote: {name}")
    print("zarrita reads OME-Zarr 0.4, 0.5 and 0.6; we read what it writes")


with Bench() as bench:
    {"zarr": proof_zarr, "zarrita": proof_zarrita}[sys.argv[2]](bench)
