// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/formats/tiff.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/length_unit.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/key_value_header.h"
#include "vdb_madf/images/formats/ome_xml.h"
#include "vdb_madf/images/formats/slice_folder.h"
#include "vdb_madf/images/formats/slice_names.h"
#include "vdb_madf/images/formats/tiff_page.h"

namespace vdb_madf::detail {

namespace {

std::string description(const TiffFile& file) {
  const char* found = file.handle().field<const char*>(TIFFTAG_IMAGEDESCRIPTION, nullptr);
  return found ? found : "";
}

/// What ImageJ writes into the description of a stack: lines of key=value.
KeyValueHeader imageJDescription(const TiffFile& file) {
  HeaderSyntax syntax;
  syntax.skipsOtherLines = true;
  const std::string text = description(file);
  return KeyValueHeader(file.path(), text.compare(0, 7, "ImageJ=") == 0 ? text : "", syntax);
}

std::optional<double> numberIn(const KeyValueHeader& imageJ, const std::string& key) {
  const auto values = reals(imageJ.find(key).value_or(""));
  if (!values || values->size() != 1) return std::nullopt;
  return values->front();
}

/// The shortest decimal whose reciprocal is the number, to its precision: who wrote 0.8333333 meant
/// an edge of 1.2, and the method weighs axes by the ratio of their edges.
double decimalOfReciprocal(float number) {
  constexpr int kMaxDigits = 8;
  const double exact = 1.0 / double(number);
  for (int digits = 1; digits <= kMaxDigits; ++digits) {
    const double decimal = leadingReal(generalDecimal(exact, digits)).value;
    if (std::abs(1.0 / decimal - double(number)) <=
        std::numeric_limits<float>::epsilon() * double(number))
      return decimal;
  }
  return exact;
}

/// Only the calibrations of OME and ImageJ are trusted: the plain resolution tags are mostly a
/// scanner's or a printer's default of 72 dots per inch.
void setCalibration(ImageInfo& info, const TiffFile& file, const KeyValueHeader& imageJ,
                    const OmePixels& ome, int slices) {
  if (ome.images() > 0) {
    info.voxelSize = ome.voxelSize(file.path());
    return;
  }
  const auto unit = unitsPerMetre(imageJ.find("unit").value_or(""));
  const float perX = file.handle().field<float>(TIFFTAG_XRESOLUTION, 0);
  const float perY = file.handle().field<float>(TIFFTAG_YRESOLUTION, 0);
  // Without a unit the tags are no one's, but where ImageJ says that they have none, either.
  const bool isPlain =
      file.handle().field<uint16_t>(TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH) == RESUNIT_NONE;
  if (!(unit || isPlain) || !(perX > 0) || !(perY > 0)) return;
  const double x = 1.0 / double(perX), y = 1.0 / double(perY);
  // ImageJ leaves out a slice spacing of 1; then nobody may have set it.
  const auto z = numberIn(imageJ, "spacing");
  if (!unit && !(z && std::isfinite(*z) && *z != 0)) return;
  if (!z && slices > 1 && std::abs(x - 1) > 1e-3) return;
  // The text is exact and the tags are single precision: the text comes first. Its sign is the
  // order of the slices.
  const double depth = z ? std::abs(*z) : slices > 1 ? 1.0 : x;
  if (areEdgesOfCube({depth, x, y}))
    info.voxelSize = checkedVoxelSize(file.path(), {depth, depth, depth}, unit);
  else
    setSpacing(info, file.path(), {decimalOfReciprocal(perX), decimalOfReciprocal(perY), depth},
               unit);
}

/// The pages have to be the slices of one volume, and all of them.
void checkOme(const TiffFile& file, const OmePixels& ome, uint16_t channels, int64_t slices) {
  if (ome.images() > 1) file.handle().fail("has several images: save one as a stack of its own");
  for (const auto& [axis, name] : {std::pair{"C", "channels"}, {"T", "times"}})
    if (ome.size(axis) > (axis[0] == 'C' ? channels : 1))
      file.handle().fail(std::string("has several ") + name + ": save one as a stack of its own");
  if (ome.size("Z") > slices)
    file.handle().fail("holds " + std::to_string(slices) + " of the " +
                       std::to_string(ome.size("Z")) +
                       " slices that it describes: the others are in other files; save one stack");
  if (!ome.isInOrder())
    file.handle().fail(
        "has its slices in another order than its pages, by its TiffData, or only in "
        "some of them: save one stack");
}

/// How many slices tifffile wrote behind one page, where its description says that it did; else 1.
double truncatedSlices(const TiffFile& file, const TiffPage& page) {
  const std::string text = description(file), key = "\"shape\": [";
  const size_t begin = text.find(key), end = text.find(']', begin);
  if (text.compare(0, 1, "{") != 0 || begin == std::string::npos || end == std::string::npos ||
      text.find("\"truncated\": true") == std::string::npos)
    return 1;
  std::string shape = text.substr(begin + key.size(), end - begin - key.size());
  std::replace(shape.begin(), shape.end(), ',', ' ');
  double samples = 1;
  for (const int64_t length : integers(shape).value_or(std::vector<int64_t>()))
    samples *= double(length);
  return samples / (double(page.width) * double(page.height));
}

void rejectHyperstack(const TiffFile& file, const KeyValueHeader& imageJ) {
  for (const char* axis : {"channels", "frames"})
    if (numberIn(imageJ, axis).value_or(1) > 1)
      file.handle().fail(std::string("has several ") + axis + ": save one as a stack of its own");
}

/// For `pages` of `all`, all or some of which a viewer shows inverted.
std::string whiteIsZeroNote(const std::string& path, size_t pages, size_t all) {
  return path + ": 0 is white in " +
         (pages == all ? "it"
                       : std::to_string(pages) + " of its " + std::to_string(all) + " slices") +
         " by its TIFF tags; the values are taken as stored, so what is dark in a viewer is high "
         "here";
}

class TiffStack : public ImageReader {
 public:
  explicit TiffStack(std::unique_ptr<InputFile> file) : file_(std::move(file)) {
    path_ = file_.path();
    files_ = {path_};
    for (;; file_.next()) {
      if (file_.isSlice()) addPage();
      if (file_.isLast()) break;
    }
    if (pages_.empty()) throw IoError(path_ + ": has no page that is a slice");
    file_.select(pages_.front());
    const KeyValueHeader imageJ = imageJDescription(file_);
    rejectHyperstack(file_, imageJ);
    int64_t slices = int64_t(pages_.size());
    if (slices == 1)
      slices =
          slicesWithoutPages(numberIn(imageJ, "images").value_or(truncatedSlices(file_, page_)));
    info_.size = checkedSize(path_, {page_.width, page_.height, slices});
    info_.type = page_.type;
    const OmePixels ome(description(file_));
    checkOme(file_, ome, page_.channels, slices);
    if (ome.size("Z") > 1 && ome.size("Z") < slices)
      notes_.push_back(path_ + ": its header describes " + std::to_string(ome.size("Z")) +
                       " slices, and it has " + std::to_string(slices) + ": all are taken");
    setCalibration(info_, file_, imageJ, ome, info_.size.z);
    info_.format = "tiff";
    if (whiteIsZero_ > 0) notes_.push_back(whiteIsZeroNote(path_, whiteIsZero_, pages_.size()));
  }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    char* to = static_cast<char*>(samples);
    if (samplesOffset_) {
      const size_t bytes = size_t(page_.bytes()) * size_t(count);
      file_.data().read(*samplesOffset_ + page_.bytes() * uint64_t(first), to, bytes);
      if (page_.swapped) swapBytes(to, bytes / sampleSize(page_.type), sampleSize(page_.type));
      return;
    }
    for (int z = first; z < first + count; ++z, to += page_.bytes()) {
      file_.select(pages_[size_t(z)]);
      file_.decode(checkedPage(), to);
    }
  }

