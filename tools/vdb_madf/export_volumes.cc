// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <memory>

#include "export.h"
#include "grid_image.h"
#include "scan_option.h"
#include "vdb_madf/exports/network_file.h"
#include "vdb_madf/exports/ome_zarr.h"
#include "vdb_madf/exports/palabos_file.h"
#include "vdb_madf/exports/vti_file.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/measure/grain_network.h"
#include "vdb_madf/measure/table_unit.h"
#include "vdb_madf/volumes/image_losses.h"
#include "vdb_madf/volumes/write_image.h"

namespace vdb_madf::tools {

namespace {

std::string sizeText(const CoordBBox& box) {
  const Coord size = box.dim();
  return fmt::format("{}x{}x{} voxels", size.x(), size.y(), size.z());
}

void writeMask(const ExportArguments& o, const CoordBBox& box, const Int32Grid& labels,
               Progress* progress) {
  writeImage(o.out, *objectMask(labels), box, SampleType::uint8, progress);
}

void writeMask(const ExportArguments& o, const CoordBBox& box, const LabelSlabs& labels,
               Progress* progress) {
  LabelSlabs ones = labels;
  ones.read = [&labels](size_t slab, Interrupter* interrupter) {
    const MaskGrid::Ptr object = objectMask(*labels.read(slab, interrupter));
    return Int32Grid::create(
        std::make_shared<Int32Tree>(object->tree(), 0, 1, openvdb::TopologyCopy()));
  };
  writeImage(o.out, ones, box, SampleType::uint8, progress);
}

}  // namespace

void exportPalabos(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const CoordBBox box = writtenBox(labels);
  writePalabos(o.out, labels, box, common.progress);
  if (!hasCubicVoxels(labels))
    note({o.out + ": its voxels are no cubes, and a lattice is one of cubes: resample them first "
                  "(vdb_madf convert --resample)"},
         common);
  note({lostPlace(o.out, labels)}, common);
  const auto domain = storedDomain(labels);
  say(o, common,
      std::string("0 = fluid, 1 = wall, 2 = inside") +
          (domain && !domain->isBox() ? ", outside of the region as in grains, " : ", ") +
          sizeText(box) + ", x slowest");
}

void exportVti(const ExportArguments& o, const Common& common, const Int32Grid& labels) {
  const CoordBBox box = writtenBox(labels);
  writeVti(o.out, labels, box, o.compress, common.progress);
  note({lostRegion(o.out, labels)}, common);
  say(o, common, "cell data grain_id, " + sizeText(box));
}

template <typename Labels>
void exportMask(const ExportArguments& o, const Common& common, const Labels& labels) {
  const Int32Grid& about = aboutOf(labels);
  const CoordBBox box = writtenBox(about);
  writeMask(o, box, labels, common.progress);
  note(lossesOf(o.out, about), common);
  say(o, common, "1 = grain, 0 = background, " + sizeText(box) + " of type uint8, x fastest");
}

template <typename Labels>
void exportNetwork(const ExportArguments& o, const Common& common, const Labels& labels) {
  const GrainNetwork network = grainNetwork(labels, o.measure, common.progress);
  writeNetwork(o.out, network, common.progress);
  std::string text = fmt::format("{}, {}", counted(network.grains.size(), "grain"),
                                 counted(network.bonds.size(), "bond"));
  if (o.measure.minFaces > 1)
    text += fmt::format(" ({} of fewer than {} faces left out)",
                        counted(network.contactsLeftOut, "contact"), o.measure.minFaces);
  say(o, common, text);
}

template <typename Labels>
void exportZarr(const ExportArguments& o, const Common& common, const Labels& labels) {
  const CoordBBox box = writtenBox(aboutOf(labels));
  OmeZarrOptions options;
  options.version = omeVersionOf(o.ome);
  options.measure = o.measure;
  options.meshes = o.meshes;
  options.mesh = meshOptions(o);
  options.meshReduction = reductionOf(o, aboutOf(labels));
  writeOmeZarr(o.out, labels, box, options, common.progress);
  note(zarrLossesOf(o.out, aboutOf(labels)), common);
  noteOfScan(o.out, noteOnPlaces(aboutOf(labels)), common.progress);
  say(o, common,
      fmt::format("OME-Zarr {}, the object and labels/grain, {}{}", o.ome, sizeText(box),
                  o.meshes ? "; meshes and measures for neuroglancer" : ""));
}

template void exportMask(const ExportArguments&, const Common&, const Int32Grid&);
template void exportMask(const ExportArguments&, const Common&, const LabelSlabs&);
template void exportNetwork(const ExportArguments&, const Common&, const Int32Grid&);
template void exportNetwork(const ExportArguments&, const Common&, const LabelSlabs&);
template void exportZarr(const ExportArguments&, const Common&, const Int32Grid&);
template void exportZarr(const ExportArguments&, const Common&, const LabelSlabs&);

}  // namespace vdb_madf::tools
