# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The body that tests/benchmark gives the watersheds is the one that `segment` has at its
defaults."""

import json
import pathlib
import subprocess
import sys

from proof import Bench, check, skip

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "benchmark"))
try:
    import numpy
    from scipy import ndimage
    from evaluation import watershed
except ImportError as error:
    skip(f"the holes that are filled: {error} (tools/setup --tests)")


def samples():
    """Objects [z, y, x]: with many cavities at faces and inside, thin ones, and all but solid
    ones, of which nothing is filled."""
    random = numpy.random.default_rng(1)
    for share in 0.3, 0.6, 0.75:
        yield f"{share} of all voxels", random.random((30, 41, 35)) < share
    ball = numpy.linalg.norm(numpy.indices((40, 44, 42)).T - 20, axis=3).T < 15
    yield "a ball in noise", ball ^ (random.random(ball.shape) < 0.1)
    for shape in (1, 41, 35), (30, 1, 35), (30, 41, 1), (2, 41, 35):
        yield f"edges {shape}", random.random(shape) < 0.6
    for at in [(4, 4, 4)], [(4, 4, 4), (0, 2, 8)]:
        solid = numpy.ones((9, 9, 9), bool)
        solid[tuple(zip(*at))] = False
        yield f"all but {at}", solid


def main():
    with Bench() as bench:
        for name, solid in samples():
            numpy.save(bench.path("object.npy"), solid.astype(numpy.uint8))
            subprocess.run([bench.tool, "segment", bench.path("object.npy"),
                            bench.path("grains.vdb"), "--json", bench.path("it.json"), "-q"],
                           check=True)
            with open(bench.path("it.json")) as file:
                its = json.load(file)
            filled = watershed.filled(solid) & ~solid
            ours, theirs = ((its["cavities"], its["cavity_voxels"]),
                            (ndimage.label(filled)[1], int(filled.sum())))
            check(ours == theirs, f"{name}: cavities and voxels are {ours}, not {theirs}")
    print("cavities and their voxels are those of segment")


if __name__ == "__main__":
    main()
