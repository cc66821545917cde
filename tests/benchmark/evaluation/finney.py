"""Equal balls at measured centers, for tests/benchmark/accuracy and packs: the random close packing
of ball bearings of J. L. Finney, "Random packings and the structure of simple liquids", Proc. R.
Soc. Lond. A 319 (1970) 479-493 (Digital Rocks Portal, project 47), finney.txt: lines `id x y z`,
centers in units of the radius, about the middle of the pack.

The file is looked for in the folder $VDB_MADF_DATA, without it in ../shared/data beside the
project.
"""
import os
import pathlib

import numpy

EDGE = 9.7  # of the cube, in radii
MIDDLE = 6  # radii; the middle of the cube is no farther from that of the pack

DATA = pathlib.Path(os.environ.get("VDB_MADF_DATA")
                    or pathlib.Path(__file__).resolve().parents[4] / "shared" / "data")
FILE = DATA / "finney.txt"


def centers():
    return numpy.loadtxt(FILE, usecols=(1, 2, 3))


def some(radius, inflated, seed):
    """The balls of a cube within the pack, some 140, as a list for `vdb_madf generate balls`; the
    seed and the radius in voxels say where it lies."""
    random = numpy.random.default_rng([seed, radius])
    middle = random.uniform(-1, 1, 3)
    middle *= MIDDLE / numpy.linalg.norm(middle) * random.random() ** (1 / 3)
    places = centers() - middle
    places = places[(numpy.abs(places) < EDGE / 2).all(axis=1)]
    return "".join(f"{x} {y} {z} {inflated}\n" for x, y, z in places)
