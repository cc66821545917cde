# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The package is installed by CMake and by pip, offline."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import zipfile

import pytest

import vdb_madf as madf

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "lib/python"
TRY = ("import numpy as np, vdb_madf as madf; "
       "print(madf.__file__, madf.segment(np.ones((3, 4, 5), bool), "
       "boundary='closed').counts['grains'])")


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    prefix = tmp_path_factory.mktemp("prefix")
    subprocess.run(["cmake", "--install", os.environ["VDB_MADF_BINARY_DIR"], "--prefix", prefix],
                   check=True, stdout=subprocess.DEVNULL)
    return prefix


def tried(python, cwd, **environment):
    clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    run = subprocess.run([python, "-c", TRY], check=True, stdout=subprocess.PIPE, text=True,
                         cwd=cwd, env={**clean, **environment})
    file, grains = run.stdout.split()
    assert grains == "1"
    return pathlib.Path(file)


def test_an_installed_tree(prefix, tmp_path):
    packages = prefix / "lib/python3/dist-packages"
    assert tried(sys.executable, tmp_path, PYTHONPATH=str(packages)).parent == packages / "vdb_madf"
    names = {path.name for path in (packages / "vdb_madf").iterdir()}
    assert names >= {path.name for path in (SOURCE / "vdb_madf").glob("*.py*")} | {
        "py.typed", "napari.yaml"}


def test_pip(prefix, tmp_path):
    """With the core that is installed, in a virtual environment, without a network."""
    for module in ("pip", "setuptools", "wheel", "venv"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"pip install ./lib/python: {module} is not installed")
    for part in ("lib", "cmake"):  # pip builds in the sources
        shutil.copytree(SOURCE.parents[1] / part, tmp_path / part)
    subprocess.run([sys.executable, "-m", "pip", "wheel", "-q", "--no-build-isolation", "--no-deps",
                    "--no-index", "-w", tmp_path, tmp_path / "lib/python"], check=True,
                   env={**os.environ, "CMAKE_PREFIX_PATH": str(prefix),
                        "CMAKE_ARGS": "-DCMAKE_BUILD_TYPE=None"})  # soon compiled
    wheel, = tmp_path.glob("*.whl")
    assert wheel.name.startswith(f"vdb_madf-{madf.__version__}-cp3")
    names = zipfile.ZipFile(wheel).namelist()
    entries, = (name for name in names if name.endswith("/entry_points.txt"))
    assert b"[napari.manifest]\nvdb-madf = vdb_madf:napari.yaml\n" in zipfile.ZipFile(wheel).read(
        entries)
    assert {name.split("/")[1] for name in names if name.startswith("vdb_madf/")} == {
        path.name for path in (SOURCE / "vdb_madf").iterdir()
        if path.suffix in (".py", ".pyi", ".typed", ".yaml")
    } | {pathlib.Path(sys.modules["vdb_madf._core"].__file__).name}
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", tmp_path / "venv"],
                   check=True)
    python = tmp_path / "venv/bin/python"
    subprocess.run([python, "-m", "pip", "install", "-q", "--no-index", "--no-deps", wheel],
                   check=True)
    assert tmp_path / "venv" in tried(python, tmp_path).parents
