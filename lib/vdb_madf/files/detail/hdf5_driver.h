// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <hdf5.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

#include <algorithm>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <string>

#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf::detail {

/// What libhdf5 writes goes to an OutputStream. Errors, as of a full disk, are kept from the
/// library, which crashes at the end of the program if a file could not be closed: what cannot be
/// written any more (at most what is being written, and the library's buffers) stays in memory,
/// until the file is closed and its writer asks for the error.
class Hdf5Driver {
 public:
  /// The stream that the bytes go to; it outlives the file.
  struct Target {
    OutputStream& out;
    std::exception_ptr error = {};                  ///< the first
    std::map<haddr_t, std::string> unwritten = {};  ///< by place; since then
  };

  /// Lets H5Fcreate, which reads `access`, write to this target.
  static void choose(hid_t access, Target& target) {
    static const hid_t driver = add();
    const Info info{&target};
    H5Pset_driver(access, driver, &info);
  }

 private:
  struct Info {
    Target* target;
  };
  struct File {
    H5FD_t base;  // the library's part comes first
    Target* target;
    haddr_t end;  ///< of what the library has allotted
  };

  static Target& targetOf(const H5FD_t* file) {
    return *reinterpret_cast<const File*>(file)->target;
  }

  static hid_t add() {
    H5FD_class_t driver{};
#if H5_VERSION_GE(1, 13, 0)
    driver.version = H5FD_CLASS_VERSION;
    driver.value = H5FD_class_value_t(H5_VFD_RESERVED + 1);
#endif
    driver.name = "vdb_madf";
    driver.maxaddr = (haddr_t(1) << 62) - 1;
    driver.fc_degree = H5F_CLOSE_STRONG;
    driver.fapl_size = sizeof(Info);
    driver.open = open;
    driver.close = [](H5FD_t* file) -> herr_t {
      delete reinterpret_cast<File*>(file);
      return 0;
    };
    driver.cmp = [](const H5FD_t* a, const H5FD_t* b) {
      return a == b ? 0 : std::less<const H5FD_t*>()(a, b) ? -1 : 1;
    };
    driver.query = [](const H5FD_t*, unsigned long* flags) -> herr_t {
      *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
               H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
      return 0;
    };
    driver.get_eoa = [](const H5FD_t* file, H5FD_mem_t) {
      return reinterpret_cast<const File*>(file)->end;
    };
    driver.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t end) -> herr_t {
      reinterpret_cast<File*>(file)->end = end;
      return 0;
    };
    driver.get_eof = [](const H5FD_t* file, H5FD_mem_t) { return endOf(targetOf(file)); };
    driver.read = read;
    driver.write = [](H5FD_t* file, H5FD_mem_t, hid_t, haddr_t place, size_t count,
                      const void* bytes) -> herr_t {
      Target& target = targetOf(file);
      if (!attempt(target, [&](OutputStream& out) { out.writeAt(place, bytes, count); }))
        target.unwritten[place].assign(static_cast<const char*>(bytes), count);
      return 0;
    };
    driver.truncate = [](H5FD_t* file, hid_t, hbool_t) -> herr_t {
      const haddr_t end = reinterpret_cast<File*>(file)->end;
      attempt(targetOf(file), [end](OutputStream& out) {
        if (out.size() != end) out.resize(end);
      });
      return 0;
    };
    const H5FD_mem_t kinds[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
    std::copy_n(kinds, int(H5FD_MEM_NTYPES), driver.fl_map);
    return H5FDregister(&driver);
  }

  static H5FD_t* open(const char*, unsigned, hid_t access, haddr_t) {
    const auto* info = static_cast<const Info*>(H5Pget_driver_info(access));
    return info ? reinterpret_cast<H5FD_t*>(new File{{}, info->target, 0}) : nullptr;
  }

  static haddr_t endOf(const Target& target) {
    haddr_t end = target.out.size();
    for (const auto& [place, bytes] : target.unwritten) end = std::max(end, place + bytes.size());
    return end;
  }

  /// False after an error.
  template <typename Work>
  static bool attempt(Target& target, const Work& work) {
    if (target.error) return false;
    try {
      work(target.out);
    } catch (...) {
      target.error = std::current_exception();
    }
    return !target.error;
  }

  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t place, size_t count, void* bytes) {
    const Target& target = targetOf(file);
    try {
      const size_t found = target.out.readAt(place, bytes, count);
      std::memset(static_cast<char*>(bytes) + found, 0, count - found);
    } catch (...) {
      return -1;
    }
    for (const auto& [start, later] : target.unwritten) {
      const haddr_t begin = std::max(start, place),
                    end = std::min<haddr_t>(start + later.size(), place + count);
      if (begin < end)
        std::memcpy(static_cast<char*>(bytes) + (begin - place), later.data() + (begin - start),
                    end - begin);
    }
    return 0;
  }
};

}  // namespace vdb_madf::detail
