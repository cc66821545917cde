// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/MetaMap.h>

#include <optional>
#include <string>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/measure/binder.h"
#include "vdb_madf/measure/bootstrap.h"
#include "vdb_madf/measure/extra_measures.h"
#include "vdb_madf/measure/measure_bonds.h"
#include "vdb_madf/measure/measure_grains.h"
#include "vdb_madf/measure/measure_sample.h"
#include "vdb_madf/measure/scan_blur.h"
#include "vdb_madf/measure/sensitivity.h"
#include "vdb_madf/measure/size_curve.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/squared_distance.h"

namespace vdb_madf {

struct Segmentation;

/// What counts as a surface and as a bond, and what is measured on demand.
struct MeasureOptions {
  /// What lies beyond the domain; automatic: what the grid says, else open if its domain is known.
  /// Open: the faces of the domain, or the wall of a region, are no surface
  /// (GrainMeasures::cutArea). Closed: they are.
  Boundary boundary = Boundary::automatic;
  std::optional<Domain> domain;  ///< overrides the domain in the grid's metadata
  /// Grains that share fewer voxel faces have no bond; what they share stays part of their areas.
  /// 0 and 1: all that touch have one.
  int64_t minFaces = 1;
  bool shape = false;  ///< also GrainMeasures::shape
  /// Fills GrainMeasures::edgeWeight. The boundary has to be open, and the domain a box.
  bool edgeWeights = false;
  bool cells = false;      ///< also GrainMeasures::cell, which takes the time of the domain's box
  bool crossings = false;  ///< also BondMeasures::crossing; asks what edgeWeights ask
  bool bondRadii = false;  ///< also BondMeasures::inscribedRadius
  bool sizes = false;      ///< all kinds of size_curve.h, and shape
  std::optional<SizeReference> sizeReference{};  ///< with it sizeDeviations, and sizes
  /// Replicates of a bootstrap of the means (bootstrap.h); 0: none.
  int bootstrap = 0;
};

/// Grains, bonds and the sample. Lengths are in voxels, of unequal ones in their shortest edge;
/// areas and volumes likewise. Boxes, representatives and centroids are index coordinates.
struct Measurements {
  std::vector<GrainMeasures> grains;  ///< by id
  std::vector<BondMeasures> bonds;    ///< by first, then second
  SampleMeasures sample;
  int64_t minFaces = 1;                       ///< that a bond had to have
  ExtraMeasures extra;                        ///< what there is besides
  std::vector<MeanInterval> intervals;        ///< of bootstrapMeans(), if it was asked for
  std::vector<SizeDeviation> sizeDeviations;  ///< from the curve that was given
  int replicates = 0;                         ///< of these
  std::optional<ScanBlur> scan;               ///< that necks were measured in
  std::optional<Binder> binder;               ///< of measureBinder()
  std::optional<Crossings> crossings;         ///< if they were asked for
  std::optional<Sensitivity> sensitivity;     ///< to the choices the labels were made by
  bool open = false;                          ///< the boundary
  std::optional<VoxelSize> voxelSize;         ///< of the grid
  openvdb::Vec3d edges{1, 1, 1};              ///< of a voxel, in units of the shortest
  std::string gridName;
  openvdb::MetaMap metadata;  ///< of the grid: how the labels were made
  /// A checksum of the places and labels of the voxels, 32 hexadecimal digits: equal labels share
  /// it, whatever file or grid they come from.
  std::string labelDigest;
};

/// Measures labels: each value of the active voxels (tiles included) above 0 is a grain, in one
/// piece or not. Voxels may be boxes along the axes, which the transform tells; others count as
/// cubes. Areas are estimated (surface area: detail/leaf_surface.h says how), all else is
/// exact. Depends on nothing but labels, domain and boundary: not on tiles or threads, bit for bit.
/// Memory: per grain, per face of a bond, and for the representatives per voxel.
/// @throw InvalidInput if labels leave the domain, the boundary is open without one, minFaces is
///   negative, edge weights, crossings, cells, deviations or a bootstrap are asked for that cannot
///   be had, no weights fit the voxels (voxel_weights.h), or a limit of leaf_index.h is exceeded;
///   Interrupted.
Measurements measure(const Int32Grid& labels, const MeasureOptions& options = {},
                     Interrupter* interrupter = nullptr);

/// Labels in slabs need not fit in memory together, and give the same numbers, bit for bit. They
/// are read twice, and more often if they correlate over long distances. Memory: a slab with what
/// lies around it, as far as its deepest voxel is from the background, 40 voxels at least; per
/// grain and bond; and per face of a bond, or row of a grain with `shape`, of which more is to
/// come.
/// @throw as above; InvalidInput if the domain is a region; what reading throws.
Measurements measure(const LabelSlabs& labels, const MeasureOptions& options = {},
                     Interrupter* interrupter = nullptr);

/// Measures a segmentation's labels in their own domain and boundary. It is faster: unless balls
/// were filtered out, what is known of its critical points spares the distance map.
Measurements measure(const Segmentation& segmentation, Interrupter* interrupter = nullptr);

/// Mean number of the bonds of a grain that touch in the scan (Neck::touches()); needs necks.
double contactCoordination(const Measurements& measured);

/// The bonds that the scan confirms (Neck::confirmed).
struct ConfirmedNecks {
  int64_t count = 0;
  double area = 0;         ///< of their necks, added; voxels
  double labeledArea = 0;  ///< of the same bonds in the labels
};
ConfirmedNecks confirmedNecks(const Measurements& measured);

}  // namespace vdb_madf
