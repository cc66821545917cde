"""The peer of tests/benchmark/paper: scikit-image's watershed on the distance map.

Two ways to choose the markers, the rest alike (scipy's exact distance map, flooded from the markers,
6-connected, within the object):
- plain: every regional maximum of the distance map (26-connected; a plateau is one marker);
- smoothed: the maxima of the distance map blurred by a Gaussian of SIGMA, at least APART apart: what is
  commonly done against too many grains.
A piece of the object without a marker becomes a grain of its own. Arrays are [z, y, x].
"""
import time

import numpy
from scipy import ndimage
from skimage.feature import peak_local_max
from skimage.morphology import local_maxima
from skimage.segmentation import watershed

SIGMA = 2  # voxels
APART = 5  # voxels
FULL = numpy.ones((3, 3, 3), bool)


def grains(solid, kinds=("plain", "smoothed")):
    """Labels 1..N (int32) and seconds, the distance map included, by kind, of a boolean volume."""
    start = time.perf_counter()
    distance = ndimage.distance_transform_edt(solid)
    shared = time.perf_counter() - start
    result = {}
    for kind in kinds:
        start = time.perf_counter()
        if kind == "plain":
            height = distance
            markers, count = ndimage.label(local_maxima(distance, connectivity=3) & solid, FULL)
        else:
            height = numpy.where(solid, ndimage.gaussian_filter(distance, SIGMA), 0)
            peaks = peak_local_max(height, min_distance=APART, exclude_border=False)
            markers = numpy.zeros(solid.shape, numpy.int32)
            markers[tuple(peaks.T)] = numpy.arange(1, len(peaks) + 1)
            count = len(peaks)
        labels = watershed(-height, markers, mask=solid).astype(numpy.int32)
        pieces, _ = ndimage.label(solid & (labels == 0))
        labels = numpy.where(pieces > 0, pieces + count, labels).astype(numpy.int32)
        result[kind] = labels, shared + time.perf_counter() - start
    return result
