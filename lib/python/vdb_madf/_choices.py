# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Which part of a volume is taken: values, regions, boxes."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import Any, Optional, Sequence, Tuple, Union

from . import _core
from ._arguments import are_items, refuse_wrong_types
from ._arrays import readable

#: numpy.s_[10:90, :, 5:50]: along z, y and x.
Box = Tuple[slice, slice, slice]

_FAR = 2**20  # beyond the coordinates that are read


@dataclass(frozen=True)
class Cylinder:
    """The round field of view of a core: voxels whose centers are at most `radius` from the axis.

    axis: "z", "y" or "x"; center: where the axis passes, along the two other axes in the order of
    the array, voxels (default: the middle of the scan); radius: voxels (default: fitted to the
    values)."""

    axis: str = "z"
    center: Optional[Tuple[float, float]] = None
    radius: Optional[float] = None

    def __post_init__(self) -> None:
        refuse_wrong_types(Cylinder, vars(self))


def _bounds(box: Box, name: str, open_ended: bool,
            of_array: bool) -> Tuple[_core.Index, _core.Index]:
    first, last = [], []
    for part in box:
        if part.step not in (None, 1):
            raise ValueError(f"{name}: {part} has a step")
        if not open_ended and (part.start is None or part.stop is None):
            raise ValueError(f"{name}: {part} has no start or stop")
        ends = (part.start, part.stop)
        if any(end is not None and end < 0 for end in ends) and (of_array or None in ends):
            raise ValueError(f"{name}: {part}: places are counted from the first voxel, not from "
                             "the end")
        start = -_FAR if part.start is None else int(part.start)
        stop = _FAR if part.stop is None else int(part.stop)
        if stop <= start:
            raise ValueError(f"{name}: {part} is empty; places are counted from the first voxel")
        first.append(start)
        last.append(stop - 1)
    return (first[0], first[1], first[2]), (last[0], last[1], last[2])


def _finite(name: str, value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{name}={number}: not a finite number")
    return number


def _set_region(options: _core.VolumeOptions, roi: Any, mask_type: type) -> None:
    if isinstance(roi, str) and roi == "cylinder":
        roi = Cylinder()
    if isinstance(roi, Cylinder):
        if roi.axis not in ("z", "y", "x"):
            raise ValueError(f"axis={roi.axis!r}: must be 'z', 'y' or 'x'")
        if roi.radius is not None and not roi.radius > 0:
            raise ValueError(f"radius={roi.radius}: must be above 0")
        options.set_cylinder("zyx".index(roi.axis), roi.center, roi.radius)
    elif isinstance(roi, mask_type):
        options.set_region(roi._grid)  # type: ignore[attr-defined]
    elif isinstance(roi, (str, os.PathLike)):
        options.set_region_file(os.fspath(roi))
    else:
        inside = _core.VolumeOptions()
        inside.select_phases([0.0])
        inside.invert()
        grid, _ = _core.load_mask(readable(roi), inside, _core.Call(None, 0))
        options.set_region(grid)


def volume_options(
    *, mask_type: type, phase: Union[float, Sequence[float], None],
    threshold: Union[float, str, Tuple[float, float], None],
    range: Optional[Tuple[float, float]], invert: bool, median: int, smooth: float, despeckle: int,
    voxel_size: Optional[_core.Edges], roi: Any, crop: Optional[Box], domain: Optional[Box],
    dataset: Optional[str], grid: Optional[str], of_array: bool,
) -> _core.VolumeOptions:
    """The options as the library wants them."""
    if sum(choice is not None for choice in (phase, threshold, range)) > 1:
        raise ValueError("give only one of phase, threshold and range")
    if despeckle < 0:
        raise ValueError(f"despeckle={despeckle}: must be 0 or more")
    if are_items(phase) and len(phase) == 0:
        raise ValueError("phase=[]: names no value")
    options = _core.VolumeOptions()
    if phase is not None:
        options.select_phases([_finite("phase", v) for v in phase] if are_items(phase)
                              else [_finite("phase", phase)])
    if isinstance(threshold, str):
        options.select_automatically(threshold)
    elif are_items(threshold):
        low, high = (_finite("threshold", v) for v in threshold)
        if low > high:
            raise ValueError(f"threshold={threshold}: the first value exceeds the second")
        options.select_hysteresis(low, high)
    elif threshold is not None:
        options.select_from(_finite("threshold", threshold))
    if range is not None:
        low, high = (_finite("range", v) for v in range)
        if low > high:
            raise ValueError(f"range={range}: the first value exceeds the second")
        options.select_range(low, high)
    if invert:
        options.invert()
    options.filter(median, smooth, despeckle)
    if voxel_size is not None:
        options.set_voxel_size(voxel_size)
    if roi is not None:
        _set_region(options, roi, mask_type)
    if crop is not None:
        options.set_crop(_bounds(crop, "crop", True, of_array))
    if domain is not None:
        options.set_domain(_bounds(domain, "domain", False, False))
    options.dataset = dataset or ""
    options.grid = grid or ""
    return options
