// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "scan_option.h"

#include "outputs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/standard_streams.h"

namespace vdb_madf::tools {

void ScanOption::add(Verb verb, const std::string& help, const std::string& ofWhat) {
  verb.option(option, path, help).typeName("FILE");
  verb.option(option + "-grid", grid,
              ofWhat + ": the grid of a VDB, the array of a Zarr or HDF5 file")
      .typeName("NAME");
}

namespace {

/// What to do about a scan; the options that other hints name describe the labels.
std::string hintForScan(Hint hint, const ScanOption& scan) {
  if (hint == Hint::dataset) return " (" + scan.option + "-grid" + ")";
  return hint == Hint::rawLayout ? " by converting it to .tif or .npy first" : "";
}

}  // namespace

void checkScan(const ScanOption& scan, const InputOptions& labels) {
  if (scan.path.empty()) {
    if (!scan.grid.empty())
      throw WrongUsage(scan.option + "-grid names a part of the scan: give " + scan.option +
                       ", too");
    return;
  }
  const std::string given = scan.option + " " + scan.path;
  if (isStandardInput(scan.path)) throw WrongUsage(given + ": the scan is read from a file");
  if (hasRawEnding(scan.path))
    throw WrongUsage(given +
                     ": a RAW file does not say how large it is: convert it to .tif or .npy first");
  checkOutputs(labels.outputs, scan.path);
}

namespace {

/// What open(input) makes of the scan; what goes wrong names the scan's options.
template <typename Open>
auto openedWith(const ScanOption& scan, const InputOptions& labels, const Open& open) {
  InputOptions input;
  input.path = scan.path;
  (isVdb(input) ? input.gridName : input.dataset) = scan.grid;
  input.outputs = labels.outputs;
  try {
    return open(input);
  } catch (const AmbiguousGrid& error) {
    throw InvalidInput(std::string(error.what()) + " (" + scan.option + "-grid" + ")");
  } catch (const InvalidInput& error) {
    throw InvalidInput(error.what() + hintForScan(error.hint(), scan));
  } catch (const IoError& error) {
    throw IoError(error.what() + hintForScan(error.hint(), scan));
  }
}

}  // namespace

MaskGrid::Ptr loadPhase(const ScanOption& map, int64_t value, const InputOptions& labels,
                        Progress* progress) {
  return openedWith(map, labels, [&](InputOptions& input) {
    input.selection = Selection::phase(double(value));
    return vdb_madf::loadObject(map.path, input.volume(progress), progress);
  });
}

GrayScan openScan(const ScanOption& scan, const InputOptions& labels, Progress* progress) {
  return openedWith(scan, labels, [&](const InputOptions& input) {
    return openGrayScan(scan.path, input.volume(progress), progress);
  });
}

void noteOfScan(const std::string& path, const std::string& note, Progress* progress) {
  if (!note.empty()) progress->note(path + ": " + note);
}

}  // namespace vdb_madf::tools
