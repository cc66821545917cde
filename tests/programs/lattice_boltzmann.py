# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Fluid flows through a geometry for Palabos, in a small solver of our own that reads it: the
permeability of a cubic array of balls is the published one, that of a bed of balls, across the way
that they fell, Kozeny and Carman's.

  lattice_boltzmann.py PROGRAM [AXES]      AXES: along which fluid flows through a larger bed

Zick and Homsy (1982, J. Fluid Mech. 115) give the drag of a ball in such an array, in units of
Stokes' 6 pi mu r U, from 2.008 at a solid fraction of 0.027 to 15.4 at 0.343; the permeability is
2 r^2 / (9 c K). Of balls of diameter d with pores of share e it is e^3 d^2 / (C (1 - e)^2), where
the constant is empirical: 180 by Carman, 150 by Ergun. Palabos itself is in no Debian package: it
was not run.
"""

import itertools
import math
import subprocess
import sys

from proof import Bench, check, skip

try:
    import numpy
except ImportError as error:
    skip(f"the flow through our geometry: python3-numpy is not installed ({error})")

DRAG = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4}
SIZE = 16
# Lattice of 19 velocities; two relaxation times with the product 3/16, for which walls lie halfway
# between voxels (Ginzburg & d'Humieres 2003).
VELOCITIES = [v for v in itertools.product((-1, 0, 1), repeat=3) if sum(map(abs, v)) <= 2]
WEIGHTS = [(1 / 3, 1 / 18, 1 / 36)[sum(map(abs, v))] for v in VELOCITIES]
OPPOSITE = [VELOCITIES.index(tuple(-c for c in v)) for v in VELOCITIES]
TAU_EVEN = 1.0
TAU_ODD = 0.5 + 3 / 16 / (TAU_EVEN - 0.5)
FORCE = 1e-5


def permeability(solid):
    """Along the first axis of a box that goes on as its mirror image, in voxels squared."""
    # All that is computed is linear (Stokes flow) and taken from the fluid at rest.
    velocity, weights = numpy.array(VELOCITIES, float), numpy.array(WEIGHTS)
    same, opposite = numpy.eye(19), numpy.eye(19)[OPPOSITE]
    even_rest = numpy.outer(weights, numpy.ones(19))
    odd_rest = 3 * weights[:, None] * (velocity @ velocity.T)
    collide = (same - ((same + opposite) / 2 - even_rest) / TAU_EVEN -
               ((same - opposite) / 2 - odd_rest) / TAU_ODD)
    push = (3 * FORCE * weights * velocity[:, 0])[:, None]

    # Where what arrives in a voxel comes from: a way and a voxel, as an index.
    place = numpy.argwhere(~solid)
    count = len(place)
    number = numpy.full(solid.shape, -1)
    number[~solid] = numpy.arange(count)
    ways = numpy.full((3, 3, 3), -1)
    ways[tuple(numpy.array(VELOCITIES).T)] = numpy.arange(19)
    source, sign = numpy.empty((19, count), int), numpy.ones((19, count))
    for i, v in enumerate(VELOCITIES):
        there = place - v
        outside = (there < 0) | (there >= solid.shape)
        way = ways[tuple(numpy.where(outside, [-c for c in v], v).T)]
        voxel = number[tuple(numpy.clip(there, 0, numpy.array(solid.shape) - 1).T)]
        # What would come out of a wall is what went towards it.
        wall = voxel < 0
        source[i] = numpy.where(wall, OPPOSITE[i] * count + numpy.arange(count),
                                way * count + voxel)
        # In a mirror across the flow it runs the other way.
        sign[i] = numpy.where(outside[:, 0] & ~wall, -1, 1)

    populations = numpy.zeros((19, count))
    found, before = 0, -1
    while abs(found - before) > 1e-3 * found:
        before = found
        for _ in range(50):
            populations = (collide @ populations + push).ravel()[source] * sign
        flux = (velocity[:, 0] @ populations).sum() + count * FORCE / 2
        found = flux / solid.size * (TAU_EVEN - 0.5) / 3 / FORCE
    return found


with Bench() as bench:
    for fraction in (0.064, 0.216):
        radius = SIZE * (3 * fraction / 4 / math.pi)**(1 / 3)
        grid = numpy.indices((SIZE,) * 3) - (SIZE - 1) / 2
        numpy.save(bench.path("ball.npy"), ((grid**2).sum(0) < radius**2).astype(numpy.int32))
        with open(bench.run("export", "ball.dat", "--as", "palabos", source="ball.npy")) as file:
            cells = numpy.array(file.read().split(), int).reshape((SIZE,) * 3)
        check(0 < (cells == 2).sum() < (cells == 1).sum(), "walls around the inside")
        solid = (cells > 0).mean()
        true_radius = SIZE * (3 * solid / 4 / math.pi)**(1 / 3)
        drag = math.exp(numpy.interp(solid**(1 / 3), [c**(1 / 3) for c in DRAG],
                                     [math.log(k) for k in DRAG.values()]))
        expected = 2 * true_radius**2 / (9 * solid * drag)
        found = permeability(cells > 0)
        print(f"balls that fill {solid:.4f}: permeability {found:.4f}, published {expected:.4f}")
        check(abs(found / expected - 1) < 0.05, "the permeability of balls")
    # A pack that the command makes, well above its floor.
    size, radius = 72 if len(sys.argv) > 2 else 48, 6
    subprocess.run([bench.tool, "generate", "bed", bench.path("bed.npy"), "--rounds", "0", "--dims",
                    f"{size}x{size}x{size + 6 * radius}", "--radius", f"{radius}:{radius}", "-q"],
                   check=True)
    with open(bench.run("export", "bed.dat", "--as", "palabos", source="bed.npy")) as file:
        cells = numpy.array(file.read().split(), int).reshape(size, size, size + 6 * radius)
    solid = cells[:, :, 3 * radius:][:, :, :size] > 0
    share = solid.mean()
    for name in sys.argv[2] if len(sys.argv) > 2 else "x":
        found = permeability(solid.swapaxes(0, "xyz".index(name)))
        constant = (1 - share)**3 * (2 * radius)**2 / (found * share**2)
        print(f"a bed that fills {share:.4f}: permeability along {name} {found:.4f}, "
              f"constant {constant:.0f}")
        # Along z, the way that the balls fell, flow is easier, and nobody says by how much.
        check(name == "z" or 150 < constant < 180, "the permeability of a bed")
print("fluid flows through our geometry as it should")
