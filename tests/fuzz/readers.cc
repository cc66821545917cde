// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// libFuzzer's targets: what reads a file or a text of somebody else. tests/fuzz/run builds and runs
// them. By hand, VDB_MADF_FUZZ_READER names one: `... build_fuzz/tests/vdb_madf_fuzz FILE` reads an
// input again. With VDB_MADF_FUZZ_SEEDS=FOLDER nothing is done but to write what they begin with.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "support/files.h"
#include "support/image_corpus.h"
#include "support/image_damage.h"
#include "support/vdb_samples.h"
#include "tools/vdb_madf/parse.h"
#include "tools/vdb_madf/wrong_usage.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/size_text.h"
#include "vdb_madf/edits/edits.h"
#include "vdb_madf/files/verified_files.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/measure/size_curve.h"
#include "vdb_madf/samples/balls.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder_writer.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

// OpenVDB's library does not have all of it (support/other_grids.h).
template class openvdb::Grid<StandardTree<openvdb::Vec3s>>;
template class openvdb::tree::Tree<StandardTree<openvdb::Vec3s>::RootNodeType>;

namespace {

using Complain = std::function<std::string(const CorpusSample&, const std::string& path)>;

/// What is read: files of which one is changed, or texts. An input's first byte says which sample
/// it is a change of, the others are the file or the text.
struct FuzzedReader {
  std::vector<CorpusSample> samples;
  Complain complain;                                 ///< of files: what is wrong, or nothing
  std::function<void(const std::string&)> readText;  ///< of texts: throws nothing but InvalidInput
  uint64_t expansion = 1;  ///< of any sample: a change may make it compressed
};

std::string complaintOfImage(const CorpusSample& sample, const std::string& path) {
  const std::string wrong = complaint(path, sample.bytes(), sample.expansion);
  // A wide row of a fax takes a bit.
  const bool mayClaim = sample.format == "tif" || sample.format == "hdf5";
  return mayClaim && wrong.find("claims") == 0 ? "" : wrong;
}

std::string complaintOfVdb(const CorpusSample&, const std::string& path) {
  try {
    const auto grids = readVdb(path);
    return {};
  } catch (const IoError& error) {
    const std::string message = error.what();
    if (message.find(path) == std::string::npos) return "does not name the file: " + message;
    if (message.find('\n') != std::string::npos) return "more than one line: " + message;
    return {};
  }
}

CorpusSample corpusSample(const SampleFile& file) {
  CorpusSample sample = oneFile(file.name.substr(2), file.name, file.bytes, 0, kMaxExpansion);
  if (!file.dataName.empty()) sample.files[file.dataName] = file.data;
  return sample;
}

std::vector<CorpusSample> vdbSamples() {
  std::vector<CorpusSample> all;
  for (const NamedBytes& file : smallFiles())
    all.push_back(oneFile("openvdb", "a.vdb", file.bytes, 0));
  const TemporaryFolder folder;
  const SlabFolderWriter writer(folder.file("s.slabs"), {-16, 0, 16});
  const auto labels = Int32Grid::create(), above = Int32Grid::create();
  for (int z = -9; z < 9; ++z) (z < 0 ? labels : above)->tree().setValue(Coord(z, 2, z), 7 + z % 3);
  for (const auto& grid : {labels, above}) grid->setName("grain");
  writer.write(0, {labels});
  writer.write(1, {above});
  writer.commit();
  CorpusSample slabs{"slabs", "s.slabs", {}, "", 0};
  for (const char* name : {"index.json", "slab-0000.vdb", "slab-0001.vdb"})
    slabs.files[std::string("s.slabs/") + name] = bytesOf(folder.file("s.slabs/") + name);
  for (const char* name : {"index.json", "slab-0001.vdb"}) {
    slabs.changed = std::string("s.slabs/") + name;
    all.push_back(slabs);
  }
  return all;
}

/// Read in a process of its own, which may crash: that has to be an error like any other.
std::vector<CorpusSample> hdf5Samples() {
  std::vector<CorpusSample> all;
  const ScratchFolder folder;
  for (const SampleType type : {SampleType::uint8, SampleType::int32}) {
    if (!readsHdf5()) break;
    ImageInfo info;
    info.size = {9, 8, 7};
    info.type = type;
    info.voxelSize = VoxelSize({1, 1, 2});
    const std::string path = folder / "a.h5";
    const auto writer = createImage(path, info);
    writer->write(7, randomSamples(type, 9 * 8 * 7, 3).data());
    writer->finish();
    const std::string bytes = readFile(path);
    all.push_back(oneFile("hdf5", "a.h5", bytes, bytes.size(), kMaxExpansion));
  }
  return all;
}

CorpusSample textSample(const std::string& text) {
  return {"", "", {{"", text}}, "", 0};
}

void readEdits(const std::string& text) {
  for (const Edit& edit : parseEdits(text))
    if (toString(parseEdit(toString(edit))) != toString(edit)) std::abort();
}

/// Reads a text as one thing after the other, as each may refuse it.
void readAs(const std::string& text,
            const std::vector<std::function<void(const std::string&)>>& readers) {
  for (const auto& read : readers) {
    try {
      read(text);
    } catch (const InvalidInput&) {
    } catch (const tools::WrongUsage&) {
    }
  }
}

void readOptions(const std::string& text) {
  using namespace tools;
  readAs(text, {[](auto& t) { voxelSizeFromText(t); }, [](auto& t) { bytesFromText(t); },
                [](auto& t) { numberFromText(t); }, [](auto& t) { parseNumber(t, "--a"); },
                [](auto& t) { parseDims(t, "--a"); }, [](auto& t) { parseBox(t, "--a"); },
                [](auto& t) { parseShift(t, "--a"); }, [](auto& t) { parseRoi(t); },
                [](auto& t) { parseVoxelSize(t); }, [](auto& t) { parseCount(t, "--a"); },
                [](auto& t) { parseGrains(t, "--a"); }, [](auto& t) { parseMemory(t); }});
}

std::map<std::string, FuzzedReader> allReaders() {
  std::map<std::string, FuzzedReader> readers;
  // A reader for each file of a format.
  const auto add = [&](const CorpusSample& sample, const Complain& complain) {
    const std::string name = std::filesystem::path(sample.changed).filename().string();
    const bool inFolder = sample.files.size() > 1;
    FuzzedReader& reader = readers[sample.format + (inFolder ? "_" + name : "")];
    reader.samples.push_back(sample);
    reader.complain = complain;
    reader.expansion = std::max(reader.expansion, sample.expansion);
  };
  const ScratchFolder folder;
  for (const SampleFile& file : sampleFiles(folder)) add(corpusSample(file), complaintOfImage);
  for (const CorpusSample& sample : corpusSamples()) add(sample, complaintOfImage);
  for (const CorpusSample& sample : hdf5Samples()) add(sample, complaintOfImage);
  for (const CorpusSample& sample : vdbSamples()) add(sample, complaintOfVdb);
  readers["edits"] = {
      {textSample("split 9\nmerge 12 17 # why\ndrop 5,6\nkeep 1 2\nmin-voxels 100\nmax-voxels 9\n"
                  "min-diameter 100um\nmax-diameter 1 mm\njoin-below 27\ndrop-at-faces\nrenumber")},
      {},
      [](const std::string& text) { readAs(text, {readEdits}); }};
  FuzzedReader options{{}, {}, readOptions};
  for (const char* text : {"0.5x0.5x1.2um", "12 GiB", "1e6B", "301x301x251", "-1,2,3:4,5,6",
                           "cylinder:z:20,16:14", "3,17,25", "1,-2,3", "8.5um", "2.5e-3"})
    options.samples.push_back(textSample(text));
  readers["options"] = options;
  readers["balls"] = {
      {textSample("# x y z r\n1 2 3 0.5\n-4e1,5,6,1\n\n7\t8 9 2\n"),
       textSample("1 0 0 0 4\n2 9 0 0 4.5\n")},
      {},
      [](const std::string& text) {
        readAs(text, {[](auto& t) { parseBalls(t); }, [](auto& t) { parseBalls(t, true); }});
      }};
  readers["size_curve"] = {
      {textSample("size_um,percent_passing\n100,5\n250.5,50\n400,95\n"),
       textSample("size_voxel,percent_passing\n3,0\n9,100\n")},
      {},
      [](const std::string& text) { readAs(text, {[](auto& t) { parseSizeReference(t); }}); }};
  return readers;
}

/// The reader that was asked for, and a folder for each of its samples.
class Fuzzed {
 public:
  explicit Fuzzed(const std::string& name) : reader_(allReaders().at(name)) {
    setFilesAreVerified(false);
    for (CorpusSample& sample : reader_.samples) {
      sample.expansion = reader_.expansion;
      folders_.push_back(std::make_unique<ScratchFolder>());
      if (reader_.complain) sample.write(*folders_.back());
    }
  }

