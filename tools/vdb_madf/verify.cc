// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/verify/verify.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "command.h"
#include "input_options.h"
#include "label_pair.h"
#include "parse.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/memory.h"

namespace vdb_madf::tools {

namespace {

struct VerifyArguments {
  InputOptions labels, object;
  std::string maxMemory;
};

void runVerify(const VerifyArguments& o, const Common& common) {
  common.progress->start("read");
  const LabelSlabs labels = loadSlabs(o.labels, "--labels-grid", common.progress);
  const MaskGrid::Ptr object = loadObject(o.object, common.progress);
  const int64_t memory =
      o.maxMemory.empty()
          ? availableMemory()
          : std::max<int64_t>(1, parseMemory(o.maxMemory) - int64_t(object->memUsage()));
  common.progress->start("verify");
  const Verification found =
      withFileName(o.labels.path, [&] { return verify(labels, *object, memory, common.progress); });
  common.progress->end();
  if (!found.fault.empty())
    throw InvalidInput(
        fmt::format("{}: are not the labels of {}: {}", o.labels.path, o.object.path, found.fault));
  if (!common.quiet)
    std::printf("%s: holds: each of %s is in the right one of %s (%s, %s)\n", o.labels.path.c_str(),
                counted(found.voxels, "voxel").c_str(), counted(found.grains, "grain").c_str(),
                counted(found.medialBalls, "medial ball").c_str(),
                counted(found.criticalPoints, "critical point").c_str());
}

}  // namespace

void addVerify(Verb command, Common& common, Action& action) {
  auto o = std::make_shared<VerifyArguments>();
  Verb verb = addVerb(command, common, "verify",
                      "prove voxel by voxel that labels are what the definition says",
                      "vdb_madf verify grains.vdb scan.tif --phase 1", MemoryLimit::planned);
  verb.option("LABELS", o->labels.path, "made by segment or remerge: .vdb or .slabs").required();
  verb.option("OBJECT", o->object.path, "what they were made of, read as segment reads it")
      .required();
  verb.option("--labels-grid", o->labels.gridName, "grid of LABELS").typeName("NAME");
  o->object.addSelection(verb);
  o->object.addRaw(verb);
  o->object.addDomain(verb);
  o->object.addRegion(verb);
  verb.option("--max-memory", o->maxMemory,
              "refuse what needs more, such as 12GiB; 32 bytes a voxel of the domain's box "
              "(default: what the machine has free)")
      .typeName("SIZE");
  verb.onParsed([o, &common, &action] {
    o->object.longestSide = kMaxImageSide;
    o->labels.parse();
    o->object.parse();
    if (!o->maxMemory.empty()) parseMemory(o->maxMemory);
    action = [o, &common] { runVerify(*o, common); };
  });
}

}  // namespace vdb_madf::tools
