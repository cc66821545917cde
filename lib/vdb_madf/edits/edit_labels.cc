// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/edit_labels.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/edits/detail/grain_parts.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/labels/detail/relabelled.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/join_small.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

namespace {

using Kind = Edit::Kind;

/// The text of an edit for a message: of a long one the beginning.
std::string named(const Edit& edit) {
  constexpr size_t kMost = 60;
  const std::string text = toString(edit);
  return text.size() > kMost ? text.substr(0, kMost) + "..." : text;
}

/// The labels that have a voxel with a face neighbor outside the domain.
std::set<int32_t> labelsAtFaces(const Int32Grid& labels, Interrupter* interrupter) {
  const detail::LabelLeaves leaves(labels, interrupter);
  const LeafIndex& index = leaves.index();
  std::set<int32_t> atFaces;
  if (index.leafCount() == 0) return atFaces;
  const Domain domain = storedDomain(labels).value_or(index.boundingBox());
  std::mutex mutex;
  detail::parallelFor(
      index.leafCount(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
        std::set<int32_t> local;
        for (size_t leaf = begin; leaf < end; ++leaf) {
          const auto wall =
              detail::without(index.mask(leaf), detail::innerMask(domain, index.origin(leaf)));
          if (!detail::anyVoxel(wall)) continue;
          for (const detail::LabelPart& part : leaves.parts(leaf))
            if (detail::meet(part.mask, wall)) local.insert(part.label);
        }
        const std::lock_guard<std::mutex> lock(mutex);
        atFaces.insert(local.begin(), local.end());
      });
  return atFaces;
}

/// Carries out edits. What only changes numbers waits until voxels are asked for.
class Editor {
 public:
  Editor(const Int32Grid& labels, const Int32Grid* manifold, Interrupter* interrupter)
      : original_(labels), manifold_(manifold), interrupter_(interrupter) {
    for (const auto& [grain, voxels] : labelSizes(labels, interrupter))
      grains_[grain] = {voxels, {grain}};
  }

  int64_t grainCount() const { return int64_t(grains_.size()); }
  int64_t voxelCount() const {
    int64_t sum = 0;
    for (const auto& [number, grain] : grains_) sum += grain.voxels;
    return sum;
  }

  EditResult apply(const Edit& edit) {
    checkEdit(edit);
    result_ = {};
    result_.edit = edit;
    for (const int32_t grain : edit.grains) require(grain);
    switch (edit.kind) {
      case Kind::split:
        split(edit.grains[0]);
        break;
      case Kind::merge:
        merge(edit.grains);
        break;
      case Kind::joinBelow:
        joinBelow(edit.voxels);
        break;
      case Kind::renumber:
        renumber();
        break;
      case Kind::strictness:
        requireStrictness(edit.strictness);
        break;
      default:
        dropUnless(kept(edit));
    }
    return result_;
  }

  /// Nothing else can be asked then.
  Int32Grid::Ptr finish() {
    flush();
    return current_ ? current_ : original_.deepCopy();
  }

 private:
  struct Grain {
    int64_t voxels = 0;
    std::vector<int32_t> from;  // labels of the grid as it is
  };

  const Int32Grid& grid() const { return current_ ? *current_ : original_; }

  void require(int32_t grain) const {
    if (grains_.count(grain)) return;
    const auto by = gone_.find(grain);
    throw InvalidInput("there is no grain " + std::to_string(grain) +
                       (by == gone_.end() ? "" : " any more, after '" + by->second + "'"));
  }

  void requireStrictness(double strictness) const {
    const auto stored = storedMerging(original_);
    const bool isByScore = stored && stored->options.mode == MergeMode::score;
    if (isByScore && stored->options.strictness == strictness) return;
    const std::string wanted = detail::shortestDecimal(strictness);
    throw InvalidInput(
        (isByScore ? "these labels were merged with the strictness " +
                         detail::shortestDecimal(stored->options.strictness)
                   : std::string("these labels do not say that they were merged by score")) +
        ": edit those that 'vdb_madf remerge --strictness " + wanted + "' makes");
  }