  void run(std::string_view input) {
    if (input.empty()) return;
    const size_t index = uint8_t(input[0]) % reader_.samples.size();
    const std::string bytes(input.substr(1));
    if (reader_.readText) return reader_.readText(bytes);
    CorpusSample& sample = reader_.samples[index];
    const ScratchFolder& folder = *folders_[index];
    writeFile(folder / sample.changed, bytes);
    sample.files[sample.changed] = bytes;
    const std::string wrong = reader_.complain(sample, folder / sample.path);
    if (wrong.empty()) return;
    std::fprintf(stderr, "wrong: %s\n", wrong.c_str());
    std::abort();
  }

 private:
  FuzzedReader reader_;
  std::vector<std::unique_ptr<ScratchFolder>> folders_;
};

std::unique_ptr<Fuzzed> fuzzed;

void writeSeeds(const std::string& place) {
  for (const auto& [name, reader] : allReaders()) {
    std::filesystem::create_directories(place + "/" + name);
    for (size_t i = 0; i < reader.samples.size(); ++i)
      writeFile(place + "/" + name + "/" + std::to_string(i),
                char(i) + reader.samples[i].files.at(reader.samples[i].changed));
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***);
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (const char* place = std::getenv("VDB_MADF_FUZZ_SEEDS")) {
    writeSeeds(place);
    std::exit(0);
  }
  const char* name = std::getenv("VDB_MADF_FUZZ_READER");
  fuzzed = std::make_unique<Fuzzed>(name ? name : "");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  fuzzed->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
