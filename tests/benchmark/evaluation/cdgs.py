"""CDGS, curvature-driven grain segmentation, as a baseline: the third method of the paper's tables.

X. Wang, L. Gillibert, F. Flin, D. Coeurjolly: "Curvature-driven volumetric segmentation of binary
shapes: an application to snow microstructure analysis", ICPR 2012. There is no public code of it,
and the text of that article was not at hand: this is our own writing of the method's outline
(grooves of concave curvature on the surface, the regions between them, spread into the volume), so
its figures stand for the idea, not for the authors' program. Steps, on a boolean volume [z, y, x]:

1. Normals. The signed distance map's gradient, in a band of BAND voxels on both sides of the
   surface, is averaged in windows of growing size. A surface voxel takes the largest window in
   which, and in all smaller ones, the gradients agree: wide windows where the surface is smooth,
   narrow ones in a groove.
2. Mean curvature: half of the divergence of the outward normals; 1/r on a ball, negative in a
   groove.
3. Grooves: surface voxels with a curvature below a threshold, and what is within some voxels of
   them.
4. Regions: the other surface voxels, connected by faces; small regions are dropped.
5. Grains: each object voxel takes the label of the nearest region. The distance is the straight one
   to a voxel of a region, but labels pass from voxel to voxel (26-connected) within the object
   only.

Parameters (lengths in voxels):
- threshold  mean curvature (1/voxel) below which the surface is a groove. Too low: grooves have
             gaps, and grains stay together. Too high: flat and rough surfaces are grooves, too, and
             grains fall apart.
- windows    standard deviations of the Gaussian windows, growing. Small: exact on creases. Large:
  bear roughness.
- tolerance  degrees; gradients agree while their mean (of unit vectors) is no shorter than its
  cosine.
- widen      by how many voxels grooves are widened; closes gaps, but blurs where the border runs.
- least      voxels of the smallest region.

What the outline leaves open, and what was decided:
- The windows' shape and when they stop growing: Gaussians and the length of the mean, as above.
- The surface: object voxels with background among their 26 neighbors; that layer is thick enough
  that face neighbors connect a region, and a groove one voxel wide separates two.
- Whether grooves are cleaned: only widened, not thinned, and none is dropped for being small.
- A border between grains where two regions are equally near: the region's voxel first in the order
  z, y, x.
- The border of the volume: not a surface, for the object goes on behind it.
- A piece of the object (connected by faces) that no region reaches: a grain of its own.
- How parameters were chosen: `tuned` takes those whose regions match the true grains best, see
  there.
"""
import numpy
from scipy import ndimage

BAND = 3  # voxels
TRUNCATE = 2  # standard deviations
FULL = numpy.ones((3, 3, 3), bool)
FAR = numpy.iinfo(numpy.int64).max

DEFAULT = {"threshold": -0.01, "windows": (2, 3), "tolerance": 30, "widen": 1, "least": 30}
# What `tuned` chooses from: for creases between smooth grains, and for rougher and rougher ones.
STYLES = {"fine": {"windows": (1, 1.5, 2, 3), "tolerance": 20, "widen": 0},
          "coarse": {"windows": (2, 3), "tolerance": 30, "widen": 1},
          "wide": {"windows": (2, 3, 4), "tolerance": 30, "widen": 2}}
THRESHOLDS = (-0.05, -0.03, -0.02, -0.01, 0, 0.01, 0.02, 0.03, 0.04)


def grains(solid, normals=None, **parameters):
    """Labels 1..N (int32, 0: background) of a boolean volume [z, y, x], at least 2 voxels along
    each edge.

    normals: its Normals, if they are there already. Parameters other than DEFAULT's are given by
    name.
    """
    chosen = {**DEFAULT, **parameters}
    solid = numpy.asarray(solid, bool)
    curvature = mean_curvature(normals or Normals(solid), chosen.pop("windows"),
                               chosen.pop("tolerance"))
    return spread(solid, regions(curvature, **chosen))


def tuned(truth, solid=None, normals=None):
    """The grains with the parameters whose regions match the true grains best; and these in words.

    solid: what is cut, if not just the true grains; normals: its Normals, if they are there
    already.

    Least is the number of true grains without a region of their own and of regions beyond these;
    first, of equals.
    """
    best, solid = None, truth > 0 if solid is None else solid
    normals = normals or Normals(solid)
    for style, its in STYLES.items():
        curvature = mean_curvature(normals, its["windows"], its["tolerance"])
        for threshold in THRESHOLDS:
            found = regions(curvature, threshold, its["widen"], DEFAULT["least"])
            miss = mismatches(truth, found)
            if best is None or miss < best[0]:
                best = miss, found, f"{style}, {threshold}"
    return spread(solid, best[1]), best[2]


