# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Cutting an object into grains."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from typing import Any, Dict, Optional, Sequence, Tuple, Union

import numpy.typing as npt

from . import _core
from ._arguments import checked, is_index
from ._arrays import Source
from ._calls import Progress, bytes_of, calling, warn
from ._choices import Box
from ._labels import Labels
from ._mask import Mask, Region

#: The method to the letter of the paper: segment(mask, **PAPER).
PAPER: Dict[str, Any] = dict(theta=-0.8, merge="angle", adjacency="cell", delta=0, fill_holes=0,
                             tidy=0)

_COUNTS = ("object_voxels", "cavities", "cavity_voxels", "medial_balls", "kept_balls",
           "critical_points", "grains", "largest_squared_distance", "leaves")


@dataclass(frozen=True, eq=False)
class Segmentation:
    """Grains and how they came about."""

    labels: Labels
    """1 to N on the object."""
    counts: Dict[str, int]
    """`grains`, `object_voxels`, `critical_points`, `medial_balls` ... and flaws of the labels."""
    seconds: Dict[str, float]
    """Seconds of each stage, in the order of work."""
    options: Dict[str, Any]
    """What was used: merge, strictness (or theta, delta, adjacency), min_grain if it is not 0,
    gamma, fill_holes, tidy, boundary."""
    graph: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """Critical points: `position` (K, 3) z, y, x in voxels of the scan, `squared_radius` (K,),
    `reaches_out` (K,), true if its ball leaves an open domain, where nobody knows how large it is,
    `voxels` (K,) of their manifolds, without filled cavities; pairs of manifolds that touch:
    `first`, `second` (E,), numbers of critical points from 0, `contact_faces`, also between voxels
    of filled cavities, `saddle_height`, a squared length, `cells_touch` (E,).

    Squared lengths, here and below, are in voxels squared, or of voxels that are no cubes in other
    units: `np.sqrt(squared_radius * labels.squared_unit)` is a length in `labels.unit`."""
    manifold: Optional[Labels] = field(default=None, repr=False)
    """Critical points 1 to K, if kept: what remerge() and sweep() work on."""
    distance_squared: Optional[Labels] = field(default=None, repr=False)
    """Squared distance to the background, if kept."""
    power: Optional[Labels] = field(default=None, repr=False)
    """Least power, a squared length, if kept."""
    balls: Optional[Dict[str, npt.NDArray[Any]]] = field(default=None, repr=False)
    """Medial balls, if kept: `position` (B, 3) z, y, x, `squared_radius`, `cell_size` (B,)."""

    def _manifolds(self) -> _core.Grid:
        if self.manifold is None:
            raise _core.InvalidInput("the manifolds were not kept: segment with keep=('manifold',)")
        return self.manifold._grid

    @checked
    def remerge(self, *, strictness: Optional[float] = None, merge: Optional[str] = None,
                theta: Optional[float] = None, delta: Optional[int] = None,
                adjacency: Optional[str] = None, min_grain: Optional[int] = None,
                tidy: Optional[int] = None, progress: Progress = None,
                threads: int = 0) -> "Segmentation":
        """The grains of other options of merging, without distances again: the same labels, bit for
        bit, as a fresh segment(). What is not given stays as it was, and is the default where merge
        goes from "score" to another or back."""
        given = dict(theta=theta, adjacency=adjacency, delta=delta, strictness=strictness)
        mode = self.options["merge"] if merge is None else merge
        stays = self.options if (mode == "score") == (self.options["merge"] == "score") else {}
        least = self.options.get("min_grain", 0) if min_grain is None else min_grain
        merging = _core.merge_options(
            {"merge": mode, "min_grain": least,
             **{name: stays.get(name) if value is None else value
                for name, value in given.items()}})
        rounds = self.options["tidy"] if tidy is None else tidy
        with calling(progress, threads) as call:
            grid = _core.remerge(self._manifolds(), call, merging=merging, tidy=rounds)
        labels = Labels._of(grid)
        options = {name: value for name, value in self.options.items()
                   if name not in (*given, "min_grain")}
        return Segmentation(labels, _counts(labels), {}, {**options, **merging, "tidy": rounds},
                            self.graph, self.manifold, self.distance_squared, self.power,
                            self.balls)

    @property
    def hierarchy(self) -> Dict[str, npt.NDArray[Any]]:
        """The joins that merge="score" makes, the best first: `score`; `strictness`, the largest
        one at which cut() makes it; `grains` that are left; `first`, `second`: critical points,
        numbers from 0 as in `graph`, and the voxels of the two, `first_voxels`, `second_voxels`.
        Of the kept manifolds."""
        joins: Dict[str, npt.NDArray[Any]] = _core.joins(self._manifolds())
        return joins

    @property
    def stable_strictness(self) -> Dict[str, Any]:
        """The strictness from 8 to 14 at which grains are most stable: `strictness`, for cut();
        `plateau`, the widest interval of 1 or more in which the number of grains changes by less
        than 5 %, or None; and of each of the `levels` the number of `grains` and their `stability`:
        the mean over the voxels of how far the number can go until 2 % of their grain are others,
        1 at most. Of the kept manifolds."""
        return _core.stable_strictness(self._manifolds())

    @checked
    def cut(self, strictness: float, *, progress: Progress = None,
            threads: int = 0) -> "Segmentation":
        """The grains of the hierarchy at a number: remerge(merge="score", strictness=...), with the
        min_grain of this segmentation."""
        return self.remerge(merge="score", strictness=strictness, progress=progress,
                            threads=threads)

    @checked
    def edit(self, edits: Union[str, Sequence[str]], *, progress: Progress = None,
             threads: int = 0) -> "Segmentation":
        """Edited labels, as of Labels.edit(), with the kept manifolds to split grains by. Where
        something was dropped `counts` are without those of balls, critical points and cavities;
        what was kept stays that of the whole object."""
        labels = self.labels.edit(edits, manifold=self.manifold, progress=progress, threads=threads)
        return replace(self, labels=labels, counts=_counts(labels), seconds={})

    @checked
    def sweep(self, strictness: Union[Sequence[float], npt.NDArray[Any], None] = None, *,
              merge: Union[str, Sequence[str], None] = None,
              theta: Union[Sequence[float], npt.NDArray[Any], None] = None,
              delta: Union[int, Sequence[int], None] = None, small: int = 100,
              progress: Progress = None, threads: int = 0) -> Dict[str, Any]:
        """The grains for every strictness, and of other merge modes for every combination of them,
        deltas and thetas, a row each: `merge`, `strictness`, `delta`, `theta`, `grains`,
        `median_voxels`, `small_grains` and `small_voxels` (grains of fewer than `small` voxels),
        `largest_voxels` and flaws. What a row's mode has not is NaN (`delta`: 0). All rows have the
        min_grain and tidy of this segmentation.
        pandas.DataFrame() makes a table of it."""
        modes = ([self.options["merge"]] if merge is None else
                 [merge] if isinstance(merge, str) else list(merge))
        for name, value, has_it in (("strictness", strictness, "score" in modes),
                                    ("theta", theta, modes != ["score"]),
                                    ("delta", delta, modes != ["score"])):
            if value is not None and not has_it:
                _core.merge_options({"merge": modes[0], name: value})  # says where it belongs
        used = {**_core.merge_options({"merge": "both"}), **_core.merge_options({"merge": "score"}),
                **self.options}
        deltas = ([used["delta"]] if delta is None else
                  [delta] if is_index(delta) else [int(d) for d in delta])
        with calling(progress, threads) as call:
            return _core.sweep(
                self._manifolds(), call, modes=modes, deltas=deltas,
                thetas=[used["theta"]] if theta is None else [float(t) for t in theta],
                strictnesses=([used["strictness"]] if strictness is None else
                              [float(s) for s in strictness]),
                adjacency=used["adjacency"], min_grain=used.get("min_grain", 0), tidy=used["tidy"],
                small=small)

    @checked
    def save(self, path: Union[str, os.PathLike[str]], *, progress: Progress = None,
             threads: int = 0) -> None:
        """Writes the labels and all grids that were kept into a .vdb, as `vdb_madf segment --keep`
        does (but for balls); `vdb_madf remerge` and `measure` go on from it."""
        name = os.fspath(path)
        if not name.lower().endswith(".vdb"):
            raise _core.InvalidInput(
                f"{name}: several grids go into a .vdb; labels.save() knows more "
                                     "endings")
        kept = (self.labels, self.distance_squared, self.power, self.manifold)
        with calling(progress, threads) as call:
            _core.save_vdb(name, [volume._grid for volume in kept if volume is not None], call)

    def _repr_png_(self) -> Optional[bytes]:
        return self.labels._repr_png_()


