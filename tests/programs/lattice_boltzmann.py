# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Fluid flows through a geometry for Palabos, in a small solver of our own that reads it: the
permeability of a cubic array of balls is the published one.

Zick and Homsy (1982, J. Fluid Mech. 115) give the drag of a ball in such an array, in units of
Stokes' 6 pi mu r U, from 2.008 at a solid fraction of 0.027 to 15.4 at 0.343; the permeability is
2 r^2 / (9 c K). Palabos itself is in no Debian package: it was not run.
"""

import itertools
import math

from proof import Bench, check, skip

try:
    import numpy
except ImportError as error:
    skip(f"the flow through our geometry: python3-numpy is not installed ({error})")

DRAG = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4}
SIZE = 16
STEPS = 700
# Lattice of 19 velocities; two relaxation times with the product 3/16, for which walls lie halfway
# between voxels (Ginzburg & d'Humieres 2003).
VELOCITIES = [v for v in itertools.product((-1, 0, 1), repeat=3) if sum(map(abs, v)) <= 2]
WEIGHTS = [(1 / 3, 1 / 18, 1 / 36)[sum(map(abs, v))] for v in VELOCITIES]
OPPOSITE = [VELOCITIES.index(tuple(-c for c in v)) for v in VELOCITIES]
TAU_EVEN = 1.0
TAU_ODD = 0.5 + 3 / 16 / (TAU_EVEN - 0.5)
FORCE = 1e-5


def permeability(cells):
    """Of a periodic box, along its first axis, in voxels squared; 0 is fluid, 1 a wall."""
    fluid, wall = cells == 0, cells == 1
    velocity = numpy.array(VELOCITIES, float)
    weights = numpy.array(WEIGHTS)
    populations = numpy.ones((19,) + cells.shape) * weights[:, None, None, None]
    for _ in range(STEPS):
        density = populations.sum(0)
        momentum = numpy.tensordot(velocity.T, populations, 1)
        momentum[0] += FORCE / 2
        opposite = populations[OPPOSITE]
        even, odd = (populations + opposite) / 2, (populations - opposite) / 2
        # Stokes flow: the equilibrium is linear in the momentum.
        even_rest = weights[:, None, None, None] * density
        odd_rest = 3 * weights[:, None, None, None] * numpy.tensordot(velocity, momentum, 1)
        push = (3 * FORCE * weights * velocity[:, 0])[:, None, None, None]
        after = (populations - (even - even_rest) / TAU_EVEN - (odd - odd_rest) / TAU_ODD +
                 push * (1 - 1 / (2 * TAU_ODD)))
        for i, v in enumerate(VELOCITIES):
            moved = numpy.roll(after[i], v, (0, 1, 2))
            # What would come out of a wall is what went towards it.
            populations[i] = numpy.where(numpy.roll(wall, v, (0, 1, 2)), after[OPPOSITE[i]], moved)
    momentum = numpy.tensordot(velocity.T, populations, 1)
    momentum[0] += FORCE / 2
    viscosity = (TAU_EVEN - 0.5) / 3
    return momentum[0][fluid].sum() / cells.size * viscosity / FORCE


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
        found = permeability(cells)
        print(f"balls that fill {solid:.4f}: permeability {found:.4f}, published {expected:.4f}")
        check(abs(found / expected - 1) < 0.05, "the permeability of balls")
print("fluid flows through our geometry as it should")
