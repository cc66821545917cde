// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "run_command.h"

int main(int argc, char** argv) {
  return vdb_madf::tools::runCommand("vdb_madf", argc, argv);
}
