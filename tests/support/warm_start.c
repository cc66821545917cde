// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Loaded into the command (LD_PRELOAD) by program.cc: stops it before main(), and runs main() in a
// copy of the process for each run that is asked for. A run is the same as by itself, but the
// command is linked with its libraries once, which takes some 15 times as long as a copy.
//
// A request comes by the socket that VDB_MADF_WARM_START names: a WarmRequest, strings with their
// zeros, and four descriptors. Its answer is the run's process and, once it has ended, its status.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/warm_start.h"

static char request[WARM_REQUEST_BYTES];
static char* words[WARM_REQUEST_BYTES / 2 + 2];

/// Those that watch are waited for, as what a child took counts as its parent's then.
static void forgetEnded(int how) {
  while (waitpid(-1, NULL, how) > 0) {
  }
}

/// Waits for the next request. There are no more once the test has ended.
static void receive(int server, int* descriptors) {
  char control[CMSG_SPACE(4 * sizeof(int))];
  struct iovec data = {request, sizeof request};
  struct msghdr message = {0};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  if (recvmsg(server, &message, 0) <= 0) {
    forgetEnded(0);
    _exit(0);
  }
  forgetEnded(WNOHANG);
  memcpy(descriptors, CMSG_DATA(CMSG_FIRSTHDR(&message)), 4 * sizeof(int));
}

static void limit(int resource, int64_t most) {
  const struct rlimit both = {(rlim_t)most, (rlim_t)most};
  if (most > 0) setrlimit(resource, &both);
}

/// A run that hangs, or that outlives an aborted test, must not stay.
static void prepare(const int* descriptors, int* argc, char*** argv) {
  const struct WarmRequest* head = (const struct WarmRequest*)request;
  for (int i = 0; i < 3; ++i) dup2(descriptors[i], i);
  for (int i = 0; i < 4; ++i) close(descriptors[i]);
  limit(RLIMIT_FSIZE, head->largestFile);
  limit(RLIMIT_AS, head->memory);
  limit(RLIMIT_CPU, head->seconds);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  static const int asUsual[] = {SIGINT, SIGTERM, SIGHUP, SIGXFSZ};
  for (int i = 0; i < 4; ++i) signal(asUsual[i], SIG_DFL);
  char* text = request + sizeof *head;
  const char* folder = text;
  char** word = words;
  *argc = head->arguments;
  *argv = word;
  for (int i = 0; i < head->arguments + head->variables; ++i) {
    if (i == head->arguments) *word++ = NULL, environ = word;
    text += strlen(text) + 1;
    *word++ = text;
  }
  if (chdir(folder) != 0) _exit(127);
}

/// @return in a copy of this process alone, which is to run
static void serve(int server, int* argc, char*** argv) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (;;) {
    int descriptors[4], status = 0;
    receive(server, descriptors);
    const pid_t watching = fork();
    if (watching == 0) {
      close(server);
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      const pid_t run = fork();
      if (run == 0) {
        prepare(descriptors, argc, argv);
        return;
      }
      for (int i = 0; i < 3; ++i) close(descriptors[i]);
      if (write(descriptors[3], &run, sizeof run) < 0) _exit(1);
      waitpid(run, &status, 0);
      _exit(write(descriptors[3], &status, sizeof status) < 0);
    }
    for (int i = 0; i < 4; ++i) close(descriptors[i]);
  }
}

typedef int Main(int, char**, char**);
typedef void Hook(void);

static Main* command;

/// Libraries are not unloaded: one of them (log4cplus, of OpenVDB) would wait for its threads,
/// which a copy of the process has not.
static int run(int argc, char** argv, char** variables) {
  const int status = command(argc, argv, variables);
  fflush(NULL);
  _exit(status);
}

/// What the C library begins a program by.
int __libc_start_main(Main* main, int argc, char** argv, Hook* init, Hook* fini, Hook* unload,
                      void* stack) {
  int (*const start)(Main*, int, char**, Hook*, Hook*, Hook*, void*) = (int (*)(
      Main*, int, char**, Hook*, Hook*, Hook*, void*))dlsym(RTLD_NEXT, "__libc_start_main");
  const char* server = getenv("VDB_MADF_WARM_START");
  command = main;
  if (server) serve(atoi(server), &argc, &argv);
  return start(server ? run : main, argc, argv, init, fini, unload, stack);
}