  void remove(int32_t grain) {
    gone_[grain] = named(result_.edit);
    grains_.erase(grain);
    changed_ = true;
  }

  void join(int32_t number, int32_t into) {
    Grain& whole = grains_.at(into);
    const Grain& part = grains_.at(number);
    whole.voxels += part.voxels;
    whole.from.insert(whole.from.end(), part.from.begin(), part.from.end());
    remove(number);
  }

  void merge(const std::vector<int32_t>& numbers) {
    for (size_t i = 1; i < numbers.size(); ++i) join(numbers[i], numbers[0]);
    result_.grains = {numbers[0]};
  }

  void joinBelow(int64_t least) {
    flush();
    std::vector<int32_t> numbers;
    std::vector<int64_t> voxels;
    for (const auto& [number, grain] : grains_) {
      numbers.push_back(number);
      voxels.push_back(grain.voxels);
    }
    const auto place = [&](int32_t number) {
      return uint32_t(detail::sortedIndex(numbers, number));
    };
    std::vector<GrainContact> contacts;
    for (const auto& [first, second, faces] : detail::labelContacts(grid(), interrupter_))
      contacts.push_back({place(first), place(second), faces});
    const std::vector<uint32_t> into = joinSmall(std::move(voxels), contacts, least);
    for (size_t i = 0; i < numbers.size(); ++i) {
      if (into[i] == i) continue;
      join(numbers[i], numbers[into[i]]);
      result_.grains.push_back(numbers[into[i]]);
      ++result_.joinedGrains;
    }
    detail::sortUnique(result_.grains);
  }

  void renumber() {
    std::map<int32_t, Grain> renumbered;
    for (auto& [number, grain] : grains_)
      renumbered.emplace(int32_t(renumbered.size() + 1), std::move(grain));
    grains_ = std::move(renumbered);
    gone_.clear();
    changed_ = true;
  }

  /// Whether an edit leaves a grain.
  std::function<bool(int32_t, const Grain&)> kept(const Edit& edit) {
    const auto isNamed = [grains = std::set<int32_t>(edit.grains.begin(), edit.grains.end())](
                             int32_t number) { return grains.count(number) > 0; };
    switch (edit.kind) {
      case Kind::drop:
        return [isNamed](int32_t number, const Grain&) { return !isNamed(number); };
      case Kind::keep:
        return [isNamed](int32_t number, const Grain&) { return isNamed(number); };
      case Kind::minVoxels:
        return [least = edit.voxels](int32_t, const Grain& g) { return g.voxels >= least; };
      case Kind::maxVoxels:
        return [most = edit.voxels](int32_t, const Grain& g) { return g.voxels <= most; };
      case Kind::minDiameter:
        return [this, least = edit.diameter](int32_t, const Grain& grain) {
          return diameter(grain) >= least;
        };
      case Kind::maxDiameter:
        return [this, most = edit.diameter](int32_t, const Grain& grain) {
          return diameter(grain) <= most;
        };
      default:
        flush();
        return [atFaces = labelsAtFaces(grid(), interrupter_)](int32_t number, const Grain&) {
          return atFaces.count(number) == 0;
        };
    }
  }

  /// Equivalent, in meters.
  double diameter(const Grain& grain) const {
    const auto size = storedVoxelSize(original_);
    if (!size)
      throw InvalidInput(
          "the size of the voxels is unknown: say it, or choose by voxels (min-voxels)",
          Hint::voxelSize);
    const auto& [x, y, z] = size->edges();
    return std::cbrt(6 * double(grain.voxels) * x * y * z / M_PI);
  }

  void dropUnless(const std::function<bool(int32_t, const Grain&)>& isKept) {
    std::vector<int32_t> dropped;
    for (const auto& [number, grain] : grains_)
      if (!isKept(number, grain)) dropped.push_back(number);
    for (const int32_t number : dropped) {
      result_.droppedVoxels += grains_.at(number).voxels;
      remove(number);
    }
    result_.droppedGrains = int64_t(dropped.size());
  }

