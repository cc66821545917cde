# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of grains, bonds and the sample."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import Source, readable
from ._calls import Progress, calling
from ._labels import Labels
from ._segmentation import Segmentation, labels_of

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import]


@dataclass(frozen=True)
class Measurements:
    """What is measured, in columns: the same names, numbers and order of rows as in the tables of
    `vdb_madf measure`, but without the unit in the names. NaN: not known."""

    grains: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row a grain, by `id`: `voxels`, `volume`, `equivalent_diameter`, `centroid_x` ...,
    `sphericity`, `coordination`, `at_domain_face` ..."""
    bonds: Dict[str, npt.NDArray[Any]] = field(repr=False)
    """A row for each pair of grains that touch, by `first`, then `second` (ids): `area`, `radius`,
    `normal_x` ..., `flatness`, `mean_curvature` ..."""
    sample: Dict[str, Any]
    """`solid_fraction`, `specific_surface`, `mean_coordination` ...; `bond_fabric` and
    `grain_fabric` are (3, 3), [z, y, x]; `diameter_by_volume[50]` is the median."""
    unit: str
    """The unit of lengths: "mm", "um" or "voxel"."""
    units: Dict[str, str] = field(repr=False)
    """The unit of each column and each number of the sample: "mm^3", "1/mm", "" ..."""
    provenance: Dict[str, Any] = field(repr=False)
    """What the labels say of their making (madf_*)."""

    def to_pandas(self) -> Tuple["pd.DataFrame", "pd.DataFrame"]:
        """Grains, indexed by id, and bonds. `attrs` has "unit", "units" and "provenance"."""
        try:
            import pandas as pd
        except ImportError:
            raise ImportError("to_pandas() needs pandas, which is not installed; grains and bonds "
                              "are dicts of numpy arrays without it") from None
        grains = pd.DataFrame(self.grains).set_index("id")
        bonds = pd.DataFrame(self.bonds)
        for table in (grains, bonds):
            table.attrs.update(unit=self.unit, provenance=self.provenance,
                               units={name: self.units[name] for name in table.columns})
        return grains, bonds

    def points(self, column: str = "centroid", of: str = "grains") -> npt.NDArray[np.float64]:
        """(N, 3) z, y, x in `unit` of "centroid", "representative", "axis1" ... of the grains, or
        "centroid", "normal" of the bonds."""
        table = {"grains": self.grains, "bonds": self.bonds}[of]
        return np.array([table[f"{column}_{axis}"] for axis in "zyx"], np.float64).T


def measure(labels: Union[Labels, Segmentation, Source], *, voxel_size: Optional[str] = None,
            boundary: str = "auto", min_faces: int = 1, shape: bool = False,
            intensity: Optional[Source] = None, intensity_grid: Optional[str] = None,
            gray: Optional[Source] = None, gray_grid: Optional[str] = None,
            edge_weights: bool = False, bootstrap: int = 0, dataset: Optional[str] = None,
            grid: Optional[str] = None, progress: Progress = None,
            threads: int = 0) -> Measurements:
    """Measures the grains of labels, of any program.

    boundary: what lies beyond the faces, "open" (unknown, so that they are no surface), "closed" or
    "auto": as the labels were made, else open. min_faces: of a bond. voxel_size, dataset, grid: as
    of Labels, of files and arrays. Columns: lib/vdb_madf/measure/README.md says what they mean.

    What is there on demand:
    shape: columns `feret_max`, `feret_min`, `convex_volume`, `solidity`, `zingg_class` of the
    grains.
    intensity: the scan that the labels were made of, a file or an array [z, y, x] of the same
    shape, read slab by slab: columns `gray_mean`, `gray_sd`, `gray_min`, `gray_max`, `gray_median`,
    `gray_voxels` of grains and bonds. intensity_grid: of a VDB, or the array of a Zarr or HDF5
    file.
    gray: the gray scan that the labels were made of, likewise: columns `neck_area`, `neck_radius`,
    `neck_error`, `neck_confirmed`, `neck_normal_x` ... of the bonds, freed of the scan's blur, and
    in the sample `scan_blur` and `scan_noise_of_contrast`. gray_grid: as intensity_grid.
    edge_weights: column `edge_weight` of the grains (0 at the faces), and in the sample
    `corrected_grain_diameter_mean`, `corrected_diameter_by_number` ... The domain has to be a box.
    bootstrap: replicates, 100 to 100000: in the sample `intervals`, by name of a mean its `mean`
    and the ends `low` and `high` of its 95 % interval."""
    with calling(progress, threads) as call:
        measured = labels_of(labels, call, threads, voxel_size=voxel_size, dataset=dataset,
                             grid=grid)
        made = _core.measure(measured._grid, call, boundary=boundary, min_faces=min_faces,
                             shape=shape, intensity=None if intensity is None
                             else readable(intensity), intensity_grid=intensity_grid or "",
                             gray=None if gray is None else readable(gray),
                             gray_grid=gray_grid or "", edge_weights=edge_weights,
                             bootstrap=bootstrap)
    return Measurements(**made, provenance=measured.metadata)
