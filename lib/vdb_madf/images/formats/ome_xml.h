// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "vdb_madf/base/voxel_size.h"

namespace vdb_madf::detail {

/// What the OME-XML in the description of an OME-TIFF says of its image: the attributes of the
/// element Pixels. They are looked for in the text, which need not be whole.
/// Source: OME-TIFF specification, OME schema of June 2016.
class OmePixels {
 public:
  explicit OmePixels(const std::string& description);

  /// Elements Pixels, one for each image of the file; 0: no OME-XML.
  int images() const { return images_; }
  /// True unless an element TiffData says that slices begin elsewhere than at the page of their
  /// number.
  bool isInOrder() const { return isInOrder_; }
  /// SizeZ, SizeC, SizeT; 1 if it is not a number.
  int64_t size(const std::string& axis) const;
  /// PhysicalSizeX, Y and Z with their units (micrometers by default). Nothing without all three.
  /// @throw IoError that names the path if they are no plausible lengths
  std::optional<VoxelSize> voxelSize(const std::string& path) const;

 private:
  std::string attribute(const std::string& name, const std::string& otherwise) const;

  int images_ = 0;
  bool isInOrder_ = true;
  std::map<std::string, std::string> attributes_;
};

}  // namespace vdb_madf::detail
