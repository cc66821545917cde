# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of grains, bonds and the sample."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked
from ._arrays import Source, readable, refuse_parts
from ._calls import Progress, calling, warn
from ._labels import Labels
from ._segmentation import Segmentation, labels_of

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import]


@dataclass(frozen=True)
class Measurements:
    """What is measured, in columns: the same names, numbers and order of rows as in the tables of
    `vdb_madf measure`, but without the unit in the names. NaN: not known. `*` is x, y and z.

    grains, a row a grain, by `id`:
    - `voxels`, `volume`, `equivalent_diameter`: of the ball of this volume
    - `centroid_*`: mean of the voxels' centers; `box_min_*`, `box_max_*`: voxels, inclusive
    - `representative_*`, `inscribed_radius`: the voxel farthest from the background, and how far
    - `free_area` towards the background, `shared_area` towards other grains, `area` of both;
      `cut_area`: faces at the wall of an open domain, which are no surface
    - `sphericity`: area of the ball of this volume / (area + cut area), of 27 voxels or more
    - axes of the ellipsoid of the same second moments, the longest first: `axis1_length`,
      `axis2_length`, `axis3_length`, directions `axis1_*`, `axis2_*`, `axis3_*`, and ratios of the
      lengths `aspect_2_to_1`, `aspect_3_to_2`
    - `coordination`: bonds; `at_domain_face`: has a voxel at the wall of the domain
    - with shape: `feret_max`, `feret_min`; `convex_volume`, `solidity` (volume / that);
      `zingg_class`: 1 disc, 2 equant, 3 blade, 4 rod
    - with intensity: `gray_voxels`, `gray_mean`, `gray_sd`, `gray_min`, `gray_max`, `gray_median`
    - with sensitivity: `p_grain`, share of the runs in which it comes again, `volume_sd` over these
    - with edge_weights: `edge_weight`: how much it counts in corrected sizes; 0 at the faces
    - with voronoi: `cell_volume` of what is nearer to this grain than to others,
      `local_solid_fraction` (volume / that), `cell_neighbors`; `cell_at_domain_face`: it ends there
    - with size_curve or size_reference: the columns of shape, and `projected_diameter`: of the disc
      of the convex hull's mean projected area
    - with stability: the grain is the same but for 2 % of its voxels from the strictness `born`
      (NaN: from any) down to `dies`, where it is part of a larger one (NaN: never); `stability`:
      how far its own strictness is from the nearer of the two

    bonds, a row for each pair of grains that touch, by `first`, then `second` (ids):
    - `faces` of voxels; `area`, `radius` of the disc of this area; `centroid_*`, and `normal_*`
      from first to second
    - `distance` d of the representatives, whose squared radii are D1 and D2; `cos_alpha`:
      (d^2 - D1 - D2) / (2 sqrt(D1 D2)), over 1 where the two balls do not meet
    - `flatness`: smallest eigenvalue of the covariance of the faces; `patches`: parts
    - `mean_curvature` (positive where the first is convex), `gaussian_curvature`, their standard
      deviations `mean_curvature_sd`, `gaussian_curvature_sd`, at `curvature_points` points with the
      misfit `curvature_residual`
    - with intensity: the `gray_` columns, of the voxels on both sides
    - with sensitivity: `p_bond`, share of the runs in which both grains are there and touch, and
      `area_sd` over these
    - with crossing: `cut_*`: it is in the minimum cut along this axis; `current_*`: of
      all that flows between the faces, through this bond
    - with stability: `vanishes`, the largest strictness at which the two grains are one

    sample:
    - `grains`, `bonds`, `contacts_left_out`, `area_left_out` (by `min_faces`),
      `bonds_without_curvature`, `components`, `euler_characteristic`
    - `object_voxels`, `object_volume`; `solid_fraction` and `correlation_length` (z, y, x) refer
      to the `box` ("domain", "region" or that of the "grains"), `box_min` to `box_max`; `boundary`
    - `free_area`, `shared_area`, `specific_surface`: free area / volume of the grains
    - `mean_coordination`, `coordinations`: grains with 0, 1, 2 ... bonds; `bond_to_grain_ratio`:
      mean of bond radius / radius of the smaller grain
    - `diameter_by_number`, `diameter_by_volume`: percentiles 5 to 95; [50] is the median
    - `grain_fabric`, `bond_fabric`: (3, 3), [z, y, x], of longest axes by volume, of normals by
      area
    - `labels_digest`: of equal labels the same
    - `expected_bias`: of numbers for which the grains or bonds are too small, by name, as a share
    - with edge_weights: `grains_at_faces`, `corrected_grains`, `grain_diameter_mean`,
      `corrected_grain_diameter_mean`, `grain_volume_mean`, `corrected_grain_volume_mean`,
      `corrected_mean_coordination`, `corrected_diameter_by_number`, `corrected_diameter_by_volume`
    - with crossing, along z, y, x: `minimum_cut_area`, least area of bonds that part the two faces
      (NaN: a grain reaches from face to face), `minimum_cut_share` of the faces' area,
      `minimum_cut_bonds`; `bond_conductivity` of what the full box would conduct; and
      `bond_conductivity_tensor`, (3, 3), [z, y, x], with all six faces at a gradient's potentials
    - with gray: `scan_blur`, its standard deviation; `scan_noise_of_contrast`, `scan_gray_inside`,
      `scan_gray_outside`; `necks_confirmed` of the bonds, with the sum `neck_area`;
      `contact_coordination`, mean number of a grain's bonds without a gap over `contact_gap`
    - with sensitivity: `sensitivity`: `runs`, the ends of what was varied, and `intervals`
    - with bootstrap: `intervals`, by name of a mean its `mean`, and `low` and `high` of 95 %
    - with size_curve: `size_curve`, by kind of size (columns of the grains) the sizes that
      `percent_passing` of the volume have or are below; with size_reference:
      `size_curve_rms_percent`, the deviations by kind of size"""

    grains: Dict[str, npt.NDArray[Any]] = field(repr=False)
    bonds: Dict[str, npt.NDArray[Any]] = field(repr=False)
    sample: Dict[str, Any]
    unit: str
    """The unit of lengths: "mm", "um" or "voxel"."""
    units: Dict[str, str] = field(repr=False)
    """The unit of each column and each number of the sample: "mm^3", "1/mm", "" ..."""
    provenance: Dict[str, Any] = field(repr=False)
    """What the labels say of their making (madf_*)."""
    bridges: Dict[str, npt.NDArray[Any]] = field(default_factory=dict, repr=False)
    """With phases, a row for each pair of grains that binder connects, by `first`, then `second`:
    `bonded`: they touch, too; `voxels`, `volume`; `section_area` where it is as far from both,
    `section_radius`; `first_cover_area`, `second_cover_area` of the grains, and `..._share` of
    their free areas. In the sample `binder_volume`, `binder_loose_volume` (in no bridge),
    and the number of `bridges`."""

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

    @checked
    def points(self, column: str = "centroid", of: str = "grains") -> npt.NDArray[np.float64]:
        """(N, 3) z, y, x in `unit` of "centroid", "representative", "axis1" ... of the grains, or
        "centroid", "normal" of the bonds."""
        table = {"grains": self.grains, "bonds": self.bonds}[of]
        return np.array([table[f"{column}_{axis}"] for axis in "zyx"], np.float64).T


