// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/samples/detail/gaussian_blur.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf::detail {

/// One change of a sample's object, block by block; only the blocks at work are held as dense
/// arrays.
class ObjectChange {
 public:
  /// The sample has to outlive this.
  explicit ObjectChange(const Sample& sample);
  virtual ~ObjectChange() = default;

  /// The object after the change. @throw Interrupted
  MaskTree::Ptr apply(Interrupter* interrupter) const;

 protected:
  /// The new object is where this is not negative.
  virtual FloatBox height(const CoordBBox& box) const = 0;

  /// 1 in the object, 0 outside, in the box with a margin; beyond the faces as at the faces.
  FloatBox indicatorIn(CoordBBox box, int margin) const;

  const MaskTree& object() const { return object_; }
  const CoordBBox& domain() const { return domain_; }

 private:
  const MaskTree& object_;
  CoordBBox domain_;
};

/// The object after the change, and the labels as carriedLabels() takes them along, without
/// metadata. @throw Interrupted
Sample changed(const Sample& sample, const ObjectChange& change, int reach,
               Interrupter* interrupter);

}  // namespace vdb_madf::detail
