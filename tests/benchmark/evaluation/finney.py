"""Equal balls at measured centers, for tests/benchmark/accuracy: the random close packing of ball
bearings of J. L. Finney, "Random packings and the structure of simple liquids", Proc. R. Soc. Lond.
A 319 (1970) 479-493 (Digital Rocks Portal, project 47), finney.txt: lines `id x y z`, centers in
units of the radius, about the middle of the pack.

The file is looked for in the folder $VDB_MADF_DATA, without it in ../shared/data beside the
project. A sample is a cube within the pack, and has the balls whose centers lie in it, some 140;
the seed says where it lies. Truth: the ball of nearest center. Arrays are [z, y, x].
"""
import os
import pathlib

import numpy
from scipy import ndimage, spatial

EDGE = 9.7  # of the cube, in radii
MIDDLE = 6  # radii; the middle of the cube is no farther from that of the pack
TRUE = 2  # voxels; what noise puts farther from a ball has no true grain

DATA = pathlib.Path(os.environ.get("VDB_MADF_DATA")
                    or pathlib.Path(__file__).resolve().parents[4] / "shared" / "data")
FILE = DATA / "finney.txt"


def sample(radius, inflated, blur, noise, seed):
    """The object (bool) and its true grains (int32): balls of a radius in voxels, then inflated by
    a factor; or blurred, with noise added, and cut at 0.5."""
    random = numpy.random.default_rng([seed, radius])
    centers = numpy.loadtxt(FILE, usecols=(1, 2, 3))
    middle = random.uniform(-1, 1, 3)
    middle *= MIDDLE / numpy.linalg.norm(middle) * random.random() ** (1 / 3)
    edge = round(EDGE * radius)
    places = (centers - middle) * radius + (edge - 1) / 2
    places = places[((places >= -0.5) & (places < edge - 0.5)).all(axis=1)]
    places = places[numpy.lexsort(places.T)]
    voxels = numpy.stack(numpy.meshgrid(*[numpy.arange(edge)] * 3, indexing="ij"), axis=-1)
    distance, nearest = spatial.cKDTree(places).query(voxels)
    solid = distance < radius * inflated
    if blur:
        gray = ndimage.gaussian_filter(solid.astype(float), blur)
        solid = gray + noise * random.normal(size=gray.shape) > 0.5
    near = solid & (distance < radius * inflated + TRUE)
    return solid, numpy.where(near, nearest + 1, 0).astype(numpy.int32)
