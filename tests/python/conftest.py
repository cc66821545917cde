# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python package share."""

import os
import subprocess

import numpy as np
import pytest

import vdb_madf as madf


@pytest.fixture(scope="session")
def sample():
    """A mask and its true grains: 64 x 72 x 80 voxels (z, y, x)."""
    return madf.generate("sintered", size=(64, 72, 80), count=9, radius=(8, 13), neck=0.75,
                         voxel_size="10um")


@pytest.fixture(scope="session")
def array(sample):
    """The mask as uint8, 0 and 1."""
    array = np.asarray(sample[0]).astype(np.uint8)
    array.flags.writeable = False
    return array


@pytest.fixture(scope="session")
def command():
    """Runs the command vdb_madf."""
    def run(*arguments):
        subprocess.run([os.environ["VDB_MADF_TOOL"], *map(str, arguments), "-q"], check=True)
    return run


@pytest.fixture(scope="session")
def expected(array, command, tmp_path_factory):
    """The labels that the command makes of the array, as an array."""
    folder = tmp_path_factory.mktemp("expected")
    np.save(folder / "scan.npy", array)
    command("segment", folder / "scan.npy", folder / "labels.npy", "--phase", "1")
    return np.load(folder / "labels.npy")


@pytest.fixture(scope="session")
def labels(sample):
    """Those of the mask."""
    return madf.segment(sample[0], keep=()).labels


@pytest.fixture(scope="session")
def measured(labels):
    return madf.measure(labels)


@pytest.fixture(scope="session")
def tables(labels, command, tmp_path_factory):
    """The folder of the labels and of what the command measures of them."""
    folder = tmp_path_factory.mktemp("tables")
    labels.save(folder / "labels.vdb")
    command("measure", folder / "labels.vdb", folder)
    return folder


def pytest_terminal_summary(terminalreporter):
    """Skipped tests are said as those of the other tests are."""
    for report in terminalreporter.stats.get("skipped", []):
        terminalreporter.write_line(f"SKIPPED: {report.longrepr[2].removeprefix('Skipped: ')}")