  void split(int32_t number) {
    if (!manifold_)
      throw InvalidInput("there are no manifolds to split grains by: segment again",
                         Hint::manifolds);
    flush();
    if (!parts_) parts_.emplace(*manifold_, original_, interrupter_);
    const std::vector<detail::GrainPart> parts = parts_->divide(grid(), number, interrupter_);
    const std::vector<int32_t> numbers = numbersOf(parts, number);
    own();
    for (size_t i = 0; i < parts.size(); ++i) {
      if (numbers[i] != number) detail::setVoxels(*current_, parts[i].voxels, numbers[i]);
      grains_[numbers[i]] = {parts[i].voxelCount, {numbers[i]}};
      gone_.erase(numbers[i]);
    }
    result_.grains = numbers;
    std::sort(result_.grains.begin(), result_.grains.end());
  }

  /// What the parts of a grain are called from now on.
  std::vector<int32_t> numbersOf(const std::vector<detail::GrainPart>& parts, int32_t number) {
    size_t keeper = 0;
    for (size_t i = 1; i < parts.size(); ++i)
      if (parts[i].voxelCount > parts[keeper].voxelCount) keeper = i;
    for (size_t i = 0; i < parts.size(); ++i)
      if (parts[i].number == number) keeper = i;
    std::vector<int32_t> numbers(parts.size(), 0);
    numbers[keeper] = number;
    int32_t last = std::max(parts_->largestNumber(), grains_.rbegin()->first);
    for (size_t i = 0; i < parts.size(); ++i) {
      if (i == keeper) continue;
      numbers[i] = parts[i].number;
      if (!grains_.count(numbers[i])) continue;
      if (last == std::numeric_limits<int32_t>::max())
        throw InvalidInput("there is no number left for a part: renumber the grains first");
      numbers[i] = ++last;
    }
    return numbers;
  }

  /// The grid becomes a copy that may be changed.
  void own() {
    if (!current_) current_ = original_.deepCopy();
  }

  /// Gives the voxels the numbers that their grains have got.
  void flush() {
    if (!changed_) return;
    std::vector<std::pair<int32_t, int32_t>> to;
    for (auto& [number, grain] : grains_) {
      for (const int32_t from : grain.from) to.emplace_back(from, number);
      grain.from = {number};
    }
    std::sort(to.begin(), to.end());
    current_ = detail::relabelled(grid(), to, interrupter_);
    changed_ = false;
  }

  const Int32Grid& original_;
  const Int32Grid* manifold_;
  Interrupter* interrupter_;
  Int32Grid::Ptr current_;               // null: still the original
  std::map<int32_t, Grain> grains_;      // by number
  std::map<int32_t, std::string> gone_;  // and by which edit
  bool changed_ = false;                 // since the grid was made
  std::optional<detail::GrainParts> parts_;
  EditResult result_;
};

void describe(EditedLabels& edited) {
  openvdb::GridBase& grid = *edited.labels;
  if (edited.results.empty()) return;
  removeGraph(grid);  // of manifolds, should these have been edited themselves
  updateCounts(grid, edited.grains, edited.voxels != edited.voxelsBefore);
  const auto stored = grid.getMetadata<openvdb::StringMetadata>(kEditsKey);
  std::string text = stored ? stored->value() : "";
  for (const EditResult& result : edited.results)
    text += (text.empty() ? "" : "; ") + toString(result.edit);
  grid.insertMeta(kEditsKey, openvdb::StringMetadata(text));
}

}  // namespace

EditedLabels editLabels(const Int32Grid& labels, const std::vector<Edit>& edits,
                        const Int32Grid* manifold, Interrupter* interrupter) {
  Editor editor(labels, manifold, interrupter);
  EditedLabels edited;
  edited.grainsBefore = editor.grainCount();
  edited.voxelsBefore = editor.voxelCount();
  for (const Edit& edit : edits) {
    try {
      edited.results.push_back(editor.apply(edit));
    } catch (const InvalidInput& error) {
      throw InvalidInput(named(edit) + ": " + error.what(), error.hint());
    }
  }
  edited.grains = editor.grainCount();
  edited.voxels = editor.voxelCount();
  edited.labels = editor.finish();
  describe(edited);
  return edited;
}

}  // namespace vdb_madf