 private:
  void addPage() {
    if (pages_.empty()) page_ = file_.page();
    whiteIsZero_ += checkedPage().whiteIsZero;
    pages_.push_back(file_.directory());
  }

  /// The current page, which has to be like the first.
  TiffPage checkedPage() {
    const TiffPage page = file_.page();
    if (!page.sameAs(page_))
      throw IoError(path_ + ": its pages differ: " + std::to_string(page_.width) + " x " +
                    std::to_string(page_.height) + " " + sampleTypeName(page_.type) + " and " +
                    std::to_string(page.width) + " x " + std::to_string(page.height) + " " +
                    sampleTypeName(page.type));
    return page;
  }

  /// Of ImageJ's stacks of 4 GB and more and tifffile's truncated ones: one page, and the samples
  /// of so many images in one piece.
  int64_t slicesWithoutPages(double images) {
    if (!(images > 1) || images > kMaxImageSide || !page_.plain) return 1;
    const auto offset = file_.contiguousOffset(page_);
    if (!offset) return 1;
    const uint64_t held = (file_.data().size() - *offset) / page_.bytes();
    if (held < 2) return 1;  // a single slice that kept the description of its stack
    if (held < uint64_t(images))
      file_.handle().fail("is truncated: it says that it has " + shortestDecimal(images) +
                          " images, but holds " + std::to_string(held));
    samplesOffset_ = offset;
    return int64_t(images);
  }

