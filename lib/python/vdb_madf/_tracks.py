# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains through time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Optional, Tuple, Union

import numpy.typing as npt

from . import _core
from ._arguments import checked
from ._arrays import Source
from ._calls import Progress, calling, warn
from ._labels import Labels
from ._segmentation import Segmentation, labels_of


@dataclass(frozen=True, eq=False)
class Tracks:
    """What became of grains and bonds from one scan of a sample to the next."""

    labels: Labels
    """The grains after by the numbers of their tracks: what is linked has the label from before."""
    shift: Tuple[int, int, int]
    """Voxel [z, y, x] before is [z, y, x] + shift after."""
    voxels_before: int
    """Labeled, in what both volumes show."""
    voxels_after: int
    common_voxels: int
    before: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a grain: `id`, `fate` ("kept", "split", "merged", "vanished", "outside"), `track`,
    `voxels`, `shared_voxels` (in what both volumes show), `links`, `partner`, `overlap_voxels`."""
    after: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """What `before` says, after; "new" in the place of "vanished"."""
    overlaps: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """Pairs that have voxels in common: `before`, `after`, `voxels`, `link`."""
    bonds_before: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a bond: `first`, `second`, `faces`, `shared_faces` (in what both volumes show), `fate`
    ("kept", "broken", "inside", "unmatched", "outside")."""
    bonds_after: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """What `bonds_before` says, after; "new" in the place of "broken"."""


@checked
def track(before: Union[Labels, Segmentation, Source], after: Union[Labels, Segmentation, Source],
          *, shift: Optional[Tuple[int, int, int]] = None, max_shift: int = 10, share: float = 0.5,
          min_faces: int = 1, progress: Progress = None, threads: int = 0) -> Tracks:
    """Follows grains from one scan to a later one by the voxels that they share.

    shift: of the sample in voxels, (z, y, x); None: the one, up to max_shift along each axis, that
    most voxels agree with. share: part of the smaller of two grains that they have to share to be
    linked.
    min_faces: of a bond. The manual of `vdb_madf track` defines the fates. A warning says if hardly
    more is common than of unrelated samples.

    For a series give the labels of the last step: track(track(a, b).labels, c)."""
    with calling(progress, threads) as call:
        first, second = (labels_of(given, call, threads) for given in (before, after))
        found = _core.track(first._grid, second._grid, call, shift=shift, max_shift=max_shift,
                            share=share, min_faces=min_faces)
    warn(found.pop("notes"))
    return Tracks(labels=Labels._of(found.pop("labels")), **found)
