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


@pytest.fixture(scope="module")
def wheel(prefix, tmp_path_factory):
    """With the core that is installed, without a network."""
    for module in ("pip", "setuptools", "wheel", "venv"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"pip install ./lib/python: {module} is not installed")
    work = tmp_path_factory.mktemp("wheel")
    for part in ("lib", "cmake"):  # pip builds in the sources
        shutil.copytree(SOURCE.parents[1] / part, work / part)
    subprocess.run([sys.executable, "-m", "pip", "wheel", "-q", "--no-build-isolation", "--no-deps",
                    "--no-index", "-w", work, work / "lib/python"], check=True,
                   env={**os.environ, "CMAKE_PREFIX_PATH": str(prefix),
                        "CMAKE_ARGS": "-DCMAKE_BUILD_TYPE=None"})  # soon compiled
    wheel, = work.glob("*.whl")
    return wheel


def environment(folder, wheel):
    """The Python of a virtual environment with the wheel."""
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True)
    python = folder / "bin/python"
    subprocess.run([python, "-m", "pip", "install", "-q", "--no-index", "--no-deps", wheel],
                   check=True)
    return python


def test_pip(wheel, tmp_path):
    assert wheel.name.startswith(f"vdb_madf-{madf.__version__}-cp3")
    names = zipfile.ZipFile(wheel).namelist()
    entries, = (name for name in names if name.endswith("/entry_points.txt"))
    assert b"[napari.manifest]\nvdb-madf = vdb_madf:napari.yaml\n" in zipfile.ZipFile(wheel).read(
        entries)
    assert {name.split("/")[1] for name in names if name.startswith("vdb_madf/")} == {
        path.name for path in (SOURCE / "vdb_madf").iterdir()
        if path.suffix in (".py", ".pyi", ".typed", ".yaml")
    } | {pathlib.Path(sys.modules["vdb_madf._core"].__file__).name}
    python = environment(tmp_path / "venv", wheel)
    assert tmp_path / "venv" in tried(python, tmp_path).parents


def test_a_wheel_with_its_libraries(wheel, prefix, tmp_path):
    """It is found to need no library of the system but those that are everywhere."""
    if not shutil.which("patchelf"):
        pytest.skip("tools/wheel: patchelf is not installed")
    script = SOURCE.parents[1] / "tools/wheel"
    subprocess.run([sys.executable, script, tmp_path / "dist", wheel], check=True,
                   env={**os.environ, "LD_LIBRARY_PATH": str(prefix / "lib")})
    whole, = (tmp_path / "dist").iterdir()
    assert "-manylinux_2_" in whole.name
    names = zipfile.ZipFile(whole).namelist()
    assert any(name.startswith("vdb_madf.libs/libopenvdb.so") for name in names)
    assert any(name.endswith(".dist-info/licenses/libtbb12.txt") for name in names)
    python = environment(tmp_path / "venv", whole)
    show = "import vdb_madf; print(open('/proc/self/maps').read())"
    clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    listed = subprocess.run([python, "-c", show], check=True, stdout=subprocess.PIPE, text=True,
                            cwd=tmp_path, env=clean).stdout
    for name in ("libopenvdb", "libtbb", "libtiff", "libblosc", "libX11"):
        line, = {line.split()[-1] for line in listed.splitlines() if f"/{name}.so" in line}
        assert f"{tmp_path}/venv/" in line and "/vdb_madf.libs/" in line
    assert tmp_path / "venv" in tried(python, tmp_path).parents

    refused = subprocess.run([sys.executable, script, tmp_path / "dist", tmp_path / "no.whl"],
                             stderr=subprocess.PIPE, text=True)
    assert refused.returncode == 1 and "no such file" in refused.stderr
