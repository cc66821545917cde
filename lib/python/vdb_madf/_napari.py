# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains and bonds as layers of napari, which is not imported: layers are tuples."""

from __future__ import annotations

import os
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._arguments import checked
from ._arrays import Source
from ._calls import Progress, calling
from ._labels import Labels
from ._measurements import Measurements, measure
from ._segmentation import Segmentation, labels_of

#: Data, arguments of the layer, and its kind.
Layer = Tuple[npt.NDArray[Any], Dict[str, Any], str]

_Paths = Union[str, Sequence[str]]


@checked
def to_napari(labels: Union[Labels, Segmentation, Source],
              measured: Optional[Measurements] = None, *, name: str = "grains",
              progress: Progress = None, threads: int = 0) -> List[Layer]:
    """Grains and bonds as layers of napari, (data, arguments, kind) each:

        for data, arguments, kind in madf.to_napari(seg):
            getattr(viewer, f"add_{kind}")(data, **arguments)

    "labels": the dense array, with the columns of the grains as features. "vectors": from the
    centroid of the first grain of each bond to that of the second, with those of the bonds.
    Both lie where they are in the world, in `labels.unit`.

    measured: of these labels, in any unit; None: they are measured, without columns on demand.
    ValueError: it is of other labels, or of voxels of another size."""
    with calling(progress, threads) as call:
        volume = labels_of(labels, call, threads)
        if measured is None:
            measured = measure(volume, progress=call.progress, threads=threads)
        elif measured.sample["labels_digest"] != volume.digest():
            raise ValueError("measured: is of other labels")
    factor = _factor(measured, volume)
    grains = {column: values for column, values in measured.grains.items() if column != "id"}
    ends = [np.searchsorted(measured.grains["id"], measured.bonds[end])
            for end in ("first", "second")]
    # Places of tables count from the center of voxel 0,0,0 of the scan.
    zero = np.subtract(volume.origin, np.multiply(volume.first, volume.spacing))
    centers = zero + factor * measured.points("centroid").reshape(-1, 3)
    first, second = (centers[rows] for rows in ends)
    metadata = {"unit": measured.unit, "units": dict(measured.units)}
    return [
        (volume.to_array(), {
            "name": name, "scale": volume.spacing, "translate": volume.origin,
            "features": {"index": measured.grains["id"], **grains}, "metadata": metadata},
         "labels"),
        (np.stack([first, second - first], axis=1), {
            "name": f"{name}: bonds", "features": dict(measured.bonds), "metadata": metadata,
            "edge_width": float(min(volume.spacing))},
         "vectors")]


def _factor(measured: Measurements, labels: Labels) -> float:
    """What lengths of the measures are multiplied by to be in the unit of their labels."""
    factor = 1.0
    if measured.unit == labels.unit == "voxel":
        factor = min(labels.spacing)
    elif measured.unit != labels.unit:
        units = {"mm": 1.0, "um": 1e-3}
        factor = units.get(measured.unit, np.nan) / units.get(labels.unit, np.nan)
    volume = measured.sample["object_voxels"] * np.prod(labels.spacing)
    if not np.isclose(factor**3 * measured.sample["object_volume"], volume, rtol=1e-6, atol=0):
        raise ValueError("measured: with voxels of another size than those of the labels")
    return factor


def get_reader(path: _Paths) -> Optional[Callable[[_Paths], List[Layer]]]:
    """What napari.yaml names: the reader of a path, or None."""
    paths = [path] if isinstance(path, str) else path
    ours = paths and all(one.lower().endswith((".vdb", ".slabs")) for one in paths)
    return _read if ours else None


def _read(path: _Paths) -> List[Layer]:
    layers: List[Layer] = []
    for one in [path] if isinstance(path, str) else path:
        name = os.path.splitext(os.path.basename(os.path.normpath(one)))[0]
        layers += to_napari(one, name=name)
    return layers
