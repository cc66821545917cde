// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/slab_exits.h"

#include <algorithm>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/flow.h"

namespace vdb_madf::detail {

size_t SlabExits::slabOf(int z) const {
  return size_t(std::upper_bound(cuts_.begin(), cuts_.end(), z) - cuts_.begin()) - 1;
}

uint32_t SlabExits::slabOfTerminal(uint32_t terminal) const {
  return uint32_t(std::upper_bound(first_.begin(), first_.end(), terminal) - first_.begin()) - 1;
}

std::vector<SlabExits::Foreign>::const_iterator SlabExits::foreignFrom(uint32_t terminal) const {
  return std::lower_bound(foreign_.begin(), foreign_.end(), terminal,
                          [](const Foreign& a, uint32_t number) { return a.terminal < number; });
}

size_t SlabExits::sharedFrom(uint32_t terminal) const {
  return size_t(
      std::lower_bound(shared_.begin(), shared_.end(), terminal,
                       [](const Shared& a, uint32_t number) { return a.terminal < number; }) -
      shared_.begin());
}

void SlabExits::add(size_t terminals, const std::vector<Exit>& exits) {
  const uint32_t first = first_.back();
  if (first + terminals >= Flow::kOwnCell)
    throw InvalidInput("there are more than 2^31 critical points: coarsen the volume");
  questions_.resize(cuts_.size() - 1);
  for (const Exit& exit : exits) {
    questions_[slabOf(exit.position.z())].push_back({exit.position, uint32_t(foreign_.size())});
    foreign_.push_back({first + exit.terminal, first + exit.terminal, {}, 0});
  }
  first_.push_back(first + uint32_t(terminals));
}

const std::vector<SlabExits::Question>& SlabExits::questions(size_t slab) {
  std::sort(questions_[slab].begin(), questions_[slab].end(),
            [](const Question& a, const Question& b) { return a.position < b.position; });
  return questions_[slab];
}

void SlabExits::answer(size_t slab, const Question& question, uint32_t terminal,
                       const CriticalPoint& point) {
  Foreign& foreign = foreign_[question.asking];
  foreign.next = first_[slab] + (terminal & ~Flow::kOwnCell) - 1;
  foreign.position = point.position;
  foreign.squaredRadius = point.squaredRadius;
}

void SlabExits::finish() {
  questions_ = {};
  for (uint32_t i = 0; i < foreign_.size(); ++i) {
    Foreign& foreign = foreign_[i];
    // D rises on the way: there is an end.
    for (auto next = foreignFrom(foreign.next);
         next != foreign_.end() && next->terminal == foreign.next;
         next = foreignFrom(foreign.next)) {
      foreign.next = next->next;
      foreign.position = next->position;
      foreign.squaredRadius = next->squaredRadius;
    }
    const uint32_t from = slabOfTerminal(foreign.terminal), to = slabOfTerminal(foreign.next);
    shared_.push_back({foreign.next, std::min(from, to), std::max(from, to), i});
  }
  std::sort(shared_.begin(), shared_.end(), [](const Shared& a, const Shared& b) {
    return a.terminal != b.terminal ? a.terminal < b.terminal : a.foreign < b.foreign;
  });
  size_t count = 0;
  for (const Shared& shared : shared_) {
    if (count == 0 || shared_[count - 1].terminal != shared.terminal) {
      shared_[count++] = shared;
      continue;
    }
    Shared& all = shared_[count - 1];
    all.first = std::min(all.first, shared.first);
    all.last = std::max(all.last, shared.last);
  }
  shared_.resize(count);
  shared_.shrink_to_fit();
}

void SlabExits::tellNumbers(size_t slab, const std::vector<uint32_t>& numbers) {
  for (size_t i = sharedFrom(first_[slab]); i < sharedFrom(first_[slab + 1]); ++i)
    shared_[i].number = numbers[shared_[i].terminal - first_[slab]];
}

SlabRoot SlabExits::rootOf(const Shared& shared) const {
  const Foreign& foreign = foreign_[shared.foreign];
  return {{foreign.position, foreign.squaredRadius, 0}, shared.number, shared.first, shared.last};
}

std::vector<SlabLead> SlabExits::leads(size_t slab) const {
  std::vector<SlabLead> leads;
  for (size_t i = sharedFrom(first_[slab]); i < sharedFrom(first_[slab + 1]); ++i)
    leads.push_back({shared_[i].terminal - first_[slab], rootOf(shared_[i])});
  const auto end = foreignFrom(first_[slab + 1]);
  for (auto foreign = foreignFrom(first_[slab]); foreign != end; ++foreign)
    leads.push_back({foreign->terminal - first_[slab], rootOf(shared_[sharedFrom(foreign->next)])});
  return leads;
}

}  // namespace vdb_madf::detail
