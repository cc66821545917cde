// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf segment and convert by the processes of an MPI job.

#include <cstdio>
#include <exception>

#include "../vdb_madf/run_command.h"
#include "vdb_madf/mpi/mpi_team.h"

int main(int argc, char** argv) try {
  vdb_madf::MpiTeam team(&argc, &argv);
  const int code = vdb_madf::tools::runCommand("vdb_madf_mpi", argc, argv, &team);
  if (code != 0) vdb_madf::MpiTeam::abort(code);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "vdb_madf_mpi: error: %s\n", error.what());
  return 1;
}
