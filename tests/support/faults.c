// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// A library to preload (LD_PRELOAD) that makes one system call fail, or one allocation; tests/faults
// runs the command with it. From the environment:
//   FAULT_CALL   open, read, write, sync, rename, close, map, resize, mkdir, link, unlink, allocate
//   FAULT_NUMBER which of these calls, from 1 on, of all threads
//   FAULT_ERROR  the errno that it fails with; 0: only half the bytes are moved; -1: SIGKILL
//   FAULT_ALWAYS set: the calls after it fail, too
//   FAULT_FOLDER only calls that have to do with files below this folder count
//   FAULT_BYTES  only allocations of at least so many bytes count
//   FAULT_NOTE   this file is made when the call fails; if FAULT_NUMBER is 0, at the end, and says
//                how many calls there were of each kind

#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static const char* const kinds[] = {"open",   "read",  "write", "sync", "rename", "close",
                                    "map",    "resize", "mkdir", "link", "unlink", "allocate"};
enum { kKinds = sizeof kinds / sizeof *kinds };
static atomic_long calls[kKinds];

static long numberOf(const char* name, long otherwise) {
  const char* text = getenv(name);
  return text ? atol(text) : otherwise;
}

/// True if this call is one that fails; not if only half of its bytes are moved.
static int isHit(const char* call) {
  const char* wanted = getenv("FAULT_CALL");
  int kind = 0;
  while (strcmp(kinds[kind], call) != 0) ++kind;
  const long number = atomic_fetch_add(&calls[kind], 1) + 1;
  if (!wanted || strcmp(wanted, call) != 0) return 0;
  const long fatal = numberOf("FAULT_NUMBER", 1);
  if (number < fatal || (number > fatal && !getenv("FAULT_ALWAYS"))) return 0;
  const char* note = getenv("FAULT_NOTE");
  if (note) syscall(SYS_close, syscall(SYS_openat, AT_FDCWD, note, O_CREAT | O_WRONLY, 0600));
  const long error = numberOf("FAULT_ERROR", EIO);
  if (error < 0) syscall(SYS_kill, getpid(), SIGKILL);
  errno = (int)error;
  return 1;
}

static __attribute__((destructor)) void sayCounts(void) {
  const char* note = getenv("FAULT_NOTE");
  if (!note || numberOf("FAULT_NUMBER", 0) > 0) return;
  FILE* file = fopen(note, "w");
  for (int kind = 0; file && kind < kKinds; ++kind)
    fprintf(file, "%s %ld\n", kinds[kind], atomic_load(&calls[kind]));
  if (file) fclose(file);
}

static int isBelow(const char* path) {
  const char* folder = getenv("FAULT_FOLDER");
  return folder && path && strncmp(path, folder, strlen(folder)) == 0;
}

static int hitsPath(const char* call, const char* path) {
  char here[4096];
  const int below = path && path[0] != '/' ? isBelow(getcwd(here, sizeof here)) : isBelow(path);
  return below && isHit(call);
}

static int hitsFile(const char* call, int file) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = syscall(SYS_readlinkat, AT_FDCWD, link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = 0;
  return isBelow(path) && isHit(call);
}

