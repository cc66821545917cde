// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/part_check.h"

#include <string>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

[[noreturn]] void fail(uint32_t number, const std::string& what) {
  throw InvalidInput("the parts of the graph of manifolds are not of one: manifold " +
                     std::to_string(number) + " " + what + ": segment again");
}

}  // namespace

void PartCheck::add(const GraphPart& part) {
  for (size_t i = 0; i < part.number.size(); ++i) {
    const uint32_t number = part.number[i];
    const ManifoldGraph::Node& node = part.graph.nodes[i];
    if (number > seen_.size()) fail(number, "is one of " + std::to_string(seen_.size()));
    const auto before = goesOn_.find(number);
    if (before == goesOn_.end() && seen_[number - 1]) fail(number, "was said to have ended");
    if (before != goesOn_.end() && (before->second.position != node.position ||
                                    before->second.squaredRadius != node.squaredRadius))
      fail(number, "is another one in another slab");
    seen_[number - 1] = true;
    if (part.goesOn[i])
      goesOn_[number] = node;
    else if (before != goesOn_.end())
      goesOn_.erase(before);
  }
}

void PartCheck::finish() const {
  if (!goesOn_.empty()) fail(goesOn_.begin()->first, "was said to go on");
  for (size_t i = 0; i < seen_.size(); ++i)
    if (!seen_[i]) fail(uint32_t(i + 1), "is in none");
}

}  // namespace vdb_madf::detail
