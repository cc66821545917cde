// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/hdf5_sources.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/hdf5_handle.h"
#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf::detail {

namespace {

/// A virtual dataset of virtual datasets of ... ends somewhere.
constexpr int kMaxDepth = 8;
/// h5repack writes the samples of any dataset into one file.
const std::string kAdvice = ": h5repack -l CONTI puts all into one file";

class SourceFinder {
 public:
  SourceFinder(const std::string& path, const std::string& name)
      : what_(path + ": dataset " + inQuotes(name)) {}

  Hdf5Sources find(hid_t dataset) {
    add(dataset, 0);
    return std::move(sources_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw IoError(what_ + " " + why); }

  void add(hid_t dataset, int depth) {
    const Hdf5Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    const Hdf5Handle file(H5Iget_file_id(dataset), H5Fclose);
    if (!creation || !file) fail("is damaged");
    const std::string path =
        hdf5Text([&](char* to, size_t size) { return H5Fget_name(file, to, size); });
    if (std::find(sources_.files.begin(), sources_.files.end(), path) == sources_.files.end())
      sources_.files.push_back(path);
    if (H5Pget_external_count(creation) > 0) fail("has its samples in raw files" + kAdvice);
    if (H5Pget_layout(creation) != H5D_VIRTUAL) {
      sources_.bytes += std::min<uint64_t>(H5Dget_storage_size(dataset), InputFile(path).size());
      return;
    }
    sources_.isVirtual = true;
    if (depth == kMaxDepth) fail("is made of virtual datasets without an end");
    addParts(creation, file, path, depth);
  }

  void addParts(hid_t creation, hid_t own, const std::string& path, int depth) {
    size_t count = 0;
    if (H5Pget_virtual_count(creation, &count) < 0) fail("is damaged");
    std::set<std::string> seen;
    for (size_t i = 0; i < count; ++i) {
      const std::string file = hdf5Text(
          [&](char* to, size_t size) { return H5Pget_virtual_filename(creation, i, to, size); });
      const std::string name = hdf5Text(
          [&](char* to, size_t size) { return H5Pget_virtual_dsetname(creation, i, to, size); });
      if (file.find('%') != std::string::npos || name.find('%') != std::string::npos)
        fail("is virtual, of any number of files " + inQuotes(file) + kAdvice);
      const Hdf5Handle opened = file == "." ? Hdf5Handle(-1, H5Fclose) : open(file, path);
      const Hdf5Handle part = openHdf5Dataset(file == "." ? own : hid_t(opened), name);
      if (!part)
        fail("is virtual, and a part of it, " + inQuotes(name) + " of the file " + inQuotes(file) +
             ", is missing");
      checkExtent(creation, i, part, file);
      if (!seen.insert(file + "\n" + name).second) continue;  // counted already
      add(part, depth + 1);
    }
  }

  /// As the library finds it, too: an absolute path, or one beside the virtual dataset's file.
  Hdf5Handle open(const std::string& file, const std::string& path) const {
    const std::string place = (std::filesystem::path(path).parent_path() / file).string();
    try {
      const InputFile exists(place);
    } catch (const IoError& error) {
      fail("is virtual, and the file of a part of it has to be there: " +
           std::string(error.what()));
    }
    Hdf5Handle opened = openHdf5File(place);
    if (!opened) fail("is virtual, and " + place + " is damaged or no HDF5 file");
    return opened;
  }

  void checkExtent(hid_t creation, size_t index, hid_t part, const std::string& file) const {
    const std::vector<hsize_t> lengths = hdf5Lengths(part);
    const Hdf5Handle from(H5Pget_virtual_srcspace(creation, index), H5Sclose),
        to(H5Pget_virtual_vspace(creation, index), H5Sclose);
    bool fits = from && to && !lengths.empty();
    if (fits && H5Sget_select_type(from) == H5S_SEL_ALL) {  // its extent is not in the file
      hssize_t samples = 1;
      for (const hsize_t length : lengths) samples *= hssize_t(length);
      fits = H5Sget_select_npoints(to) == samples;
    } else if (fits) {
      std::vector<hsize_t> first(lengths.size()), last(lengths.size());
      fits = H5Sget_simple_extent_ndims(from) == int(lengths.size()) &&
             H5Sget_select_bounds(from, first.data(), last.data()) >= 0;
      for (size_t axis = 0; fits && axis < lengths.size(); ++axis)
        fits = last[axis] < lengths[axis];
    }
    if (!fits)
      fail("is virtual, and its part of the file " + inQuotes(file) + " is of another size");
  }

  std::string what_;
  Hdf5Sources sources_;
};

}  // namespace

Hdf5Sources hdf5Sources(const std::string& path, const std::string& name, hid_t dataset) {
  return SourceFinder(path, name).find(dataset);
}

std::string missingHdf5Link(hid_t file, const std::string& name) {
  for (size_t end = 0; end < name.size();) {
    end = std::min(name.find('/', end + 1), name.size());
    const std::string link = name.substr(0, end);
    H5L_info_t info;
    if (H5Lget_info(file, link.c_str(), &info, H5P_DEFAULT) < 0) return "";
    if (info.type != H5L_TYPE_EXTERNAL) continue;
    std::vector<char> value(info.u.val_size);
    const char *target = nullptr, *object = nullptr;
    unsigned flags = 0;
    if (H5Lget_val(file, link.c_str(), value.data(), value.size(), H5P_DEFAULT) < 0 ||
        H5Lunpack_elink_val(value.data(), value.size(), &flags, &target, &object) < 0)
      return "";
    return inQuotes(target) + " (" + object + ")";
  }
  return "";
}

}  // namespace vdb_madf::detail