def _counts(labels: Labels) -> Dict[str, int]:
    """What labels say of themselves, which is nothing of flaws."""
    said = labels.metadata
    return {name: said[f"madf_{name}"] for name in _COUNTS if f"madf_{name}" in said}


def labels_of(source: Union[Labels, Segmentation, Source], call: _core.Call, threads: int,
              **arguments: Optional[str]) -> Labels:
    """The labels, or those of a segmentation, a file or an array with arguments of Labels()."""
    labels = source.labels if isinstance(source, Segmentation) else source
    if not isinstance(labels, Labels):
        return Labels(labels, progress=call.progress, threads=threads, **arguments)
    given = [name for name, value in arguments.items() if value is not None]
    if given:
        raise TypeError(f"{', '.join(given)}: for files and arrays; Labels have them already")
    return labels


@checked
def segment(source: Union[Mask, Source], *, strictness: Optional[float] = None, gamma: int = 0,
            merge: str = "score", theta: Optional[float] = None, delta: Optional[int] = None,
            adjacency: Optional[str] = None, min_grain: int = 0, fill_holes: Optional[int] = None,
            tidy: int = 2, boundary: str = "auto", keep: Sequence[str] = ("manifold",),
            max_memory: Union[int, str, None] = None,
            phase: Union[float, Sequence[float], None] = None,
            threshold: Union[float, str, Tuple[float, float], None] = None,
            range: Optional[Tuple[float, float]] = None, invert: bool = False, median: int = 0,
            smooth: float = 0, despeckle: int = 0, voxel_size: Optional[str] = None,
            roi: Optional[Region] = None, crop: Optional[Box] = None, domain: Optional[Box] = None,
            dataset: Optional[str] = None, grid: Optional[str] = None, progress: Progress = None,
            threads: int = 0) -> Segmentation:
    """Cuts the object into grains.

    source: a Mask, or what makes one, with its arguments besides (phase to grid, as of Mask):
    segment("scan.tif", phase=1, voxel_size="10um"), segment(array, threshold="otsu",
    roi="cylinder").

    merge: "score": pieces that are alike and meet in a broad contact are joined, the best pair
    first, down to the score strictness (11); the larger, the more grains. "both", "angle", "neck":
    the tests. Of these: theta (-0.9): cosine, -1 merges least; adjacency: "manifold" (None) or
    "cell"; delta (2): in eighths of a voxel, how much narrower a neck has to be than its grain.

    min_grain: grains of fewer voxels then become part of the neighbor of most shared faces.

    gamma: least cell of a medial ball, voxels; fill_holes: cavities of fewer voxels are filled
    meanwhile (None: 27);
    tidy: rounds of smoothing the interfaces; boundary: beyond the faces "open" (unknown), "closed"
    (background) or "auto" (open). **PAPER: the method without our additions.

    keep: which of "manifold" (for remerge() and sweep()), "distance", "power", "balls" are
    returned.
    max_memory: bytes, or a text such as "12GiB", that the work may take; default: what is free.
    progress: a function of percent and stage, or True for a bar (tqdm); threads: 0 for all. Labels
    do not depend on threads.

    Raises InvalidInput (a ValueError), NotEnoughMemory (a MemoryError), IoError (an OSError)."""
    allowed = bytes_of(max_memory)
    merging = _core.merge_options(dict(merge=merge, theta=theta, adjacency=adjacency, delta=delta,
                                       strictness=strictness, min_grain=min_grain))
    selection: Dict[str, Any] = dict(
        phase=phase, threshold=threshold, range=range, invert=invert, median=median, smooth=smooth,
        despeckle=despeckle, voxel_size=voxel_size, roi=roi, crop=crop, domain=domain,
        dataset=dataset, grid=grid)
    with calling(progress, threads) as call:
        if isinstance(source, Mask):
            given = [name for name, value in selection.items()
                     if value is not None and value is not False and
                     not (value == 0 and name in ("median", "smooth", "despeckle"))]
            if given:
                raise TypeError(f"{', '.join(given)}: a Mask is chosen already")
            mask = source
        else:
            mask = Mask(source, progress=call.progress, threads=threads, **selection)
        made = _core.segment(
            mask._grid, call, merging=merging, gamma=gamma, fill_holes=fill_holes, tidy=tidy,
            boundary=boundary, keep=list(keep), max_memory=allowed)
    note = _core.note_on_boundary(mask._grid, boundary)
    warn([note] if note else [])
    volumes = {name: None if made[name] is None else Labels._of(made[name])
               for name in ("manifold", "distance_squared", "power")}
    return Segmentation(labels=Labels._of(made["labels"]), counts=made["counts"],
                        seconds=made["seconds"], options=made["options"], graph=made["graph"],
                        balls=made["balls"], **volumes)
