# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Arrays of any kind as volumes that are read slab by slab."""

from __future__ import annotations

import mmap
import os
from typing import Any, Optional, Protocol, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core


class ArrayLike3D(Protocol):
    """What can be read: numpy arrays in any order of bytes and strides, numpy.memmap, h5py, zarr,
    dask, xarray.

    It has three axes, [z, y, x], and `array[first:stop]` are slices. Where it calls its axes "x",
    "y" and "z", as xarray does (`array.dims`) and h5py and zarr may, they may come in any order. A
    dataset of h5py tells the edges of its voxels, too, by its attribute `element_size_um`."""

    @property
    def shape(self) -> Tuple[int, ...]: ...

    @property
    def dtype(self) -> Any: ...

    def __getitem__(self, key: Any, /) -> Any: ...


#: A file or an array.
Source = Union[str, os.PathLike[str], ArrayLike3D]


def shown(value: Any) -> str:
    """A value in a message: in a line, however long it is."""
    if hasattr(value, "shape") and hasattr(value, "dtype") and not isinstance(value, type):
        return f"<an array of {value.dtype}, {tuple(value.shape)}>"
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else text[:57] + "..."


def is_path(source: Any) -> bool:
    return isinstance(source, (str, os.PathLike))


def readable(source: Any) -> Union[str, _core.ArraySource]:
    """A path, or the array as a source of slabs, of which nothing is read yet."""
    return os.fspath(source) if is_path(source) else _array_source(source)


def refuse_parts(source: Any, **parts: Optional[str]) -> None:
    """ValueError for the name of a part of a file where there is no file."""
    for name, part in parts.items():
        if part is not None and not is_path(source):
            what = "there is none" if source is None else "this is an array"
            raise ValueError(f"{name}: names a part of a file, and {what}: leave it out")


def dense(array: Any) -> npt.NDArray[Any]:
    """A number, or all of an array as [z, y, x]."""
    order = _axes(array)
    values = np.asarray(array)
    return values if order is None else values.transpose(order)