  TiffFile file_;
  TiffPage page_;
  std::vector<uint64_t> pages_;
  size_t whiteIsZero_ = 0;
  std::optional<uint64_t> samplesOffset_;
};

class TiffFolder : public ImageReader {
 public:
  explicit TiffFolder(const std::string& path) {
    path_ = path;
    files_ = tiffFilesIn(path);
    if (files_.empty()) throw IoError(path + ": has no .tif or .tiff files");
    size_t whiteIsZero = 0;
    for (size_t z = 0; z < files_.size(); ++z) {
      const TiffFile file(files_[z]);
      const TiffPage page = file.page();
      if (!file.isLast())
        throw IoError(files_[z] + ": has several pages, but a slice of a folder has one");
      whiteIsZero += page.whiteIsZero;
      if (z == 0) {
        page_ = page;
        setCalibration(info_, file, imageJDescription(file), OmePixels(description(file)),
                       int(files_.size()));
      } else if (!page.sameAs(page_)) {
        throw IoError(files_[z] + ": is " + std::to_string(page.width) + " x " +
                      std::to_string(page.height) + " " + sampleTypeName(page.type) +
                      ", but the first slice of the folder is " + std::to_string(page_.width) +
                      " x " + std::to_string(page_.height) + " " + sampleTypeName(page_.type));
      }
    }
    if (!info_.voxelSize && !info_.proportions) info_.voxelSize = voxelSizeInLog(path);
    info_.size = checkedSize(path, {page_.width, page_.height, int64_t(files_.size())});
    info_.type = page_.type;
    info_.format = "tiff";
    notes_ = numberingNotes(path, files_);
    if (whiteIsZero > 0) notes_.push_back(whiteIsZeroNote(path, whiteIsZero, files_.size()));
  }

  void read(int first, int count, void* samples) override {
    checkSlices(path_, info_, first, count);
    char* to = static_cast<char*>(samples);
    for (int z = first; z < first + count; ++z, to += page_.bytes()) {
      const TiffFile file(files_[size_t(z)]);
      const TiffPage page = file.page();
      if (!page.sameAs(page_)) throw IoError(file.path() + ": changed while it was read");
      file.decode(page, to);
    }
  }

 private:
  TiffPage page_;
};

}  // namespace

std::vector<std::string> tiffFilesIn(const std::string& folder) {
  return slicesIn(folder, {".tif", ".tiff"});
}

std::unique_ptr<ImageReader> openTiff(std::unique_ptr<InputFile> file) {
  return std::make_unique<TiffStack>(std::move(file));
}

std::unique_ptr<ImageReader> openTiffFolder(const std::string& path) {
  return std::make_unique<TiffFolder>(path);
}

}  // namespace vdb_madf::detail
