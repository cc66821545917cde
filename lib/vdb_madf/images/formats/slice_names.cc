// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/slice_names.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "vdb_madf/base/counted.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// Longer numbers, of which an int64_t might not hold the difference, are left as text.
constexpr size_t kMaxDigits = 18;

struct SliceName {
  std::string name;
  std::string kind;  ///< the name with '#' for each number
  std::vector<int64_t> numbers;
  std::vector<size_t> digits;  ///< of each number
};

SliceName parsed(const std::string& path) {
  SliceName result;
  result.name = std::filesystem::path(path).filename().string();
  const std::string& name = result.name;
  for (size_t i = 0; i < name.size();) {
    size_t end = i;
    while (end < name.size() && isDigit(name[end])) ++end;
    if (end == i || end - i > kMaxDigits) {
      end += end == i;
      result.kind.append(name, i, end - i);
    } else {
      result.kind += '#';
      result.numbers.push_back(std::stoll(name.substr(i, end - i)));
      result.digits.push_back(end - i);
    }
    i = end;
  }
  return result;
}

using Names = std::vector<SliceName>;

struct Gaps {
  int64_t missing = 0;
  size_t places = 0, twice = 0;
  std::string first, firstTwice;  ///< "a6.tif and a8.tif"
  int64_t stride = 1;             ///< above 1: slices are numbered by it throughout
  std::string firstStride;
  std::string otherOrder;  ///< where a number goes back
  std::string decimals;    ///< two of them whose order is not that of whole numbers
};

std::string both(const SliceName& a, const SliceName& b) {
  return a.name + " and " + b.name;
}

/// Which number counts the slices; that of any if all names are equal but for leading zeros.
size_t counterOf(const Names& names, size_t begin, size_t end) {
  for (size_t n = 0; n < names[begin].numbers.size(); ++n)
    for (size_t i = begin; i < end; ++i)
      if (names[i].numbers[n] != names[begin].numbers[n]) return n;
  return 0;
}

/// The step that most neighbors have, the smaller of two; 0 if it is not that of half of them.
int64_t usualStep(const std::vector<int64_t>& steps) {
  std::map<int64_t, size_t> counts;
  for (const int64_t step : steps)
    if (step > 0) ++counts[step];
  int64_t usual = 0;
  for (const auto& [step, count] : counts)
    if (usual == 0 || count > counts[usual]) usual = step;
  return usual > 0 && 2 * counts[usual] >= steps.size() ? usual : 0;
}

/// Finds where a number behind the counter goes back, if that may well be the one that counts.
/// @return names.end() if there is none
Names::const_iterator otherOrder(Names::const_iterator begin, Names::const_iterator end,
                                 size_t counter) {
  const auto valuesOf = [&](size_t n) {
    std::set<int64_t> values;
    for (auto name = begin; name != end; ++name) values.insert(name->numbers[n]);
    return values;
  };
  const auto range = [](const std::set<int64_t>& values) {
    return *values.rbegin() - *values.begin();
  };
  const std::set<int64_t> own = valuesOf(counter);
  const auto count = size_t(end - begin);
  for (size_t n = counter + 1; n < begin->numbers.size(); ++n) {
    const std::set<int64_t> other = valuesOf(n);
    if (own.size() == count && (other.size() < count || range(other) >= range(own))) continue;
    const auto back = std::adjacent_find(begin, end, [&](const SliceName& a, const SliceName& b) {
      return a.numbers[counter] < b.numbers[counter] && b.numbers[n] < a.numbers[n];
    });
    if (back != end) return back;
  }
  return end;
}

/// Where the kind of a name goes on behind so many numbers.
size_t behind(const SliceName& name, size_t numbers) {
  size_t at = 0;
  for (size_t n = 0; n < numbers; ++n) at = name.kind.find('#', at) + 1;
  return at;
}

/// Whether a number is what stands behind the point of a decimal.
bool isFraction(const SliceName& name, size_t number) {
  return number > 0 && name.kind.compare(behind(name, number), 2, ".#") == 0;
}

/// So many equal steps may well be chance, or heights.
constexpr size_t kFewSteps = 2;

