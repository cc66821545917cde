# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Sparse volumes that are read like arrays."""

from __future__ import annotations

import operator
import os
import tempfile
from typing import Any, Dict, List, Optional, Tuple, Type, TypeVar

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked
from ._arrays import dense, fitted, shown
from ._calls import meters


_AnyVolume = TypeVar("_AnyVolume", bound="Volume")


class Volume:
    """A volume on a sparse grid, read like an array [z, y, x]: what is asked for costs what it
    covers.

    `volume[100]` is a slice; whole numbers, slices and `...` are taken. `numpy.asarray(volume)` is
    all of it. ==, !=, <, <=, > and >= with a number, an array or a volume give a dense array of
    bool, as those of arrays do; as a key of a dict a volume is equal to itself alone."""

    ndim = 3
    _grid: _core.Grid

    __hash__ = object.__hash__

    @classmethod
    def _of(cls: Type[_AnyVolume], grid: _core.Grid) -> _AnyVolume:
        volume = cls.__new__(cls)
        volume._grid = grid
        return volume

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of the values of slices."""
        raise NotImplementedError

    def _read(self, first: _core.Index, out: npt.NDArray[Any]) -> None:
        raise NotImplementedError

    @property
    def shape(self) -> Tuple[int, int, int]:
        """Voxels along z, y, x: of the scan, or if that is unknown of the box of the voxels."""
        return self._grid.shape

    @property
    def size(self) -> int:
        """All voxels of the box."""
        depth, height, width = self.shape
        return depth * height * width

    @property
    def first(self) -> Tuple[int, int, int]:
        """Place of element [0, 0, 0] in the scan: z, y, x in voxels. Not (0, 0, 0) of a crop."""
        return self._grid.first

    @property
    def unit(self) -> str:
        """The unit of lengths: "mm", "um" (voxels under 20 nm) or "voxel"."""
        return self._grid.unit

    @property
    def spacing(self) -> Tuple[float, float, float]:
        """Edges of a voxel along z, y, x, in `unit`. If that is "voxel" they are as a header may
        have them, where the "voxel" of tables is the shortest of them."""
        return self._grid.spacing

    @property
    def origin(self) -> Tuple[float, float, float]:
        """Center of the voxel [0, 0, 0]: z, y, x in `unit`."""
        return self._grid.origin

    @property
    def squared_unit(self) -> float:
        """What 1 is, in `unit` squared, of squared distances and radii of a segmentation."""
        return self._grid.squared_unit

    @property
    def voxel_size(self) -> Optional[Tuple[float, float, float]]:
        """Edges of a voxel along z, y, x in meters; None if unknown."""
        return self._grid.voxel_size

    @property
    def metadata(self) -> Dict[str, Any]:
        """What the volume says of itself: madf_version, madf_theta, madf_source ..."""
        return self._grid.metadata

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> Any:
        ranges, kept = _ranges(key, self.shape)
        result = np.zeros([len(r) for r in ranges], self.dtype)
        if result.size:
            if all(r.step == 1 for r in ranges):
                self._read((ranges[0][0], ranges[1][0], ranges[2][0]), result)
            else:
                self._read_steps(ranges, result)
        places: Any = tuple(slice(None) if keep else 0 for keep in kept)
        return result[places]

    def _read_steps(self, ranges: List[range], result: npt.NDArray[Any]) -> None:
        low = [min(r) for r in ranges]
        plane = np.empty([1] + [max(r) - min(r) + 1 for r in ranges[1:]], self.dtype)
        for slice_of_result, z in zip(result, ranges[0]):
            self._read((z, low[1], low[2]), plane)
            slice_of_result[...] = plane[0, ::ranges[1].step, ::ranges[2].step]

    @checked
    def to_array(self, dtype: npt.DTypeLike = None,
                 out: Optional[npt.NDArray[Any]] = None) -> npt.NDArray[Any]:
        """All voxels as an array of that type, or into `out`, of the shape of the volume."""
        if out is None:
            out = np.empty(self.shape, self.dtype if dtype is None else dtype)
        elif out.shape != self.shape:
            raise ValueError(f"out is of {out.shape}, and the volume of {self.shape}")
        elif dtype is not None and out.dtype != np.dtype(dtype):
            raise ValueError(f"out is of type {out.dtype}, not {np.dtype(dtype)}")
        if out.dtype == self.dtype and out.flags.c_contiguous and out.size:
            self._read((0, 0, 0), out)
        else:
            for first, slab in self._slabs():
                out[first:first + len(slab)] = (
                    fitted(slab, out.dtype) if out.dtype.kind in "iufc" else slab)
        return out

    def __array__(self, dtype: npt.DTypeLike = None,
                  copy: Optional[bool] = None) -> npt.NDArray[Any]:
        return self.to_array(dtype)

    def __eq__(self, other: Any) -> Any:
        return self._compared(np.equal, other)

    def __ne__(self, other: Any) -> Any:
        return self._compared(np.not_equal, other)

    def __lt__(self, other: Any) -> Any:
        return self._compared(np.less, other)

    def __le__(self, other: Any) -> Any:
        return self._compared(np.less_equal, other)

    def __gt__(self, other: Any) -> Any:
        return self._compared(np.greater, other)

    def __ge__(self, other: Any) -> Any:
        return self._compared(np.greater_equal, other)

    def _compared(self, compare: np.ufunc, other: Any) -> Any:
        """What each voxel says beside a number, or its own voxel of an array or a volume."""
        if not isinstance(other, Volume):
            other = dense(other)
            if other.dtype.kind not in "biuf":
                return NotImplemented
            if other.ndim == 0:
                other = np.broadcast_to(other, self.shape)
        if other.shape != self.shape:
            raise ValueError(f"the volume is of {self.shape}, and what it is compared with of "
                             f"{other.shape}")
        result = np.empty(self.shape, bool)
        for first, slab in self._slabs():
            part = slice(first, first + len(slab))
            compare(slab, other[part], out=result[part])
        return result

    def _slabs(self) -> Any:
        """(first slice, slab) through the volume; the slab's memory is used again."""
        depth, height, width = self.shape
        if not self.size:
            return
        buffer = np.empty((min(8, depth), height, width), self.dtype)
        for first in range(0, depth, 8):
            slab = buffer[:min(8, depth - first)]
            self._read((first, 0, 0), slab)
            yield first, slab

    def _vdb(self) -> bytes:
        """The volume as a .vdb file."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "volume.vdb")
            _core.save_vdb(path, [self._grid], _core.Call(None, 0))
            with open(path, "rb") as file:
                return file.read()


def edges_of(source: object, voxel_size: Optional[str]) -> Optional[_core.Edges]:
    """Edges of a voxel that were given, or are those of another volume, meters."""
    if voxel_size is None and isinstance(source, Volume):
        return source.voxel_size
    return meters(voxel_size)


def same_grid(source: Volume, voxel_size: Optional[str]) -> _core.Grid:
    """That of a volume of the same kind: its place and its region stay what they are."""
    edges = meters(voxel_size)
    if edges is not None and edges != source.voxel_size:
        raise ValueError(f"voxel_size={voxel_size!r}: the volume has {source.voxel_size} m; give "
                         "numpy.asarray() of it, which has no voxel size, to change that")
    return source._grid


def left_behind(source: object) -> List[str]:
    """A note on a volume that is read as an array."""
    if not isinstance(source, Volume):
        return []
    lost = {"its place and its region": any(source.origin) or "madf_region" in source.metadata,
            "its closed faces": source.metadata.get("madf_boundary") == "closed",
            "the proportions of its voxels": (source.voxel_size is None
                                              and len(set(source.spacing)) > 1)}
    parts = [part for part, is_lost in lost.items() if is_lost]
    return [f"a volume is read as an array: {', '.join(parts)} are left behind"] if parts else []


def _ranges(key: Any, shape: Tuple[int, int, int]) -> Tuple[List[range], List[bool]]:
    """The places along each axis, and whether the axis stays."""
    parts = list(key) if isinstance(key, tuple) else [key]
    if sum(part is Ellipsis for part in parts) > 1:
        raise IndexError("only one ... can stand in an index")
    if not any(part is Ellipsis for part in parts):
        parts.append(Ellipsis)
    dots = next(i for i, part in enumerate(parts) if part is Ellipsis)
    if len(parts) > 4:
        raise IndexError(f"{len(parts) - 1} indices for three axes")
    parts[dots:dots + 1] = [slice(None)] * (4 - len(parts))
    ranges, kept = [], []
    for axis, (part, length) in enumerate(zip(parts, shape)):
        if isinstance(part, slice):
            ranges.append(range(length)[part])
            kept.append(True)
            continue
        try:
            place = operator.index(part)
        except TypeError:
            place = None
        if place is None or isinstance(part, (bool, np.bool_)):
            raise IndexError(f"{shown(part)} is no whole number, slice or ...: read an array "
                             "first, numpy.asarray(volume), to index it by anything else")
        if not -length <= place < length:
            raise IndexError(f"{place} is out of the {length} voxels of axis {axis}")
        ranges.append(range(place % length, place % length + 1))
        kept.append(False)
    return ranges, kept
