// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <vdb_madf/base/size_text.h>

int main() {
  return vdb_madf::voxelSizeFromText("8.5um").edge() == 8.5e-6 ? 0 : 1;
}
