# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The surfaces of grains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np
import numpy.typing as npt

from ._arguments import checked


@dataclass(frozen=True)
class Mesh:
    """A closed mesh for each grain. Where two grains touch, their points and triangles match
    exactly.

    The arrays show the memory of the library: nothing is copied, and they stay valid by
    themselves."""

    ids: npt.NDArray[np.int32]
    """(G,) labels of the grains, ascending."""
    points: npt.NDArray[np.float32]
    """(P, 3) x, y, z in `unit`, as the programs that show meshes want them."""
    triangles: npt.NDArray[np.uint32]
    """(T, 3) into `points`, counterclockwise from outside."""
    point_offsets: npt.NDArray[np.uint32]
    """(G + 1,): grain i has the points from [i] to [i + 1]."""
    triangle_offsets: npt.NDArray[np.uint32]
    """(G + 1,) likewise."""
    unit: str
    """The unit of the points: "mm", "um" or "voxel"."""

    @checked
    def grain(self, id: int) -> Tuple[npt.NDArray[np.float32], npt.NDArray[np.uint32]]:
        """Points (P, 3) and triangles (T, 3) of one grain."""
        place = int(np.searchsorted(self.ids, id))
        if place == len(self.ids) or self.ids[place] != id:
            raise KeyError(f"there is no grain {id}")
        first, stop = self.point_offsets[place:place + 2]
        begin, end = self.triangle_offsets[place:place + 2]
        return self.points[first:stop], self.triangles[begin:end] - first

    def volumes(self) -> npt.NDArray[np.float64]:
        """(G,) volume of each grain's mesh, unit cubed."""
        corners = self.points[self.triangles].astype(np.float64)
        parts = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        sums = np.concatenate([[0.0], np.cumsum(parts)])
        return np.asarray(np.diff(sums[self.triangle_offsets]))
