# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The entries of same_bytes_runs.py as objects, what they need of each other, and their files."""
import fnmatch
import os
import re
import shlex

# What may differ between two runs of one program.
VARYING = [(re.compile(pattern, re.MULTILINE), rb"\1#\2") for pattern in (
    rb'("(?:seconds_\w+|page_faults_\w+|peak_memory_bytes\w*|memory_limit_bytes)": )[-+.\de]+()',
    rb"^(  time, memory +)[\d.]+( s with )",
    rb"^(  time, memory .* threads, )\d+( MiB)",
    rb"^(    \w+ +)\d+\.\d{3}( s)$",
    rb"^(  limit +)[\d.e+]+ \w+(: it )")]


class Run:
    """A line of the list."""

    def __init__(self, line):
        self.fails = {"!": True, "?": None}.get(line[:1], False)  # None: either way
        self.name = " ".join(line.lstrip("!? ").split())
        command, _, self.stdout = self.name.partition(" > ")
        self.arguments = shlex.split(command)

    def paths(self):
        return [word for word in self.arguments if is_path(word)]


class Preparation:
    """An edit of the list: both programs get the same file."""

    def __init__(self, edit):
        self.edit = edit
        self.fails = False

    def paths(self):
        return [self.edit.source, self.edit.target]


def is_path(word):
    return not word.startswith("-") and re.search(r"\.[A-Za-z]|_dir", word) is not None


def names_of(path):
    """What a run may call the file `path` of others: its folder, or the file that it belongs to."""
    yield path
    if "/" in path:
        yield path.split("/")[0]
    if ".truth." in path:
        yield path.replace(".truth.", ".")
    if path.endswith(".raw"):
        yield path[:-4] + ".mhd"


def entries_of(lines):
    return [Run(line) if isinstance(line, str) else Preparation(line) for line in lines]


def needed(entries, patterns):
    """The runs that match and, in order, all entries that make what they read; the former alone."""
    makers = {}  # of each path, the first entry that names it
    for i, entry in enumerate(entries):
        if entry.fails is not True:
            for path in entry.paths():
                makers.setdefault(path, i)
    chosen = {i for i, entry in enumerate(entries)
              if isinstance(entry, Run) and matches(entry.name, patterns)}
    wanted, left = set(), list(chosen)
    while left:
        i = left.pop()
        if i in wanted:
            continue
        wanted.add(i)
        left += [makers[name] for path in entries[i].paths() for name in names_of(path)
                 if makers.get(name, i) < i]
    return [entries[i] for i in sorted(wanted)], {entries[i] for i in chosen}


def matches(text, patterns):
    return any(fnmatch.fnmatchcase(text, pattern) for pattern in patterns)


def stamp(status):
    """What tells that a file changed."""
    return status.st_mtime_ns, status.st_size, status.st_ino


def contents(folder, below=""):
    """The path of each file in a folder, with its stamp."""
    found = {}
    with os.scandir(os.path.join(folder, below)) as entries:
        for entry in entries:
            if entry.is_dir():
                found.update(contents(folder, below + entry.name + "/"))
            else:
                found[below + entry.name] = stamp(entry.stat())
    return found


def masked(data):
    for pattern, replacement in VARYING:
        data = pattern.sub(replacement, data)
    return data
