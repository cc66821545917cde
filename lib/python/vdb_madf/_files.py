# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Volumes in files: what is written for which ending."""

from __future__ import annotations

import inspect
import os
import tempfile
from typing import Any, Callable, Mapping, Optional

from . import _core

_VOLUMES = (".vdb", *_core.written_endings())

#: kind of file -> endings
KINDS = {
    "labels": _VOLUMES,
    "mask": _VOLUMES,
    "mesh": (".ply", ".obj", ".stl", ".glb", ".vtp", ""),
    "vti": (".vti",),
    "network": (".graphml", ".vtp", ".csv", ".txt"),
    "clumps": (".txt", ".data", ".csv", ""),
    "hexahedra": (".vtu", ".inp"),
    "zarr": (".zarr",),
    "sandatlas": ("",),
    "preview": (".vdb",),
    "level sets": (".vdb",),
    "surface": (".vdb",),
    "picture": (".png",),
}

#: ending -> the kind that is taken where several have it
_USUAL = {"": "mesh", ".txt": "clumps"}


def kind_of(path: str, kind: Optional[str]) -> str:
    """The kind that is asked for, or the one that the ending leaves no doubt about."""
    ending = os.path.splitext(path)[1].lower()
    if kind is None:
        if ending in KINDS["labels"]:
            return "labels"
        kinds = [name for name, endings in KINDS.items() if ending in endings]
        if len(kinds) == 1 or ending in _USUAL:
            return _USUAL.get(ending, kinds[0])
        every = sorted({e for endings in KINDS.values() for e in endings if e})
        raise _core.InvalidInput(
            f"{path}: say what to write, kind='{kinds[0]}' or '{kinds[1]}'" if kinds else
            f"{path}: no format has the ending '{ending}'; there are {', '.join(every)}")
    if kind not in KINDS:
        raise _core.InvalidInput(f"kind={kind!r}: must be one of {', '.join(KINDS)}")
    if ending not in KINDS[kind]:
        raise _core.InvalidInput(f"{path}: the ending for kind='{kind}' must be one of "
                                 f"{', '.join(e or 'none (a folder)' for e in KINDS[kind])}")
    return kind


_MESHES = ("mesh", "zarr")
#: argument of Labels.save() -> the kinds that it is for
_USED_BY = {
    "smoothing": (*_MESHES, "sandatlas", "level sets", "surface"),
    "reduce": (*_MESHES, "preview"),
    "triangles": _MESHES,
    "compress": ("vti",),
    "min_faces": ("network", "zarr"),
    "ome": ("zarr",),
    "meshes": ("zarr",),
    "max_balls": ("clumps",),
    "uncovered": ("clumps",),
    "apart": ("clumps",),
    "size": ("picture",),
    "azimuth": ("picture",),
    "elevation": ("picture",),
}


def refuse_unused(kind: str, arguments: Mapping[str, Any], save: inspect.Signature) -> None:
    """InvalidInput for arguments of Labels.save() that a file of this kind has no use for."""
    for name, kinds in _USED_BY.items():
        value = arguments[name]
        if value == save.parameters[name].default:
            continue
        if kind not in kinds:
            raise _core.InvalidInput(f"{name}={value!r}: is for {' and '.join(kinds)}, not {kind}")
        of_meshes = name in ("smoothing", "reduce", "triangles")
        if kind == "zarr" and of_meshes and not arguments["meshes"]:
            raise _core.InvalidInput(f"{name}={value!r}: is of the meshes of a .zarr: give "
                                     "meshes=True, too")


def is_tiff(path: str) -> bool:
    return path.lower().endswith((".tif", ".tiff"))


def loaded(data: bytes, load: Callable[..., Any], grid: str) -> _core.Grid:
    """The grid in the bytes of a .vdb file."""
    options = _core.VolumeOptions()
    options.grid = grid
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "volume.vdb")
        with open(path, "wb") as file:
            file.write(data)
        result: _core.Grid = load(path, options, _core.Call(None, 0))[0]
    return result
