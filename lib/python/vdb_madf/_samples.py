# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Synthetic samples."""

from __future__ import annotations

from typing import Any, Dict, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked, is_index
from ._calls import Progress, calling, meters
from ._labels import Labels
from ._mask import Mask


@checked
def generate(kind: str, *, size: Union[int, Tuple[int, int, int], None] = None, seed: int = 1,
             voxel_size: Optional[str] = None, count: Optional[int] = None,
             radius: Optional[Tuple[float, float]] = None, overlap: Optional[float] = None,
             max_cover: Optional[int] = None, fraction: Optional[float] = None,
             length: Optional[float] = None, neck: Optional[float] = None,
             roughness: Optional[float] = None, shape: Optional[str] = None,
             lognormal: Optional[float] = None, aspect: Optional[Tuple[float, float]] = None,
             rounds: Optional[int] = None, centers: Optional[npt.NDArray[Any]] = None,
             surface: Optional[float] = None, surface_length: Optional[float] = None,
             blur: Optional[float] = None, noise: Optional[float] = None,
             noise_length: Optional[float] = None, gray: bool = False, progress: Progress = None,
             threads: int = 0) -> Tuple[Any, ...]:
    """A synthetic object, a Mask, and its true grains, Labels or None where there is no truth. The
    same options give the same voxels on every machine.

    size: voxels, an edge or (z, y, x). Kinds and their options, lengths in voxels:

    - "spheres": count, radius=(least, largest), overlap, max_cover
    - "pack" (no truth): fraction, radius
    - "snow" (no truth): fraction, length
    - "sintered": count, radius, neck, roughness
    - "particles": count, radius, shape ("balls", "ellipsoids", "plates", "prisms", "polyhedra",
      "rods", "columns", "sand-ottawa", "sand-ottawa-fine", "sand-hamburg", "sand-hostun"),
      lognormal, neck, of rods and columns aspect=(least, largest)
    - "bed": radius, rounds
    - "balls": centers, an array with a row (z, y, x, radius) for each ball, whose bounding box is
      in the middle of the sample; without a size the sample is as large

    Of any kind: surface, surface_length (rough surfaces), blur, noise, noise_length (as of a
    scan).

    gray: gives the gray scan of the same bodies, too, an array [z, y, x] of uint16, with air at
    10000 and solid at 30000; blur and noise are then in the scan alone. Of spheres, sintered,
    particles, bed and balls."""
    given: Dict[str, Any] = dict(
        size=(size, size, size) if is_index(size) else size, seed=seed, count=count,
        radius=radius, overlap=overlap, max_cover=max_cover, fraction=fraction, length=length,
        neck=neck, roughness=roughness, shape=shape, lognormal=lognormal, aspect=aspect,
        rounds=rounds, surface=surface, surface_length=surface_length, blur=blur, noise=noise,
        noise_length=noise_length, centers=None if centers is None else _rows(centers))
    options = {name: value for name, value in given.items() if value is not None}
    with calling(progress, threads) as call:
        mask, truth, scan = _core.generate(kind, options, gray, meters(voxel_size), call)
    made = Mask._of(mask), None if truth is None else Labels._of(truth)
    return (*made, scan) if gray else made


def _rows(rows: npt.NDArray[Any]) -> Any:
    if rows.ndim != 2 or rows.shape[1] != 4 or rows.dtype.kind not in "iuf":
        raise _core.InvalidInput("centers: give a row z, y, x, radius for each ball, in voxels")
    if not np.isfinite(rows).all():
        raise _core.InvalidInput("centers: there is a number that is not finite")
    return rows.astype(float).tolist()
