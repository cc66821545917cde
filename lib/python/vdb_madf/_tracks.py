# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains through time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
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
    shift: Optional[Tuple[int, int, int]]
    """Voxel [z, y, x] before is [z, y, x] + shift after. With a motion: None."""
    voxels_before: int
    """Labeled, in what both volumes show. With a motion this and the next two are 0."""
    voxels_after: int
    common_voxels: int
    before: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a grain: `id`, `fate` ("kept", "split", "merged", "vanished", "outside"), `track`,
    `voxels`, `shared_voxels` (in what both volumes show), `links`, `partner`, `overlap_voxels`.
    With a motion ("kept", "split", "merged", "lost", "outside") the last are `partner`,
    `confidence` (0 to 1), `miss` (voxels from where its neighbors say it is), `displacement`
    (z, y, x), `cut` (a scan ends within the grain: the displacement is that of its neighbors),
    `neighbors` (that these are of:)
    `gradient` (3 x 3), `strain_volumetric`, `strain_deviatoric` (Green-Lagrange),
    `rotation` (degrees about z, y, x); NaN for what is not known."""
    after: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """What `before` says, after; "new" in the place of "vanished"."""
    overlaps: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """Pairs that have voxels in common: `before`, `after`, `voxels`, `link`."""
    bonds_before: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a bond: `first`, `second`, `faces`, `shared_faces` (in what both volumes show), `fate`
    ("kept", "broken", "inside", "unmatched", "outside"; with a motion "detached", "separated"
    and "undecided" in the place of "broken")."""
    bonds_after: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """What `bonds_before` says, after; "new" in the place of "broken"."""
    motion: Optional[npt.NDArray[Any]] = field(default=None, repr=False)
    """Of the whole sample, if it was asked for: rows z, y, x, each with factors of z, y, x, and the
    shift."""


@checked
def track(before: Union[Labels, Segmentation, Source], after: Union[Labels, Segmentation, Source],
          *, shift: Optional[Tuple[int, int, int]] = None, max_shift: int = 10, share: float = 0.5,
          min_faces: int = 1,
          motion: Union[None, str, Sequence[Sequence[float]], npt.NDArray[Any]] = None,
          gap: int = 2, sure_faces: int = 16, progress: Progress = None,
          threads: int = 0) -> Tracks:
    """Follows grains from one scan to a later one by the voxels that they share.

    shift: of the sample in voxels, (z, y, x); None: the one, up to max_shift along each axis, that
    most voxels agree with. share: part of the smaller of two grains that they have to share to be
    linked.
    min_faces: of a bond.
    motion: the sample was turned or strained in between: "rigid" or "affine" is looked for, "free"
    follows neighbors alone, an array of 3 x 4 numbers is a guess (Tracks.motion says of what).
    shift is not looked at then, and max_shift and share are refused. gap: voxels between the grains
    of a broken bond up to which it is detached, else separated. sure_faces: of a bond of fewer
    faces it is undecided whether it has broken; both are refused without a motion.
    The manual of `vdb_madf track` defines the fates. A warning says if hardly more is common than
    of unrelated samples, and with a motion if more of the sample is lost than followed.

    Of more than two scans: track_series()."""
    guess = None
    if motion is not None and not isinstance(motion, str):
        rows = np.asarray(motion, dtype=float)
        if rows.shape != (3, 4) or not np.isfinite(rows).all():
            raise _core.InvalidInput("motion: a guess is an array of 3 x 4 finite numbers")
        guess, motion = rows.tolist(), "affine"
    with calling(progress, threads) as call:
        first, second = (labels_of(given, call, threads) for given in (before, after))
        found = _core.track(first._grid, second._grid, call, shift=shift, max_shift=max_shift,
                            share=share, min_faces=min_faces, motion=motion, guess=guess, gap=gap,
                            sure_faces=sure_faces)
    warn(found.pop("notes"))
    return Tracks(labels=Labels._of(found.pop("labels")), **found)


def track_series(scans: Sequence[Union[Labels, Segmentation, Source]],
                 **options: Any) -> List[Tracks]:
    """Follows grains through two scans or more, each from the one before it, with one number
    through all of them: the tables of each scan but the first. Options are those of track()."""
    if len(scans) < 2:
        raise _core.InvalidInput("scans: give two or more")
    series: List[Tracks] = []
    before = scans[0]
    for after in scans[1:]:
        series.append(track(before, after, **options))
        before = series[-1].labels
    return series


@dataclass(frozen=True, eq=False)
class EvolvedStep:
    """A sample that was moved, and the truth of it."""

    labels: Labels
    """With the numbers, and within the box, of before."""
    motion: npt.NDArray[Any] = field(repr=False)
    """Rows z, y, x, each with factors of z, y, x, and the shift."""
    grains: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a grain: `id`, `fate` ("kept", "left", "vanished", "absent"), `voxels`, `center` (z, y,
    x) to where its center before has gone."""
    bonds: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a pair that touches before or now: `first`, `second`, `fate` ("kept", "broken",
    "parted", "gone", "new"), `faces` now."""


@checked
def evolve(labels: Union[Labels, Segmentation, Source], *, steps: int = 2, seed: int = 1,
           strain: float = 0, shear: float = 0, turn: float = 0,
           axis: Tuple[float, float, float] = (1, 0, 0),
           drift: Tuple[float, float, float] = (0, 0, 0), rigid_grains: bool = False,
           vanish: float = 0, enter: float = 0, breaks: float = 0, break_gap: int = 2,
           grow: float = 0, noise: float = 0, progress: Progress = None,
           threads: int = 0) -> List[EvolvedStep]:
    """Labels through a known motion, in steps, as they are (step 0) and after each of them. The
    same options give the same voxels on every machine.

    At the end, strain: shortening along z; shear: of x along z; turn: degrees about the axis
    (z, y, x) through the center of the box; drift: voxels (z, y, x). rigid_grains: grains keep
    their shapes. vanish, enter: shares of the grains. breaks: share of the bonds; either grain
    loses what lies within break_gap voxels of the other. grow: voxels, below 0: dissolve. noise: of
    boundaries, voxels. The manual of `vdb_madf generate evolve` says more."""
    with calling(progress, threads) as call:
        steps_of = _core.evolve(
            labels_of(labels, call, threads)._grid, call, steps=steps, seed=seed, strain=strain,
            shear=shear, turn=turn, axis=axis, drift=drift, rigid_grains=rigid_grains,
            vanish=vanish, enter=enter, breaks=breaks, gap=break_gap, growth=grow, noise=noise)
    return [EvolvedStep(labels=Labels._of(step.pop("labels")), **step) for step in steps_of]
