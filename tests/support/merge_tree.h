// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "support/random_volume.h"
#include "vdb_madf/slabs/cuts/merge_parts.h"
#include "vdb_madf/slabs/store/bytes.h"

// Parts of a graph, merged in ranges that are joined in any order of neighbors.

namespace vdb_madf::test {

struct TreeGrains {
  std::vector<std::vector<uint32_t>> ofNode;  ///< of each part; 0: none of the object
  std::vector<Coord> representative;          ///< of grain g at g - 1
  size_t handedOver = 0, joins = 0;           ///< classes, of how many ranges
};

class RandomMergeTree {
 public:
  RandomMergeTree(const std::vector<detail::SlabPart>& parts, const detail::MergeRule& rule,
                  Rng& rng)
      : parts_(parts), rule_(rule), rng_(rng) {}

  TreeGrains run() {
    grains_.ofNode.resize(parts_.size());
    if (parts_.empty()) return std::move(grains_);
    const std::unique_ptr<Range> whole = merged(0, parts_.size());
    collect(*whole);
    std::sort(all_.begin(), all_.end());
    for (const auto& [representative, range] : all_) {
      grains_.representative.push_back(representative);
      range->ofDecided.push_back(uint32_t(grains_.representative.size()));
    }
    tell(*whole, {});
    return std::move(grains_);
  }

 private:
  struct Range {
    explicit Range(const detail::MergeRule& rule) : merging(rule) {}
    detail::MergeParts merging;
    std::vector<std::pair<size_t, std::vector<uint32_t>>> parts;  ///< classes of their nodes
    std::vector<std::pair<std::unique_ptr<Range>, std::vector<uint32_t>>> joined;
    std::vector<uint32_t> ofDecided;
  };

  std::unique_ptr<Range> merged(size_t begin, size_t end) {
    if (end - begin == 1) {
      auto range = std::make_unique<Range>(rule_);
      range->parts.emplace_back(begin, range->merging.add(parts_[begin]));
      return range;
    }
    const size_t middle = begin + 1 + size_t(rng_.below(int(end - begin) - 1));
    auto lower = merged(begin, middle);
    if (middle + 1 == end && rng_.chance(0.5)) {
      lower->parts.emplace_back(middle, lower->merging.add(parts_[middle]));
      return lower;
    }
    auto upper = merged(middle, end);
    collect(*upper);
    detail::ByteWriter bytes;
    const detail::OpenGraph open = upper->merging.handOver();
    grains_.handedOver += open.group.classes.size();
    ++grains_.joins;
    detail::Stored<detail::OpenGraph>::write(bytes, open);
    const std::vector<uint32_t> classes = lower->merging.add(
        detail::Stored<detail::OpenGraph>::read(detail::ByteReader(bytes.bytes())));
    lower->joined.emplace_back(std::move(upper), classes);
    return lower;
  }

  void collect(Range& range) {
    for (const Coord& representative : range.merging.decided())
      all_.emplace_back(representative, &range);
  }

  void tell(Range& range, const std::vector<uint32_t>& ofOpen) {
    const std::vector<uint32_t> grain = range.merging.grains(range.ofDecided, ofOpen);
    const auto grainsOf = [&](std::vector<uint32_t> classes) {
      for (uint32_t& c : classes) c = grain.at(c);
      return classes;
    };
    for (const auto& [part, classes] : range.parts) grains_.ofNode[part] = grainsOf(classes);
    for (const auto& [upper, classes] : range.joined) tell(*upper, grainsOf(classes));
  }

  const std::vector<detail::SlabPart>& parts_;
  const detail::MergeRule& rule_;
  Rng& rng_;
  std::vector<std::pair<Coord, Range*>> all_;
  TreeGrains grains_;
};

}  // namespace vdb_madf::test
