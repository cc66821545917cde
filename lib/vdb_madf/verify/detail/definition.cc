// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/verify/detail/definition.h"

#include <openvdb/Metadata.h>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf::detail {

namespace {

template <typename Stored>
auto told(const openvdb::MetaMap& metadata, const char* key) {
  const auto stored = metadata.getMetadata<Stored>(key);
  if (!stored)
    throw InvalidInput(std::string("the labels do not say ") + key +
                       ": only what segment or remerge wrote as .vdb or slabs can be verified");
  return stored->value();
}

int64_t toldCount(const openvdb::MetaMap& metadata, const char* key) {
  const int64_t count = told<openvdb::Int64Metadata>(metadata, key);
  if (count < 0)
    throw InvalidInput(std::string("metadata ") + key + " says " + std::to_string(count) +
                       ": it must not be negative");
  return count;
}

/// True for the first word, false for the second.
bool toldWord(const openvdb::MetaMap& metadata, const char* key, const char* yes, const char* no) {
  const std::string word = told<openvdb::StringMetadata>(metadata, key);
  if (word != yes && word != no)
    throw InvalidInput(std::string("metadata ") + key + " says '" + word + "': must be " + yes +
                       " or " + no);
  return word == yes;
}

}  // namespace

Definition::Definition(const openvdb::MetaMap& metadata) : domain(storedDomain(metadata)) {
  using openvdb::DoubleMetadata;
  if (metadata["madf_edits"])
    throw InvalidInput("the labels were edited, so no definition gives them: verify those before");
  if (metadata["madf_track"])
    throw InvalidInput("the labels were tracked, so their numbers are others: verify those before");
  open = toldWord(metadata, "madf_boundary", "open", "closed");
  if (open && !domain)
    throw InvalidInput("the labels say that their boundary is open, but not what their domain is");
  gamma = toldCount(metadata, "madf_gamma");
  fillHoles = toldCount(metadata, "madf_fill_holes");
  tidy = toldCount(metadata, "madf_tidy");
  if (tidy > 1000)
    throw InvalidInput("metadata madf_tidy says " + std::to_string(tidy) +
                       ": no more than 1000 rounds can be verified");
  if (metadata["madf_min_grain"]) minGrain = toldCount(metadata, "madf_min_grain");
  if (metadata["madf_weights"]) {
    const openvdb::Vec3i w = told<openvdb::Vec3IMetadata>(metadata, "madf_weights");
    weights = {w.x(), w.y(), w.z()};
    for (const int64_t weight : weights)
      if (weight < 1) throw InvalidInput("metadata madf_weights: weights must be positive");
  }
  merge = told<openvdb::StringMetadata>(metadata, "madf_merge");
  if (merge == "score") {
    strictness = told<DoubleMetadata>(metadata, "madf_strictness");
    if (!(strictness >= -1e6 && strictness <= 1e6))
      throw InvalidInput("metadata madf_strictness is out of range");
  } else if (merge == "both" || merge == "angle" || merge == "neck") {
    theta = told<DoubleMetadata>(metadata, "madf_theta");
    cell = toldWord(metadata, "madf_adjacency", "cell", "manifold");
    delta = toldCount(metadata, "madf_delta");
    if (!(theta >= -1 && theta <= 1) || delta > 80)
      throw InvalidInput("metadata madf_theta or madf_delta is out of range");
  } else {
    throw InvalidInput("the labels were merged by '" + merge +
                       "': only score, both, angle and neck can be verified");
  }
}

}  // namespace vdb_madf::detail
