// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <stdexcept>
#include <string>

namespace vdb_madf {

/// What the caller can give to get further. The messages do without names of options: a program
/// that has some can add them.
enum class Hint {
  none,
  rawLayout,      ///< size and type of a file without a header
  dataset,        ///< which array of a file
  voxelSize,      ///< instead of the file's
  memoryLimit,    ///< a higher one
  manifolds,      ///< a segmentation that keeps them
  smallerLabels,  ///< a reduced copy of the labels
  areLabels,      ///< that these are labels
  unverified,     ///< that files are read whatever their digests say
};

/// What can be told with a hint.
class HintedError : public std::runtime_error {
 public:
  explicit HintedError(const std::string& what, Hint hint = Hint::none)
      : std::runtime_error(what), hint_(hint) {}
  Hint hint() const { return hint_; }

 private:
  Hint hint_;
};

/// The caller's data or options cannot be worked with; what() is one line that says why and what to
/// do.
class InvalidInput : public HintedError {
  using HintedError::HintedError;
};

/// A file cannot be read or written; what() is one line that names the file.
class IoError : public HintedError {
  using HintedError::HintedError;
};

/// The caller's interrupter asked to stop; no partial result exists.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace vdb_madf
