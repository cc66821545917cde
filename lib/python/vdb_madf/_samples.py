# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Synthetic samples."""

from __future__ import annotations

from typing import Any, Optional, Tuple, Union

from . import _core
from ._calls import Progress, calling, meters
from ._labels import Labels
from ._mask import Mask


def generate(kind: str, *, size: Union[int, Tuple[int, int, int], None] = None, seed: int = 1,
             voxel_size: Optional[str] = None, progress: Progress = None, threads: int = 0,
             **options: Any) -> Tuple[Mask, Optional[Labels]]:
    """A synthetic object and its true grains, None where there is no truth. The same options give
    the same voxels on every machine.

    size: voxels, an edge or (z, y, x). Kinds and their options, lengths in voxels:

    - "spheres": count, radius=(least, largest), overlap, max_cover
    - "pack" (no truth): fraction, radius
    - "snow" (no truth): fraction, length
    - "sintered": count, radius, neck, roughness
    - "particles": count, radius, shape ("balls", "ellipsoids", "plates", "prisms", "polyhedra",
      "rods", "columns"), lognormal, neck, of rods and columns aspect=(least, largest)
    - "bed": radius, rounds

    Of any kind: surface, surface_length (rough surfaces), blur, noise, noise_length (as of a
    scan)."""
    if size is not None:
        options["size"] = (size, size, size) if isinstance(size, int) else tuple(size)
    options["seed"] = seed
    with calling(progress, threads) as call:
        mask, truth = _core.generate(kind, options, meters(voxel_size), call)
    return Mask._of(mask), None if truth is None else Labels._of(truth)
