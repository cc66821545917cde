"""A bed of sintered balls with known grains: its necks grow by curvature flow, not by overlap.

Balls of real radii, uniform in [low, high], fall into a box one after the other, each straight down at the
one of PLACES uniform places (x, y) where it comes to lie lowest, until none lies below the top. Balls touch
at CLOSE times the sum of their radii, continue beyond the sides, and are cropped by the faces. Then the
object is sintered in rounds: its indicator is blurred by a Gaussian of SIGMA voxels and cut at the level
that keeps the number of voxels, which moves the surface as its mean curvature less the average of that
says: necks fill, tips recede, the volume stays. After each round a voxel has the label of the voxel of the
round before that is nearest. Arrays are [z, y, x].
"""
import numpy
from scipy import ndimage

PLACES = 300
CLOSE = 0.97
SIGMA = 2  # voxels


def balls(size, low, high, rng):
    """Centers (x, y, z) and radii, in the order of their fall."""
    centers, radii = numpy.empty((0, 3)), numpy.empty(0)
    while True:
        radius = rng.uniform(low, high)
        places = rng.uniform(0, size, (PLACES, 2))
        aside = ((places[:, None] - centers[None, :, :2]) ** 2).sum(axis=2)
        rise = (CLOSE * (radius + radii)) ** 2 - aside
        rests = numpy.where(rise > 0, centers[:, 2] + numpy.sqrt(numpy.maximum(rise, 0)), 0)
        heights = rests.max(axis=1, initial=radius)
        lowest = heights.argmin()
        if heights[lowest] - radius > size:
            return centers, radii
        centers = numpy.vstack([centers, [*places[lowest], heights[lowest]]])
        radii = numpy.append(radii, radius)


def power_cells(size, centers, radii):
    """The union of balls, each voxel labelled by the ball of least power."""
    least = numpy.zeros((size,) * 3)
    labels = numpy.zeros((size,) * 3, numpy.int32)
    for label, (center, radius) in enumerate(zip(centers, radii), 1):
        ranges = [range(max(0, int(numpy.ceil(c - radius))), min(size, int(c + radius) + 1)) for c in center]
        x, y, z = ((numpy.array(r, float) - c) ** 2 for r, c in zip(ranges, center))
        box = tuple(slice(r.start, r.stop) for r in reversed(ranges))
        power = z[:, None, None] + y[:, None] + x - radius**2
        nearer = power < least[box]
        least[box][nearer] = power[nearer]
        labels[box][nearer] = label
    return labels


def sintered(labels):
    """One round of curvature flow."""
    gray = ndimage.gaussian_filter((labels > 0).astype(numpy.float64), SIGMA, mode="nearest")
    background = labels.size - numpy.count_nonzero(labels)
    level = numpy.partition(gray, background, axis=None)[background]
    nearest = ndimage.distance_transform_edt(labels == 0, return_distances=False, return_indices=True)
    return numpy.where(gray >= level, labels[tuple(nearest)], 0).astype(numpy.int32)


def bed(size, low, high, rounds, seed):
    """The true grains (int32, 0: background)."""
    labels = power_cells(size, *balls(size, low, high, numpy.random.Generator(numpy.random.PCG64(seed))))
    for _ in range(rounds):
        labels = sintered(labels)
    return labels
