// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "message.h"

#include <iostream>

namespace vdb_madf::tools {

void printMessage(const std::string& kind, std::string what) {
  for (char& c : what)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  // In one piece: mpiexec joins what several processes write as it comes.
  std::cerr << "vdb_madf: " + kind + ": " + what + "\n" << std::flush;
}

}  // namespace vdb_madf::tools
