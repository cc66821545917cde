// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <hdf5.h>

#include <string>
#include <utility>
#include <vector>

namespace vdb_madf::detail {

/// An open object of libhdf5.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*closeObject)(hid_t)) : id_(id), close_(closeObject) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  explicit operator bool() const { return id_ >= 0; }
  operator hid_t() const { return id_; }
  /// What the library says of it, negative if it fails; 0 if nothing is open.
  herr_t close() {
    const hid_t id = std::exchange(id_, -1);
    return id >= 0 ? close_(id) : 0;
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// While it lives, the library does not print its errors.
class Hdf5Quiet {
 public:
  Hdf5Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Hdf5Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Hdf5Quiet(const Hdf5Quiet&) = delete;
  Hdf5Quiet& operator=(const Hdf5Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

inline Hdf5Handle openHdf5File(const std::string& path) {
  return Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
}

inline Hdf5Handle openHdf5Dataset(hid_t file, const std::string& name, hid_t access = H5P_DEFAULT) {
  return Hdf5Handle(H5Dopen2(file, name.c_str(), access), H5Dclose);
}

/// The lengths of the axes; empty if there are none or too many.
inline std::vector<hsize_t> hdf5Lengths(hid_t dataset) {
  constexpr int kMostAxes = 8;
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  if (!space) return {};
  const int axes = H5Sget_simple_extent_ndims(space);
  if (axes < 1 || axes > kMostAxes) return {};
  std::vector<hsize_t> lengths(static_cast<size_t>(axes));
  if (H5Sget_simple_extent_dims(space, lengths.data(), nullptr) < 0) return {};
  return lengths;
}

/// What a function of the library writes into a buffer of the size that it says. "" if it cannot.
template <typename Get>
std::string hdf5Text(const Get& get) {
  const auto length = get(nullptr, size_t(0));
  if (length <= 0) return "";
  std::string text(size_t(length) + 1, '\0');
  if (get(text.data(), text.size()) < 0) return "";
  text.resize(size_t(length));
  return text;
}

}  // namespace vdb_madf::detail