// The next definition of a function behind this one.
#define NEXT(result, name, ...) \
  static result (*next)(__VA_ARGS__); \
  if (!next) next = (result(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

#define OPEN(name) \
  int name(const char* path, int flags, ...) { \
    va_list more; \
    va_start(more, flags); \
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0; \
    va_end(more); \
    NEXT(int, #name, const char*, int, ...); \
    return hitsPath("open", path) ? -1 : next(path, flags, mode); \
  }
OPEN(open)
OPEN(open64)
#define OPENAT(name) \
  int name(int folder, const char* path, int flags, ...) { \
    va_list more; \
    va_start(more, flags); \
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0; \
    va_end(more); \
    NEXT(int, #name, int, const char*, int, ...); \
    return hitsPath("open", path) ? -1 : next(folder, path, flags, mode); \
  }
OPENAT(openat)
OPENAT(openat64)
#define FOPEN(name) \
  FILE* name(const char* path, const char* mode) { \
    NEXT(FILE*, #name, const char*, const char*); \
    return hitsPath("open", path) ? NULL : next(path, mode); \
  }
FOPEN(fopen)
FOPEN(fopen64)

// What moves bytes fails, or moves half of them.
#define HALF_OR_FAIL(call) \
  if (hitsFile(call, file)) { \
    if (errno != 0) return -1; \
    count = (count + 1) / 2; \
  }
ssize_t read(int file, void* bytes, size_t count) {
  NEXT(ssize_t, "read", int, void*, size_t);
  HALF_OR_FAIL("read")
  return next(file, bytes, count);
}
ssize_t write(int file, const void* bytes, size_t count) {
  NEXT(ssize_t, "write", int, const void*, size_t);
  HALF_OR_FAIL("write")
  return next(file, bytes, count);
}
#define PREAD(name) \
  ssize_t name(int file, void* bytes, size_t count, off_t place) { \
    NEXT(ssize_t, #name, int, void*, size_t, off_t); \
    HALF_OR_FAIL("read") \
    return next(file, bytes, count, place); \
  }
PREAD(pread)
PREAD(pread64)
#define PWRITE(name) \
  ssize_t name(int file, const void* bytes, size_t count, off_t place) { \
    NEXT(ssize_t, #name, int, const void*, size_t, off_t); \
    HALF_OR_FAIL("write") \
    return next(file, bytes, count, place); \
  }
PWRITE(pwrite)
PWRITE(pwrite64)

int fsync(int file) {
  NEXT(int, "fsync", int);
  return hitsFile("sync", file) ? -1 : next(file);
}
int syncfs(int file) {
  NEXT(int, "syncfs", int);
  return hitsFile("sync", file) ? -1 : next(file);
}
int close(int file) {
  NEXT(int, "close", int);
  const int hit = hitsFile("close", file), error = errno;  // it is closed all the same
  const int result = next(file);
  if (!hit) return result;
  errno = error;
  return -1;
}
#define RESIZE(name) \
  int name(int file, off_t size) { \
    NEXT(int, #name, int, off_t); \
    return hitsFile("resize", file) ? -1 : next(file, size); \
  }
RESIZE(ftruncate)
RESIZE(ftruncate64)
#define MAP(name) \
  void* name(void* address, size_t size, int access, int flags, int file, off_t place) { \
    NEXT(void*, #name, void*, size_t, int, int, int, off_t); \
    if (file >= 0 && hitsFile("map", file)) return MAP_FAILED; \
    return next(address, size, access, flags, file, place); \
  }
MAP(mmap)
MAP(mmap64)

int rename(const char* from, const char* to) {
  NEXT(int, "rename", const char*, const char*);
  return hitsPath("rename", to) ? -1 : next(from, to);
}
int link(const char* from, const char* to) {
  NEXT(int, "link", const char*, const char*);
  return hitsPath("link", to) ? -1 : next(from, to);
}
int unlink(const char* path) {
  NEXT(int, "unlink", const char*);
  return hitsPath("unlink", path) ? -1 : next(path);
}
int mkdir(const char* path, mode_t mode) {
  NEXT(int, "mkdir", const char*, mode_t);
  return hitsPath("mkdir", path) ? -1 : next(path, mode);
}

// Allocations go to the functions that the program has without this library, mimalloc's or glibc's;
// before main(), when these are not known yet, to glibc's.
extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);
static void* (*nextMalloc)(size_t) = __libc_malloc;
static void* (*nextCalloc)(size_t, size_t) = __libc_calloc;
static void* (*nextRealloc)(void*, size_t) = __libc_realloc;
static void* (*nextMemalign)(size_t, size_t) = __libc_memalign;

static int (*realMain)(int, char**, char**);
static atomic_bool isInMain;

static int mainOfProgram(int count, char** words, char** environment) {
  nextMalloc = (void* (*)(size_t))dlsym(RTLD_NEXT, "malloc");
  nextCalloc = (void* (*)(size_t, size_t))dlsym(RTLD_NEXT, "calloc");
  nextRealloc = (void* (*)(void*, size_t))dlsym(RTLD_NEXT, "realloc");
  nextMemalign = (void* (*)(size_t, size_t))dlsym(RTLD_NEXT, "memalign");
  atomic_store(&isInMain, 1);
  return realMain(count, words, environment);
}
// What libraries allocate before main() is no affair of the program.
int __libc_start_main(int (*run)(int, char**, char**), int count, char** words, void (*first)(void),
                      void (*last)(void), void (*ofLoader)(void), void* end) {
  NEXT(int, "__libc_start_main", int (*)(int, char**, char**), int, char**, void (*)(void),
       void (*)(void), void (*)(void), void*);
  realMain = run;
  return next(mainOfProgram, count, words, first, last, ofLoader, end);
}

// Those of Blosc do not fail: it does not look whether they did.
static int isBlosc(const void* caller) {
  Dl_info info;
  return dladdr(caller, &info) && info.dli_fname && strstr(info.dli_fname, "libblosc");
}

static int hitsAllocation(size_t bytes, const void* caller) {
  static long least = -1;
  if (!atomic_load(&isInMain)) return 0;
  if (least < 0) least = numberOf("FAULT_BYTES", 0);
  return least > 0 && bytes >= (size_t)least && !isBlosc(caller) && isHit("allocate");
}
#define CALLER __builtin_return_address(0)
void* malloc(size_t bytes) {
  return hitsAllocation(bytes, CALLER) ? NULL : nextMalloc(bytes);
}
void* calloc(size_t count, size_t bytes) {
  return hitsAllocation(count * bytes, CALLER) ? NULL : nextCalloc(count, bytes);
}
void* realloc(void* old, size_t bytes) {
  return hitsAllocation(bytes, CALLER) ? NULL : nextRealloc(old, bytes);
}
void* aligned_alloc(size_t alignment, size_t bytes) {
  return hitsAllocation(bytes, CALLER) ? NULL : nextMemalign(alignment, bytes);
}
int posix_memalign(void** to, size_t alignment, size_t bytes) {
  if (hitsAllocation(bytes, CALLER)) return ENOMEM;
  *to = nextMemalign(alignment, bytes);
  return *to ? 0 : ENOMEM;
}