/// Of names [begin, end), which are of one kind.
void addGaps(const Names& names, size_t begin, size_t end, Gaps& gaps) {
  if (end - begin < 2 || names[begin].numbers.empty()) return;
  const size_t counter = counterOf(names, begin, end);
  const auto first = names.begin() + std::ptrdiff_t(begin),
             last = names.begin() + std::ptrdiff_t(end);
  if (const auto back = otherOrder(first, last, counter); back != last) {
    if (gaps.otherOrder.empty()) gaps.otherOrder = both(back[0], back[1]);
    for (size_t from = begin, to = begin; from < end; from = to) {  // each scan by itself
      while (to < end && names[to].numbers[counter] == names[from].numbers[counter]) ++to;
      addGaps(names, from, to, gaps);
    }
    return;
  }
  std::vector<int64_t> steps;
  for (size_t i = begin + 1; i < end; ++i) {
    steps.push_back(names[i].numbers[counter] - names[i - 1].numbers[counter]);
    if (names[i].numbers != names[i - 1].numbers) continue;
    if (gaps.twice++ == 0) gaps.firstTwice = both(names[i - 1], names[i]);
  }
  const int64_t step = usualStep(steps);
  const auto otherDigits = std::adjacent_find(first, last, [&](const auto& a, const auto& b) {
    return a.digits[counter] != b.digits[counter];
  });
  if (step != 1 && otherDigits != last && isFraction(*first, counter) && gaps.decimals.empty())
    gaps.decimals = both(otherDigits[0], otherDigits[1]);
  if (step == 0) return;
  if (step > 1 && steps.size() > kFewSteps && gaps.stride == 1 &&
      std::all_of(steps.begin(), steps.end(), [&](int64_t other) { return other == step; })) {
    gaps.stride = step;
    gaps.firstStride = both(names[begin], names[begin + 1]);
  }
  for (size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] < 2 * step) continue;
    gaps.missing += steps[i] / step - 1;
    if (gaps.places++ == 0) gaps.first = both(names[begin + i], names[begin + i + 1]);
  }
}

/// A name with a minus before a number and one without, or with a plus; empty: there are none.
std::string negativeAmong(const Names& names) {
  std::map<std::string, const SliceName*> kinds;
  for (const SliceName& name : names) kinds.emplace(name.kind, &name);
  for (const auto& [kind, name] : kinds)
    for (size_t at = 0; (at = kind.find("-#", at)) != std::string::npos; ++at)
      for (const char* const other : {"#", "+#"})
        if (const auto found = kinds.find(std::string(kind).replace(at, 2, other));
            found != kinds.end())
          return both(*name, *found->second);
  return "";
}

/// Whether one name has a fraction behind a number that the other one has without.
bool isBetween(const SliceName& decimal, const SliceName& whole) {
  for (size_t n = 1; n < decimal.numbers.size(); ++n) {
    if (!isFraction(decimal, n)) continue;
    if (std::string(decimal.kind).erase(behind(decimal, n), 2) == whole.kind &&
        std::equal(decimal.numbers.begin(), decimal.numbers.begin() + std::ptrdiff_t(n),
                   whole.numbers.begin()))
      return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> numberingNotes(const std::string& folder,
                                        const std::vector<std::string>& paths) {
  Names names;
  for (const std::string& path : paths) names.push_back(parsed(path));
  if (const std::string signs = negativeAmong(names); !signs.empty())
    throw IoError(folder + ": numbers of slices are below 0, as in " + signs +
                  ": rename them so that they count from 0 on");
  Gaps gaps;
  std::set<std::string> kinds;
  std::string change;  // where the first kind ends
  bool isNumbered = false;
  for (size_t begin = 0, end = 0; begin < names.size(); begin = end) {
    while (end < names.size() && names[end].kind == names[begin].kind) ++end;
    addGaps(names, begin, end, gaps);
    kinds.insert(names[begin].kind);
    isNumbered = isNumbered || (end - begin > 1 && !names[begin].numbers.empty());
    if (end == names.size()) break;
    if (change.empty()) change = both(names[end - 1], names[end]);
    if (gaps.decimals.empty() && isBetween(names[end - 1], names[end]))
      gaps.decimals = both(names[end - 1], names[end]);
  }

  if (!gaps.decimals.empty())
    throw IoError(folder + ": slices are numbered by decimals of unequal digits, as " +
                  gaps.decimals + ", whose order is not that of whole numbers: rename them");
  std::vector<std::string> notes;
  if (!gaps.otherOrder.empty())
    notes.push_back(
        folder +
        ": names have several numbers that vary, and slices are ordered by the first of "
        "them, as " +
        gaps.otherOrder +
        ": if these are of several scans, give each scan a folder; if another number "
        "counts the slices, rename them");
  if (gaps.missing > 0)
    notes.push_back(folder + ": " + counted(gaps.missing, "slice") + " missing " +
                    (gaps.places == 1
                         ? "between "
                         : "in " + std::to_string(gaps.places) + " places, the first between ") +
                    gaps.first + ", by their numbers; what follows is moved up to close the gap");
  if (gaps.stride > 1)
    notes.push_back(folder + ": slices are numbered by " + std::to_string(gaps.stride) + ", as " +
                    gaps.firstStride +
                    ", and taken for neighbors: if those between them were left "
                    "out, give the voxel size along z, which is then " +
                    std::to_string(gaps.stride) + " times the scan's");
  if (gaps.twice > 0)
    notes.push_back(folder + ": " + counted(gaps.twice, "number") +
                    " of slices there twice, as in " + gaps.firstTwice + "; both are taken");
  if (kinds.size() > 1 && isNumbered)
    notes.push_back(folder + ": names of " + std::to_string(kinds.size()) + " kinds, as " + change +
                    "; all files are taken for slices of one stack");
  return notes;
}

}  // namespace vdb_madf::detail
