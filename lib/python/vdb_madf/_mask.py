# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The object of a scan."""

from __future__ import annotations

import os
from typing import Any, Callable, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked
from ._arrays import ArrayLike3D, Source, is_path, readable, refuse_parts
from ._calls import Progress, calling, warn
from ._choices import Box, Cylinder, volume_options
from ._volume import Volume, edges_of, left_behind, same_grid

#: A region: the round field of view, or voxels that are not 0 in a mask, an array or a file.
Region = Union[str, Cylinder, "Mask", os.PathLike[str], ArrayLike3D]


class Mask(Volume):
    """The object of a volume: one bit for each voxel near it, however large the volume is.

    source: a file in any format that `vdb_madf` reads, or an array [z, y, x].

    Which voxels are object: of an array of bool those that are True, of other masks what is not 0.
    Anything else has to be said:

    phase: the value, or some of them; threshold: the least value, "otsu", "valley" (found in the
    histogram) or (low, high) for hysteresis; range: (least, largest value); invert: all other
    voxels. median (radius, 1 to 3 voxels) and smooth (standard deviation, voxels) filter the image
    first; despeckle drops islands and fills cavities of fewer voxels at last.

    voxel_size: the edge of a voxel with its unit, "8.5um", or three along x, y, z: "1x1x3um".
    roi, crop: work within a region (see Cylinder), or a box such as numpy.s_[10:90, :, 5:50]; what
    lies outside is unknown. domain: the box of the scan, of a .vdb that does not say it; the object
    lies within it.
    dataset: of a Zarr group or an HDF5 file; grid: of a .vdb.
    progress: a function of percent and stage, or True for a bar (tqdm); threads: 0 for all."""

    @checked
    def __init__(self, source: Source, *, phase: Union[float, Sequence[float], None] = None,
                 threshold: Union[float, str, Tuple[float, float], None] = None,
                 range: Optional[Tuple[float, float]] = None, invert: bool = False, median: int = 0,
                 smooth: float = 0, despeckle: int = 0, voxel_size: Optional[str] = None,
                 roi: Optional[Region] = None, crop: Optional[Box] = None,
                 domain: Optional[Box] = None, dataset: Optional[str] = None,
                 grid: Optional[str] = None, progress: Progress = None, threads: int = 0) -> None:
        refuse_parts(source, dataset=dataset, grid=grid)
        chosen = (phase, threshold, range, roi, crop, domain)
        if isinstance(source, Mask) and not (invert or median or smooth or despeckle) and all(
                choice is None for choice in chosen):
            self._grid = same_grid(source, voxel_size)
            return
        options = volume_options(
            mask_type=Mask, phase=phase, threshold=threshold, range=range, invert=invert,
            median=median, smooth=smooth, despeckle=despeckle,
            voxel_size=edges_of(source, voxel_size), roi=roi, crop=crop, domain=domain,
            dataset=dataset, grid=grid, of_array=not is_path(source))
        with calling(progress, threads) as call:
            chosen = (phase, threshold, range)
            if all(choice is None for choice in chosen) and not smooth and _is_bool(source):
                options.select_phases([1.0])
            self._grid, notes = _core.load_mask(readable(source), options, call)
        warn(notes + left_behind(source))

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of the values of slices: bool."""
        return np.dtype(bool)

    def _read(self, first: _core.Index, out: npt.NDArray[Any]) -> None:
        self._grid.read_mask(first, out)

    @property
    def voxels(self) -> int:
        """Voxels of the object."""
        return self._grid.active_voxels

    @property
    def fraction(self) -> float:
        """Share of the object in the scan, or the region of it."""
        return self.voxels / self._grid.domain_voxels if self._grid.domain_voxels else 0.0

    @property
    def segment_memory(self) -> int:
        """Bytes that segment() may need with its own options, this mask included."""
        return _core.segment_memory(self._grid, gamma=0, keep=["manifold"])

    @checked
    def save(self, path: Union[str, os.PathLike[str]], *, progress: Progress = None,
             threads: int = 0) -> None:
        """Writes the mask whole or not at all: .vdb (Bool grid `object`), or an image (uint8, 0
        and 1) of any format that is written, such as .tif, .nrrd or .npy."""
        name = os.fspath(path)
        with calling(progress, threads) as call:
            if name.lower().endswith(".vdb"):
                _core.save_vdb(name, [self._grid], call)
            else:
                _core.save_image(name, self._grid, "", False, call)
        warn(_core.file_losses(name, self._grid, "mask"))

    def __reduce__(self) -> Tuple[Callable[[bytes], "Mask"], Tuple[bytes]]:
        return _mask_from_vdb, (self._vdb(),)

    def __repr__(self) -> str:
        return f"Mask(shape={self.shape}, voxels={self.voxels}, unit={self.unit!r})"


def _is_bool(source: Any) -> bool:
    return bool(getattr(source, "dtype", None) == np.dtype(bool))


def _mask_from_vdb(data: bytes) -> Mask:
    from ._files import loaded
    return Mask._of(loaded(data, _core.load_mask, "object"))
