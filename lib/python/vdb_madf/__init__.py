# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains and bonds of granular microstructures, from micro-CT volumes.

    import vdb_madf as madf
    seg = madf.segment("scan.tif", threshold="otsu", voxel_size="8.5um")
    grains, bonds = madf.measure(seg.labels).to_pandas()

Arrays are [z, y, x]; columns whose names end in _x, _y, _z name their axis. Lengths are in
millimeters (micrometers for voxels under 20 nm), in voxels if their size is unknown."""

from ._arrays import ArrayLike3D, Source
from ._calls import Progress
from ._choices import Cylinder
from ._comparison import Comparison, compare
from ._core import (InvalidInput, IoError, NotEnoughMemory, __version__, reads_hdf5,
                    verify_files)
from ._labels import Labels
from ._mask import Mask
from ._measurements import Measurements, measure
from ._mesh import Mesh
from ._napari import to_napari
from ._samples import generate
from ._segmentation import PAPER, Segmentation, segment
from ._tracks import EvolvedStep, Tracks, evolve, track, track_series

__all__ = ["ArrayLike3D", "Comparison", "Cylinder", "EvolvedStep", "InvalidInput", "IoError",
           "Labels", "Mask", "Measurements", "Mesh", "NotEnoughMemory", "PAPER", "Progress",
           "Segmentation", "Source", "Tracks", "__version__", "compare", "evolve", "generate",
           "measure", "reads_hdf5", "segment", "to_napari", "track", "track_series",
           "verify_files"]