def fitted(values: npt.NDArray[Any], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """The values in that type; those that it does not hold as they are are refused."""
    if np.can_cast(values.dtype, dtype):
        return values.astype(dtype, copy=False)
    with np.errstate(invalid="ignore", over="ignore"):
        made = values.astype(dtype)
    changed = values[made != values]
    if changed.size:
        raise ValueError(f"{changed.flat[0]} does not fit {np.dtype(dtype)}")
    return made


def _axes(array: Any) -> Optional[Tuple[int, int, int]]:
    """Which of its axes are z, y and x, of an array that names them all in another order."""
    dims = _names_of_axes(array)
    names = [str(name).lower() for name in dims]
    if not any(name in ("x", "y", "z") and name != usual for name, usual in zip(names, "zyx")):
        return None
    if sorted(names) != ["x", "y", "z"]:
        raise ValueError(f"the axes are called {', '.join(map(str, dims))}: call all three x, y "
                         "and z, or bring them into the order z, y, x")
    return names.index("z"), names.index("y"), names.index("x")


def _names_of_axes(array: Any) -> Tuple[Any, ...]:
    """As xarray, h5py and zarr have them; () of an array that names none."""
    dims = getattr(array, "dims", None)
    if isinstance(dims, tuple):
        return dims
    if dims is not None and hasattr(array, "file"):  # h5py
        return tuple(getattr(dim, "label", "") for dim in dims)
    named = getattr(getattr(array, "metadata", None), "dimension_names", None)  # Zarr 3
    if named is None and hasattr(array, "attrs"):
        named = array.attrs.get("_ARRAY_DIMENSIONS")  # as xarray saves Zarr 2
    return tuple(named) if isinstance(named, (list, tuple)) else ()


def _target(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """The type, in native order of bytes, that the samples are handed over in."""
    if dtype.kind == "b":
        return np.dtype(np.uint8)
    if dtype.kind in "iu":
        return np.dtype(np.int32) if dtype.itemsize == 8 else np.dtype(
            f"{dtype.kind}{dtype.itemsize}")
    if dtype.kind == "f" and dtype.itemsize <= 8:
        return np.dtype(f"f{max(4, dtype.itemsize)}")
    raise TypeError(f"an array of type {dtype} holds no samples: give integers, float32, float64 "
                    f"or bool")


def _narrowed(slab: npt.NDArray[Any], first: int) -> npt.NDArray[Any]:
    """64-bit integers as 32-bit ones, in which they have to fit."""
    limits = np.iinfo(np.int32)
    for value in (slab.min(), slab.max()):
        if not limits.min <= value <= limits.max:
            raise _core.InvalidInput(
                f"the array has the value {value} in the slices from {first} on, beyond 32 bits: "
                f"give "
                "labels smaller numbers first, for example by "
                "skimage.segmentation.relabel_sequential")
    return slab


def _array_source(array: Any) -> _core.ArraySource:
    if isinstance(array, np.ma.MaskedArray):
        raise TypeError("a masked array does not say what is behind its mask: give array.filled(0)")
    try:
        dtype = np.dtype(array.dtype)
    except (AttributeError, TypeError):  # a list, or a type of another library
        array = np.asarray(array)
        dtype = array.dtype
    shape = tuple(int(n) for n in array.shape)
    if len(shape) != 3:
        raise _core.InvalidInput(f"the array has {len(shape)} axes, of {shape}: give three, [z, y, "
                                 f"x]")
    if 0 in shape:
        raise _core.InvalidInput(f"the array, of {shape}, has no voxels")
    order = _axes(array)
    if order is not None:
        shape = tuple(shape[axis] for axis in order)
    target = _target(dtype)
    pages = _mapped(array)

    def read(first: int, stop: int) -> npt.NDArray[Any]:
        if pages is not None:
            pages.madvise(mmap.MADV_DONTNEED)
        if order is None:
            slab = np.asarray(array[first:stop])
        else:
            key = tuple(slice(first, stop) if axis == order[0] else slice(None)
                        for axis in range(3))
            slab = np.asarray(array[key]).transpose(order)
        if slab.dtype.kind in "iu" and slab.dtype.itemsize == 8:
            slab = _narrowed(slab, first)
        if target.kind in "iu" and slab.dtype != dtype:  # an array may err
            slab = _of_its_type(slab, target, dtype)
        return np.ascontiguousarray(slab, dtype=target)

    return _core.ArraySource(_name(array), (shape[0], shape[1], shape[2]), target.name, read,
                             _edges(array, order))


def _of_its_type(slab: npt.NDArray[Any], target: np.dtype[Any],
                 dtype: np.dtype[Any]) -> npt.NDArray[Any]:
    """What the array gives, in the integers that it is said to have."""
    try:
        return fitted(slab, target)
    except ValueError as error:
        raise _core.InvalidInput(f"the array is said to be of {dtype}, and gives values of "
                                 f"{slab.dtype} that are none of these: give array.astype() "
                                 f"({error})") from error


def _edges(array: Any, order: Optional[Tuple[int, int, int]]) -> Optional[_core.Edges]:
    """What a dataset of h5py says of its voxels along z, y, x in meters, as files of HDF5 do."""
    if not hasattr(array, "file") or not hasattr(array, "attrs"):
        return None
    edges = np.ravel(array.attrs.get("element_size_um", ()))
    if edges.shape != (3,) or edges.dtype.kind not in "iuf" or not np.all(
            np.isfinite(edges) & (edges > 0)):
        return None
    z, y, x = (float(edges[axis]) * 1e-6 for axis in order or (0, 1, 2))
    return z, y, x


def _mapped(array: Any) -> Optional[mmap.mmap]:
    """The memory map behind a read-only numpy.memmap: what was read of it is forgotten slab by
    slab, or the whole file would count as memory of the process. Data of other maps may be there
    alone."""
    owner, modes = array, set()
    while isinstance(owner, np.ndarray):
        if isinstance(owner, np.memmap):
            modes.add(owner.mode)
        owner = owner.base
    in_file = modes == {"r"} and isinstance(owner, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED")
    return owner if in_file else None


def _name(array: Any) -> str:
    """What messages call it, and labels say they come from."""
    for owner in (array, getattr(array, "file", None)):
        filename = getattr(owner, "filename", None)  # numpy.memmap; h5py's file
        if isinstance(filename, (str, os.PathLike)):
            return os.fspath(filename)
    return "the array"
