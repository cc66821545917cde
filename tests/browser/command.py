# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The command that is tested, and the tables that it writes."""

import csv
import os
import subprocess
import sys

TOOL = os.path.abspath(sys.argv[1])


def command(*words, refused=False):
    result = subprocess.run([TOOL, *words], capture_output=True, text=True)
    if refused:
        return result.stderr
    assert result.returncode == 0, result.stderr
    return result.stdout


def demand(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def table(name):
    with open(name, newline="") as file:
        return list(csv.DictReader(file))
