// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "large_pages.h"

#ifdef VDB_MADF_MIMALLOC
#include <mimalloc.h>
#endif

namespace vdb_madf::tools {

void askForLargePages() {
#ifdef VDB_MADF_MIMALLOC
  mi_option_enable(mi_option_large_os_pages);
  // Otherwise a thread's first memory comes in small pages.
  mi_option_set(mi_option_eager_commit_delay, 0);
#endif
}

}  // namespace vdb_madf::tools