@checked
def measure(labels: Union[Labels, Segmentation, Source], *, voxel_size: Optional[str] = None,
            boundary: str = "auto", min_faces: int = 1, shape: bool = False,
            intensity: Optional[Source] = None, intensity_grid: Optional[str] = None,
            gray: Optional[Source] = None, gray_grid: Optional[str] = None,
            edge_weights: bool = False, crossing: bool = False, voronoi: bool = False,
            size_curve: bool = False,
            size_reference: Optional[str] = None, phases: Optional[Source] = None,
            phases_grid: Optional[str] = None, binder: Optional[int] = None,
            stability: bool = False, bootstrap: int = 0, sensitivity: int = 0,
            vary: Optional[Dict[str, float]] = None,
            unit: Optional[str] = None, dataset: Optional[str] = None, grid: Optional[str] = None,
            progress: Progress = None, threads: int = 0) -> Measurements:
    """Measures the grains of labels, of any program.

    boundary: what lies beyond the faces, "open" (unknown, so that they are no surface), "closed" or
    "auto": as the labels were made, else open. min_faces: of a bond. unit: of lengths, "mm" or
    "um"; default: mm, of voxels under 20 nm um, without a voxel size voxels. voxel_size, dataset,
    grid: as of Labels, of files and arrays. help(Measurements) says what the columns mean.

    What is there on demand:
    shape: columns `feret_max`, `feret_min`, `convex_volume`, `solidity`, `zingg_class` of the
    grains.
    intensity: the scan that the labels were made of, a file or an array [z, y, x] of the same
    shape, or the whole of which they were cropped, read slab by slab: columns `gray_mean`,
    `gray_sd`, `gray_min`, `gray_max`, `gray_median`, `gray_voxels` of grains and bonds.
    intensity_grid: of a VDB, or the array of a Zarr or HDF5 file.
    gray: the gray scan that the labels were made of, likewise: columns `neck_area`, `neck_radius`,
    `neck_error`, `neck_gap`, `neck_confirmed`, `neck_normal_x` ... of the bonds, freed of the
    scan's blur, and in the sample `scan_blur`, `scan_noise_of_contrast` and
    `contact_coordination`. gray_grid: as intensity_grid.
    edge_weights: column `edge_weight` of the grains (0 at the faces), and in the sample
    `corrected_grain_diameter_mean`, `corrected_diameter_by_number` ... The domain has to be a box.
    crossing: what leads through grains and bonds between opposite faces of a box: columns `cut_x`
    ... and `current_x` ... of the bonds, and in the sample `minimum_cut_area`, `minimum_cut_share`,
    `minimum_cut_bonds`, `bond_conductivity` and its tensor.
    voronoi: columns `cell_volume`, `local_solid_fraction`, `cell_neighbors`, `cell_at_domain_face`
    of the grains' set-Voronoi cells, in the time of the domain's box.
    size_curve: cumulative curves by volume, in the sample as `size_curve`. size_reference: a CSV
    file size_mm,percent_passing (or size_um, size_voxel): in the sample `size_curve_rms_percent`,
    how far each kind of curve is from it between 5 and 95 %.
    phases: a map of phases of the same shape, of cropped labels that of the whole scan, a file
    or an array: `bridges`, the binder (the voxels of value `binder`, else 1) between grains.
    phases_grid: as intensity_grid.
    stability: of a Segmentation that kept its manifolds: columns `born`, `dies`, `stability` of the
    grains and `vanishes` of the bonds.
    bootstrap: replicates, 100 to 100000: in the sample `intervals`, by name of a mean its `mean`
    and the ends `low` and `high` of its 95 % interval.
    sensitivity: runs, 5 to 1000, in which the scan of `gray`, the whole one, is segmented by other
    choices: columns
    `p_grain` and `p_bond` (share of the runs in which a grain or bond comes again), `volume_sd` and
    `area_sd`, and in the sample `sensitivity`: what was varied and `intervals` as of bootstrap.
    vary: how far, such as {"threshold": 800, "smooth": 0.3, "strictness": 1, "gamma": 8}; what is
    not named goes by the scan's contrast, noise and blur."""
    if sensitivity > 0 and gray is None:
        raise _core.InvalidInput("sensitivity segments the scan again: give it as gray")
    if vary and sensitivity <= 0:
        raise _core.InvalidInput("vary says how far sensitivity goes: give it, too")
    if binder is not None and phases is None:
        raise _core.InvalidInput("binder is a value in the map of phases: give it, too")
    if stability and not isinstance(labels, Segmentation):
        raise _core.InvalidInput("stability: give the Segmentation itself, which has the manifolds")
    refuse_parts(intensity, intensity_grid=intensity_grid)
    refuse_parts(gray, gray_grid=gray_grid)
    refuse_parts(phases, phases_grid=phases_grid)
    with calling(progress, threads) as call:
        measured = labels_of(labels, call, threads, voxel_size=voxel_size, dataset=dataset,
                             grid=grid)
        made = _core.measure(measured._grid, call, boundary=boundary, min_faces=min_faces,
                             shape=shape, intensity=None if intensity is None
                             else readable(intensity), intensity_grid=intensity_grid or "",
                             gray=None if gray is None else readable(gray),
                             gray_grid=gray_grid or "", edge_weights=edge_weights,
                             crossing=crossing, voronoi=voronoi, size_curve=size_curve,
                             size_reference=size_reference or "",
                             phases=None if phases is None else readable(phases),
                             phases_grid=phases_grid or "", binder=1 if binder is None else binder,
                             manifold=labels._manifolds() if stability else None,
                             bootstrap=bootstrap, sensitivity=sensitivity, vary=vary or {},
                             unit=unit or "")
    warn(made.pop("notes"))
    return Measurements(**made, provenance=measured.metadata)
