// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <exception>
#include <mutex>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/hdf5_driver.h"
#include "vdb_madf/files/detail/hdf5_handle.h"
#include "vdb_madf/files/detail/output_stream.h"

// This header is for rooms that link libhdf5; the room files does not.

namespace vdb_madf::detail {

/// The library, for one thread at a time (not every build of it sees to that), and silent.
class Hdf5Turn {
 public:
  Hdf5Turn() : lock_(mutex()) {}

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  Hdf5Quiet quiet_;
};

/// An HDF5 file that appears whole or not at all. What is written into it has the same bytes
/// whenever it is written: no object keeps the time. Its functions, and those of the library that
/// are given its objects, are called while an Hdf5Turn lives.
class Hdf5Output {
 public:
  /// @throw IoError
  explicit Hdf5Output(const std::string& path) : out_(path), target_{out_}, file_(-1, H5Fclose) {
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose),
        creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation, false);         // of the group of all
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);  // with all that is open in it
    Hdf5Driver::choose(access, target_);
    file_ = Hdf5Handle(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose);
    check(bool(file_));
  }

  hid_t id() const { return file_; }

  /// @throw IoError
  void commit() {
    check(file_.close() >= 0);
    out_.commit();
  }

  /// @throw IoError unless the library has done what it was asked for, and all could be written.
  void check(bool done) const {
    if (target_.error) std::rethrow_exception(target_.error);
    if (!done)
      throw IoError("cannot write " + out_.path() + ": libhdf5 fails to; write another format");
  }
  Hdf5Handle checked(Hdf5Handle object) const {
    check(bool(object));
    return object;
  }

 private:
  OutputStream out_;
  Hdf5Driver::Target target_;
  Hdf5Handle file_;  // goes before what it is written to
};

/// The creation list of objects that do not keep the time.
inline Hdf5Handle timelessDataset() {
  Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);
  return creation;
}

/// A list of numbers as an attribute. @return whether the library has written it
inline bool writeHdf5Attribute(hid_t object, const char* name, hid_t type, hid_t memory,
                               hsize_t count, const void* values) {
  const Hdf5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Hdf5Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  return attribute && H5Awrite(attribute, memory, values) >= 0;
}

}  // namespace vdb_madf::detail