def mismatches(truth, found):
    """True grains and regions that do not have more than half of each other's voxels in regions."""
    at = (found > 0) & (truth > 0)
    width = int(found.max(initial=0)) + 1
    shared = numpy.bincount(truth[at].astype(numpy.int64) * width + found[at])
    pairs = numpy.flatnonzero(shared)
    shared = shared[pairs]
    pairs = pairs // width, pairs % width
    of_grain, of_region = (numpy.bincount(ids, shared) for ids in pairs)
    matched = numpy.sum((2 * shared > of_grain[pairs[0]]) & (2 * shared > of_region[pairs[1]]))
    true = numpy.count_nonzero(numpy.bincount(truth.ravel())[1:])
    return int(true + width - 1 - 2 * matched)


def unit(vectors):
    length = numpy.sqrt(sum(v * v for v in vectors))
    return [v / numpy.maximum(length, 1e-6) for v in vectors], length


class Normals:
    """Step 1 but the choice: of each surface voxel, for a window, half the divergence of the
    averaged normals and the length of their mean."""

    def __init__(self, solid):
        inside = ndimage.distance_transform_edt(solid).astype(numpy.float32)
        outside = ndimage.distance_transform_edt(~solid).astype(numpy.float32)
        # grows outward; 0 between two voxels
        distance = numpy.where(solid, 0.5 - inside, outside - 0.5)
        self.band = (numpy.abs(distance) <= BAND).astype(numpy.float32)
        self.gradient = unit([g * self.band for g in numpy.gradient(distance)])[0]
        self.shape = solid.shape
        self.at = numpy.nonzero(solid & ndimage.binary_dilation(~solid, FULL))
        self.windows = {}  # what was averaged already

    def averaged(self, window):
        if window not in self.windows:
            normal, length = unit([ndimage.gaussian_filter(g, window, truncate=TRUNCATE)
                                   for g in self.gradient])
            weight = ndimage.gaussian_filter(self.band, window, truncate=TRUNCATE)
            divergence = sum(numpy.gradient(n, axis=axis) for axis, n in enumerate(normal))
            self.windows[window] = divergence[self.at] / 2, length[self.at], weight[self.at]
        return self.windows[window]


def mean_curvature(normals, windows, tolerance):
    """Step 2, with the largest window that agrees: float32, not a number but at surface voxels."""
    values = numpy.zeros(len(normals.at[0]), numpy.float32)
    agreeing = numpy.ones(len(normals.at[0]), bool)
    for i, window in enumerate(windows):
        curvature, length, weight = normals.averaged(window)
        if i > 0:  # the smallest window needs no agreement
            agreeing &= length >= numpy.cos(numpy.deg2rad(tolerance)) * weight
        values[agreeing] = curvature[agreeing]
    curvature = numpy.full(normals.shape, numpy.nan, numpy.float32)
    curvature[normals.at] = values
    return curvature


def regions(curvature, threshold, widen, least):
    """Steps 3 and 4: the regions' labels 1..N on surface voxels, else 0."""
    groove = curvature < threshold
    if widen > 0:
        groove = ndimage.maximum_filter(groove, 2 * widen + 1, mode="constant")
    labels, count = ndimage.label(~numpy.isnan(curvature) & ~groove)
    large = numpy.bincount(labels.ravel(), minlength=count + 1) >= least
    large[0] = False
    return numpy.where(large, numpy.cumsum(large), 0).astype(numpy.int32)[labels]


def spread(solid, seeds):
    """Step 5. Each voxel keeps the key of its nearest seed: squared distance, then the seed's
    place."""
    inner = (slice(1, -1),) * 3
    # so that no neighbor is beyond the volume
    solid, seeds = numpy.pad(solid, 1), numpy.pad(seeds, 1)
    shape, flat = solid.shape, solid.ravel()
    low = int(solid.size).bit_length()  # the bits of a place
    key = numpy.full(solid.size, FAR)
    front = numpy.flatnonzero(seeds)
    key[front] = front
    strides = shape[1] * shape[2], shape[2], 1
    steps = [int(numpy.dot(offset, strides)) for offset in numpy.argwhere(FULL) - 1 if offset.any()]
    while front.size:
        place = key[front] & ((1 << low) - 1)
        nearer = []
        for step in steps:
            within = flat[front + step]
            to, seed = (front + step)[within], place[within]
            pairs = zip(numpy.unravel_index(to, shape), numpy.unravel_index(seed, shape))
            squared = sum((a - b) ** 2 for a, b in pairs)
            candidate = squared << low | seed
            better = candidate < key[to]
            key[to[better]] = candidate[better]
            nearer.append(to[better])
        front = numpy.unique(numpy.concatenate(nearer))
    reached = key < FAR
    labels = numpy.zeros(solid.size, numpy.int32)
    labels[reached] = seeds.ravel()[key[reached] & ((1 << low) - 1)]
    labels = labels.reshape(shape)
    pieces, _ = ndimage.label(solid & (labels == 0))
    return numpy.where(pieces > 0, pieces + labels.max(), labels).astype(numpy.int32)[inner]
