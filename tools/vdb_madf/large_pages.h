// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf::tools {

/// Lets this process's memory come in large pages (2 MiB), where the system gives them to those who
/// ask. A large sample has a million blocks of 2 KiB, the values of leaf nodes: a half of a small
/// page each. Where a page's first touch is slow, as in virtual machines that are given memory on
/// demand, these touches would take as long as the method. Nothing where the program was built
/// without mimalloc 2, whose allocator it is then.
void askForLargePages();

}  // namespace vdb_madf::tools
