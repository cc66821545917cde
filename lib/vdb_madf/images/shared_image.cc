// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/shared_image.h"

#include "vdb_madf/files/detail/shared_file.h"
#include "vdb_madf/images/detail/header_checks.h"

namespace vdb_madf {

namespace {

class PartWriter : public ImageWriter {
 public:
  PartWriter(const std::string& path, const SharedImage& shared, const ImageInfo& info, int first)
      : path_(path),
        info_(info),
        offset_(shared.offset),
        next_(first),
        file_(path, shared.temporary) {}

  void write(int count, const void* samples) override {
    detail::checkSlices(path_, info_, next_, count);
    const uint64_t slice = detail::sliceBytes(info_);
    file_.writeAt(offset_ + slice * uint64_t(next_), samples, size_t(slice) * size_t(count));
    next_ += count;
  }
  void finish() override { file_.finish(); }

 private:
  std::string path_;
  ImageInfo info_;
  uint64_t offset_;
  int next_;  // slice
  detail::SharedFile file_;
};

}  // namespace

std::unique_ptr<ImageWriter> joinImage(const std::string& path, const SharedImage& shared,
                                       const ImageInfo& info, int first) {
  return std::make_unique<PartWriter>(path, shared, info, first);
}

}  // namespace vdb_madf
