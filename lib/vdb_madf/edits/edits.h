// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace vdb_madf {

/// One change of labels (edit_labels.h), and its text: a word and what it is of, parted by spaces
/// or commas.
struct Edit {
  enum class Kind {
    split,        ///< "split 9"
    merge,        ///< "merge 12 17": two or more; the first gives its number
    drop,         ///< "drop 5 6"
    keep,         ///< "keep 1 2 3": all others go
    minVoxels,    ///< "min-voxels 100": grains of fewer go
    maxVoxels,    ///< "max-voxels 5000": grains of more go
    minDiameter,  ///< "min-diameter 100um": grains of a smaller equivalent diameter go
    maxDiameter,  ///< "max-diameter 1mm"
    joinBelow,    ///< "join-below 27": grains of fewer voxels become part of a neighbor
    dropAtFaces,  ///< "drop-at-faces": what the domain may have cut goes
    renumber,     ///< "renumber": 1, 2, 3 ... in the order of the numbers
    strictness    ///< "strictness 10.5": changes nothing; others are of labels merged with this one
  };
  Kind kind = Kind::renumber;
  std::vector<int32_t> grains;  ///< of split, merge, drop, keep
  int64_t voxels = 0;           ///< of minVoxels, maxVoxels, joinBelow
  double diameter = 0;          ///< of minDiameter, maxDiameter; meters
  double strictness = 0;
};

/// "split", "min-voxels" ...
const char* toString(Edit::Kind kind);
/// The text that parseEdit() reads.
std::string toString(const Edit& edit);

/// Takes next to no time.
/// @throw InvalidInput unless it names as many grains as it takes, none twice, and its numbers are
///   finite
void checkEdit(const Edit& edit);

/// @throw InvalidInput, one line without the text: an unknown word, numbers that cannot be grains
///   or are there twice, too few or too many.
Edit parseEdit(const std::string& text);
/// A line an edit; empty lines, and what follows a '#', are passed over.
/// @throw InvalidInput that names the line.
std::vector<Edit> parseEdits(const std::string& text);

}  // namespace vdb_madf
