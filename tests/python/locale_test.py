# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A host program with a decimal comma, as Qt's sets one, changes no number."""

import locale
import subprocess

import pytest

import vdb_madf as madf


@pytest.fixture
def comma(tmp_path, monkeypatch):
    """A locale that writes 8,5; made here if the system has its sources alone."""
    name = "de_DE.UTF-8"
    try:
        locale.setlocale(locale.LC_ALL, name)
    except locale.Error:
        made = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(tmp_path / name)]
        try:
            subprocess.run(made, check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            pytest.skip("SKIPPED: a locale with a comma: install locales")
        monkeypatch.setenv("LOCPATH", str(tmp_path))
        locale.setlocale(locale.LC_ALL, name)
    assert locale.format_string("%.1f", 8.5) == "8,5"
    yield
    locale.setlocale(locale.LC_ALL, "C")


def saved(array, path):
    madf.segment(array, voxel_size="8.5um").labels.save(path)
    return path.read_bytes()


def test_sizes_and_files(array, tmp_path, comma):
    here = saved(array, tmp_path / "comma.vdb")
    locale.setlocale(locale.LC_ALL, "C")
    assert here == saved(array, tmp_path / "point.vdb")
