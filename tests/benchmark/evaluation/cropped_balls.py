"""Balls as in the fifth row of the paper's Table 1 (a), which `generate spheres` cannot make: of
the paper's number and radii they would, wholly inside the cube, fill more than the cube.

Integer centers anywhere in the cube, balls cropped by it; real radii uniform in [low, high]; open
balls |p - c| < r. |Bi| counts the voxels inside the cube. overlap = (sum |Bi| - |X|) / |X| is met
within 1 %: starting from uniform centers, single balls move to uniform places whenever this brings
the overlap nearer. Each ball has the least power at its own center, |ci - cj|^2 > |ri^2 - rj^2|, so
that none is swallowed. Arrays are [z, y, x].
"""
import random

import numpy


def boxes(balls, size, step=1):
    """For each ball its slices of the cube, and |p - c|^2 - r^2 there; on every step-th voxel."""
    for center, radius in balls:
        ranges = [range(max(0, -int((radius - c) // step)),
                        min(-(-size // step), int((c + radius) // step) + 1))
                  for c in center]
        axes = [(numpy.arange(r.start, r.stop) * step - c) ** 2.0 for r, c in zip(ranges, center)]
        power = axes[0][:, None, None] + axes[1][:, None] + axes[2] - radius**2
        yield tuple(slice(r.start, r.stop) for r in ranges), power


def overlap(balls, size, step=1):
    cover = numpy.zeros((-(-size // step),) * 3, numpy.uint8)
    for box, power in boxes(balls, size, step):
        cover[box] += power < 0
    return cover.sum(dtype=numpy.int64) / numpy.count_nonzero(cover) - 1


def swallowed(balls, i):
    (center, radius) = balls[i]
    return any(sum((a - b) ** 2 for a, b in zip(center, other)) <= abs(radius**2 - r**2)
               for j, (other, r) in enumerate(balls) if j != i)


def place(balls, i, size, rng):
    """Moves ball i to a uniform place where none swallows it, nor it another."""
    for _ in range(100000):
        balls[i] = (tuple(int(rng.random() * size) for _ in range(3)), balls[i][1])
        if not swallowed(balls, i):
            return
    raise RuntimeError("the balls do not fit")


def labels(size, count, low, high, target, seed):
    """The true grains (int32, 0: background): the power map of the balls; and the overlap
    reached."""
    rng = random.Random(seed)
    radii = sorted((low + (high - low) * rng.random() for _ in range(count)), reverse=True)
    balls = []
    for radius in radii:
        balls.append((None, radius))
        place(balls, len(balls) - 1, size, rng)
    step = 4
    reached = overlap(balls, size)
    coarse, aim = overlap(balls, size, step), target
    for _ in range(100):
        for _ in range(20000):  # on every 4th voxel, then checked on all
            if abs(coarse - aim) < 0.003 * target:
                break
            i = int(rng.random() * count)
            before = balls[i]
            place(balls, i, size, rng)
            moved = overlap(balls, size, step)
            if abs(moved - aim) < abs(coarse - aim):
                coarse = moved
            else:
                balls[i] = before
        reached = overlap(balls, size)
        if abs(reached - target) < 0.01 * target:
            break
        aim += target - reached
    else:
        raise RuntimeError("the overlap is not met")
    least = numpy.zeros((size,) * 3)
    truth = numpy.zeros((size,) * 3, numpy.int32)
    for label, (box, power) in enumerate(boxes(balls, size), 1):
        nearer = power < least[box]
        least[box][nearer] = power[nearer]
        truth[box][nearer] = label
    return truth, reached
