"""Noise as of a CT scan for a sample with known grains, and which of its voxels are still true.

The indicator of the object (0, 1) is blurred by a Gaussian of `blur` voxels (the scanner's point spread),
gets white noise of standard deviation `level` (0.2: a fifth of the contrast between pore and grain), and
is cut at a half. A voxel of the result has the label of the nearest true voxel if that is at most REACH
voxels away; specks farther off in the pores, and pinholes, belong to no true grain. Arrays are [z, y, x].
"""
import numpy
from scipy import ndimage

REACH = 2  # voxels


def noisy(truth, blur, level, seed):
    """The object (bool) as a scan would show it, and its true grains (int32, 0: none)."""
    rng = numpy.random.Generator(numpy.random.PCG64(seed))
    gray = ndimage.gaussian_filter((truth > 0).astype(numpy.float64), blur, mode="nearest")
    solid = gray + level * rng.standard_normal(truth.shape) >= 0.5
    apart, nearest = ndimage.distance_transform_edt(truth == 0, return_indices=True)
    return solid, numpy.where(solid & (apart <= REACH), truth[tuple(nearest)], 0).astype(numpy.int32)
