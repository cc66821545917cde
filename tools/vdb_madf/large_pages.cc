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
#if MI_MALLOC_VERSION < 310  // Later ones do not keep the first memory of a thread in small pages.
  mi_option_set(mi_option_eager_commit_delay, 0);
#endif
#endif
}

}  // namespace vdb_madf::tools
