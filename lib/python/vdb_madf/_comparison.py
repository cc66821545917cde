# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""How well labels agree."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Union

import numpy.typing as npt

from . import _core
from ._arguments import checked
from ._arrays import Source
from ._calls import Progress, calling, warn
from ._labels import Labels
from ._segmentation import Segmentation, labels_of


@dataclass(frozen=True)
class Comparison:
    """How well the labels of a test agree with true ones, over the voxels that both label."""

    truth_grains: int
    test_grains: int
    common_voxels: int
    """Labeled in both."""
    truth_only_voxels: int
    test_only_voxels: int
    misclassified_percent: float
    """Of the common voxels; each true grain goes with the test grain that has most of it."""
    mirror_misclassified_percent: float
    """`misclassified_percent` with the roles exchanged: it sees over-segmentation."""
    adjusted_rand_index: float
    """1: the same partition."""
    variation_of_information: float
    """Bits; 0: the same partition. The sum of the next two."""
    variation_split: float
    variation_merge: float
    found_grains: int
    """True grains with an intersection over union above 1/2."""
    mean_intersection_over_union: float
    splits: int
    """True grains in two or more pieces."""
    merges: int
    """Test grains of two or more true ones."""
    truth_matches: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a true grain: `id`, `voxels`, `partner`, `overlap_voxels`, `intersection_over_union`,
    `pieces`."""
    test_matches: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """What `truth_matches` says, for the test's grains."""
    overlaps: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """Pairs that meet, for scipy.sparse.coo_array: `truth`, `test` (0: none), `voxels`."""


@checked
def compare(truth: Union[Labels, Segmentation, Source], test: Union[Labels, Segmentation, Source],
            *, progress: Progress = None, threads: int = 0) -> Comparison:
    """Compares labels, of any program and numbering, voxel by voxel.

    Voxels of equal place are compared. A warning says where domains differ, or what is labeled;
    voxels of other sizes, and labels that have no voxel in common, are refused."""
    with calling(progress, threads) as call:
        first, second = (labels_of(given, call, threads) for given in (truth, test))
        found = _core.compare(first._grid, second._grid, call)
    warn(found.pop("notes"))
    return Comparison(**found)
