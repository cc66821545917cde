# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""h5py reads our labels, and our tables as they are in CSV and JSON."""

import csv
import json
import subprocess

from proof import Bench, SIZE, check, skip, values

try:
    import h5py
    import numpy as np
except ImportError as error:
    skip(f"what h5py reads: python3-h5py is not installed ({error})")

SUFFIXES = {"": "", "mm": "_mm", "mm^2": "_mm2", "mm^3": "_mm3", "1/mm": "_per_mm",
            "1/mm^2": "_per_mm2"}


def check_columns(group, rows, table):
    """Names in order, units, and numbers to the nine digits of the CSV."""
    names = [name + SUFFIXES[group[name].attrs.get("units", b"").decode()] for name in group]
    check(names == rows[0], f"{table}: {names}")
    for i, name in enumerate(group):
        wanted = np.array([float(row[i] or "nan") for row in rows[1:]])
        check(np.allclose(group[name][...], wanted, rtol=1e-8, atol=0, equal_nan=True),
              f"{table}/{name}")


def plain(thing):
    """A group or a dataset, as JSON has it."""
    if isinstance(thing, h5py.Group):
        return {name: plain(member) for name, member in thing.items()}
    value = thing[()]
    if isinstance(value, bytes):
        return value.decode()
    return json.loads(json.dumps(value.tolist()).replace("NaN", "null"))


with Bench() as bench:
    path = bench.run("convert", "labels.h5", "--out-type", "int32")
    with h5py.File(path) as file:
        data = file["data"]
        check(data.shape == SIZE[::-1] and data.dtype == np.int32, f"data is {data}")
        check(data[...].reshape(-1).tolist() == values(), "the labels differ")
        check(list(data.attrs["element_size_um"]) == [10, 10, 10], "the voxel size")
    check(open(bench.run("convert", "labels.npy", source="labels.h5"), "rb").read() ==
          open(bench.run("convert", "direct.npy"), "rb").read(), "what we read of it")
    bench.segment_sintered(60, 10)
    for out in ("tables", "tables.h5"):
        subprocess.run([bench.tool, "measure", bench.path("grains.vdb"), bench.path(out), "-q",
                        "--ice"], check=True)
    with h5py.File(bench.path("tables.h5")) as file:
        for table in ("grains", "bonds"):
            with open(bench.path(f"tables/{table}.csv"), newline="") as text:
                check_columns(file[table], list(csv.reader(text)), table)
        with open(bench.path("tables/sample.json")) as text:
            wanted = json.load(text)
        found = plain(file["sample"])
        check(found == wanted and list(found) == list(wanted), "the members of the sample")
print("h5py reads labels and tables in HDF5")
