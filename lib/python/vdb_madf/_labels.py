# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains as labels."""

from __future__ import annotations

import inspect
import os
import tempfile
from typing import Any, Callable, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked
from ._arrays import Source, fitted, readable, refuse_parts
from ._calls import Progress, calling, warn
from ._files import is_tiff, kind_of, loaded, refuse_unused
from ._mesh import Mesh
from ._volume import Volume, edges_of, left_behind, same_grid

_Ids = Union[Sequence[int], npt.NDArray[np.integer[Any]]]


class Labels(Volume):
    """A label for each voxel, int32; 0 is background. Read like an array [z, y, x], and read-only.

    source: a file in any format that `vdb_madf` reads, or an array of integers, of any program.
    voxel_size: the edge of a voxel with its unit, "8.5um", or three along x, y, z: "1x1x3um".
    dataset: of a Zarr group or an HDF5 file; grid: of a .vdb ("grain" if there is such a one).
    progress: a function of percent and stage, or True for a bar (tqdm); threads: 0 for all."""

    _sizes: Optional[Tuple[npt.NDArray[np.int32], npt.NDArray[np.int64]]] = None

    @checked
    def __init__(self, source: Source, *, voxel_size: Optional[str] = None,
                 dataset: Optional[str] = None, grid: Optional[str] = None,
                 progress: Progress = None, threads: int = 0) -> None:
        refuse_parts(source, dataset=dataset, grid=grid)
        if isinstance(source, Labels):
            self._grid = same_grid(source, voxel_size)
            return
        options = _core.VolumeOptions()
        edges = edges_of(source, voxel_size)
        if edges is not None:
            options.set_voxel_size(edges)
        options.dataset = dataset or ""
        options.grid = grid or ""
        with calling(progress, threads) as call:
            self._grid, notes = _core.load_labels(readable(source), options, call)
        warn(notes + left_behind(source))

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of the values of slices: int32."""
        return np.dtype(np.int32)

    def _read(self, first: _core.Index, out: npt.NDArray[Any]) -> None:
        self._grid.read_labels(first, out)

    def _counted(self) -> Tuple[npt.NDArray[np.int32], npt.NDArray[np.int64]]:
        if self._sizes is None:
            self._sizes = _core.label_sizes(self._grid, _core.Call(None, 0))
            for values in self._sizes:
                values.flags.writeable = False  # they are given out, and used again
        return self._sizes

    @property
    def ids(self) -> npt.NDArray[np.int32]:
        """The labels above 0, ascending; read-only, as `voxels`."""
        return self._counted()[0]

    @property
    def voxels(self) -> npt.NDArray[np.int64]:
        """Voxels of each label, in the order of `ids`."""
        return self._counted()[1]

    @checked
    def to_array(self, dtype: npt.DTypeLike = None,
                 out: Optional[npt.NDArray[Any]] = None) -> npt.NDArray[Any]:
        """All voxels as an array of that type, or into `out`, of the shape of the labels.

        dtype="auto": the smallest unsigned type that holds all labels."""
        if isinstance(dtype, str) and dtype == "auto":
            dtype = np.min_scalar_type(int(self.ids[-1]) if len(self.ids) else 0)
        return super().to_array(dtype, out)

    @checked
    def paint(self, ids: _Ids, values: npt.ArrayLike, background: float = np.nan,
              dtype: npt.DTypeLike = np.float32) -> npt.NDArray[Any]:
        """An array [z, y, x] with a value for each grain: `values[i]` where the label is `ids[i]`,
        and `background` where it is none of them. What an integer `dtype` does not hold, as NaN, is
        refused."""
        known, painted = np.asarray(ids, np.int64), np.asarray(values)
        if known.ndim != 1 or known.shape != painted.shape:
            raise ValueError(f"{known.shape} ids and {painted.shape} values: give one for each")
        if len(known) and known.min() < 1:
            raise ValueError(f"{known.min()} is no id of a grain: they are above 0")
        out = np.empty(self.shape, dtype)
        order = np.argsort(known, kind="stable")  # of an id given twice the last value counts
        sorted_ids = np.append(known[order], 1 << 31)  # above all labels
        whole = out.dtype.kind in "biu"
        table = np.append(*[fitted(part, out.dtype) if whole else part.astype(out.dtype)
                            for part in (painted[order], np.asarray(background))])
        for first, slab in self._slabs():
            place = np.searchsorted(sorted_ids, slab, "right") - 1
            place[sorted_ids[place] != slab] = len(known)
            out[first:first + len(slab)] = table[place]
        return out

    @checked
    def crop(self, id: int, pad: int = 0) -> Tuple[npt.NDArray[np.bool_], Tuple[int, int, int]]:
        """One grain: True in an array of its box and `pad` voxels around it, as far as the volume
        goes, and the place of that array's first voxel in the volume."""
        if pad < 0:
            raise ValueError(f"pad={pad}: must be 0 or more")
        first, last = _core.box_of_label(self._grid, id)
        low = [max(0, place - pad) for place in first]
        high = [min(n, place + pad + 1) for n, place in zip(self.shape, last)]
        part = self[low[0]:high[0], low[1]:high[1], low[2]:high[2]]
        return np.asarray(part == id), (low[0], low[1], low[2])

    @checked
    def keep(self, ids: _Ids) -> "Labels":
        """These grains alone; their labels stay."""
        return Labels._of(_core.select(self._grid, [int(i) for i in ids], _core.Call(None, 0)))

    @checked
    def drop(self, ids: _Ids) -> "Labels":
        """All other grains; their labels stay. ValueError for an id that no grain has."""
        dropped = [int(i) for i in ids]
        unknown = np.setdiff1d(dropped, self.ids)
        if len(unknown):
            raise ValueError(f"{int(unknown[0])} is no grain of these labels")
        return self.keep(np.setdiff1d(self.ids, dropped))

    @checked
    def edit(self, edits: Union[str, Sequence[str]], *, manifold: Optional["Labels"] = None,
             progress: Progress = None, threads: int = 0) -> "Labels":
        """Other grains, as `vdb_madf edit` makes them: "merge 12 17" or a list of such edits, done
        one after the other. All grains that none of them concerns keep their voxels and labels.

        - "merge A B ...": one grain, of the first label; "split A": undoes it
        - "drop A B ...", "keep A B ...", "drop-at-faces" (of the volume or its region)
        - "join-below N": grains of fewer voxels become part of the neighbor of most shared faces
        - "min-voxels N", "max-voxels N", "min-diameter 100um", "max-diameter 1mm" (of equal volume)
        - "renumber": 1, 2, 3 ... in the order of the labels
        - "strictness K": refuses labels that were not merged with this one

        manifold: what the grains are made of, for "split": `Segmentation.manifold`, or
        Labels(path, grid="manifold") of a file."""
        text = edits if isinstance(edits, str) else "\n".join(edits)
        with calling(progress, threads) as call:
            grid = _core.edit(self._grid, text, None if manifold is None else manifold._grid, call)
        return Labels._of(grid)

    @checked
    def merge(self, groups: Sequence[_Ids]) -> "Labels":
        """Each group of grains, such as a pair or a row of an array, becomes one, with the label
        that comes first."""
        return self.edit(["merge " + " ".join(str(int(i)) for i in group) for group in groups])

    def relabel(self) -> "Labels":
        """The same grains as 1, 2, 3 ... in the order of their labels."""
        return self.edit("renumber")

    def digest(self) -> str:
        """A checksum of the places and labels of the grains, `labels_digest` of the command's
        sample.json: equal labels have the same one, whatever file or array they come from."""
        return _core.digest(self._grid, _core.Call(None, 0))

    @checked
    def reduce(self, factor: int) -> "Labels":
        """The volume smaller by a whole factor: each voxel has the most frequent label of its
        own. `origin` is where the center of its first voxel lies, and meshes, networks and napari's
        layers are there. Places in tables count from the center of voxel 0, 0, 0, which is
        `first` voxels before, also of a crop. Warns of grains too small to have a voxel of it."""
        return self._reduced(factor, _core.Call(None, 0))

    def _reduced(self, factor: int, call: _core.Call) -> "Labels":
        reduced = Labels._of(_core.reduce(self._grid, factor, call))
        lost = len(self.ids) - len(reduced.ids)
        if lost:
            warn([f"{lost} of {len(self.ids)} grains are too small to be seen in reduced labels"])
        return reduced

    def colors(self) -> Tuple[npt.NDArray[np.int32], npt.NDArray[np.uint8]]:
        """(N,) labels and (N, 3) sRGB, such that grains that touch never look alike."""
        return _core.colors(self._grid, _core.Call(None, 0))

    @checked
    def mesh(self, *, smoothing: int = 10, triangles: Optional[int] = None,
             ids: Optional[_Ids] = None, progress: Progress = None, threads: int = 0) -> Mesh:
        """Surfaces of all grains, or of those with these ids.

        smoothing: rounds; 0: the faces of the voxels, whose volume is exactly theirs. triangles:
        simplify to so many of all grains together, or fewer; no grain and no contact is given up
        for it."""
        with calling(progress, threads) as call:
            arrays = _core.mesh(self._grid, call, smoothing=smoothing, triangles=triangles,
                                ids=None if ids is None else [int(i) for i in ids])
        return Mesh(**arrays, unit=self.unit)

    @checked
    def save(self, path: Union[str, os.PathLike[str]], *, kind: Optional[str] = None,
             type: Optional[str] = None, smoothing: int = 10, reduce: int = 1,
             triangles: Optional[int] = None, compress: bool = False, min_faces: int = 1,
             ome: str = "0.4", meshes: bool = False, max_balls: int = 100, uncovered: float = 0.02,
             apart: bool = False, size: int = 512, azimuth: float = 35, elevation: float = 25,
             progress: Progress = None, threads: int = 0) -> None:
        """Writes a file, whole or not at all; what it is the ending says, or `kind` where it does
        not:

        - "labels": .vdb (Int32 grid `grain`), or an image of any format that is written, such as
          .tif, .nrrd or .npy (which, as .raw, holds no voxel size), with `type` of the samples;
          "mask": the same with 1 where there is a label
        - "mesh": .ply, .obj, .stl, .glb (a node a grain, with its measures), .vtp or a folder of
          .stl files; `smoothing`, `reduce`, `triangles`
        - "vti": VTK's image, `compress`; "hexahedra": .vtu, .inp (Abaqus), an element a voxel
        - "network": .graphml, .vtp, .csv: grains and bonds with their measures, `min_faces` of a
          bond; .txt, if `kind` says so: spheres and solid bonds for MUSEN
        - "zarr": .zarr, a folder that is not there yet: OME-Zarr `ome` "0.4", "0.5" or "0.6" for
          napari, neuroglancer and others: pyramids of the object and of `labels/grain`, colors and
          measures; `meshes` (`smoothing`, `reduce`, `triangles`): also meshes and measures for
          neuroglancer
        - "sandatlas": a folder that is not there yet, for the Sand Atlas: voxels, meshes
          (`smoothing`) and measures of each grain
        - "clumps": .txt (YADE), .data (LAMMPS), .csv, or a folder that is not there yet
          (MercuryDPM): grains as medial balls, computed with closed faces, `max_balls` each,
          `uncovered` part of them, `apart` if balls of different grains shall not overlap; warns of
          grains that have no ball
        - "preview" (fog and color, `reduce`), "level sets", "surface" (`smoothing`): .vdb for
          renderers
        - "picture": .png as of `vdb_madf render`; `size` of each part in pixels, `azimuth`,
          `elevation`
        """
        arguments = locals().copy()
        name = os.fspath(path)
        kind = kind_of(name, kind)
        refuse_unused(kind, arguments, inspect.signature(Labels.save))
        if type is not None and (kind not in ("labels", "mask") or name.lower().endswith(".vdb")):
            raise _core.InvalidInput(f"type={type!r}: {name} has no type of samples to choose")
        grid = self._grid
        notes = _core.file_losses(name, grid, kind)
        with calling(progress, threads) as call:
            if kind == "labels" and name.lower().endswith(".vdb"):
                _core.save_vdb(name, [grid], call)
            elif kind == "labels":
                _core.save_image(name, grid, type or "", is_tiff(name), call)
            elif kind == "mask" and name.lower().endswith(".vdb"):
                _core.save_vdb(name, [_core.mask_of_labels(grid)], call)
            elif kind == "mask":
                _core.save_image(name, _core.mask_of_labels(grid), type or "", False, call)
            elif kind == "mesh":
                meshed = grid if reduce == 1 else self._reduced(reduce, call)._grid
                _core.save_mesh(name, grid, meshed, smoothing, triangles, call)
            elif kind == "vti":
                _core.save_vti(name, grid, compress, call)
            elif kind == "network":
                _core.save_network(name, grid, min_faces, call)
            elif kind == "zarr":
                _core.save_zarr(name, grid, ome, min_faces, meshes, smoothing, reduce, triangles,
                                call)
            elif kind == "sandatlas":
                _core.save_sand_atlas(name, grid, smoothing, call)
            elif kind == "clumps":
                balls = _core.ball_grids(_core.mask_of_labels(grid), call)
                notes += _core.save_clumps(name, grid, balls, max_balls, uncovered, apart, call)
            elif kind == "hexahedra":
                _core.save_hexahedra(name, grid, call)
            elif kind == "preview":
                _core.save_preview(name, grid, reduce, call)
            elif kind == "picture":
                _core.save_picture(name, grid, size, azimuth, elevation, call)
            else:
                _core.save_level_sets(name, grid, smoothing, kind == "surface", call)
        warn(notes)

    def _repr_png_(self) -> Optional[bytes]:
        """The picture that notebooks show."""
        if not self.size:
            return None
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "labels.png")
            self.save(path, size=256)
            with open(path, "rb") as file:
                return file.read()

    def __reduce__(self) -> Tuple[Callable[[bytes, str], "Labels"], Tuple[bytes, str]]:
        return _labels_from_vdb, (self._vdb(), self._grid.name)

    def __repr__(self) -> str:
        return f"Labels(shape={self.shape}, spacing={self.spacing}, unit={self.unit!r})"


def _labels_from_vdb(data: bytes, name: str) -> Labels:
    return Labels._of(loaded(data, _core.load_labels, name))
