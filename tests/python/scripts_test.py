# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The scripts of lib/python/README.md and the tutorial run as they stand."""

import importlib.util
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

import vdb_madf as madf

PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "lib/python"
SCRIPTS = re.findall(r"^```python\n(.*?)^```", (PACKAGE / "README.md").read_text(), re.M | re.S)


# Takes every call, where matplotlib is not installed: it is large.
STAND_IN = """
class Anything:
    def __getattr__(self, name): return self
    def __call__(self, *arguments, **named): return self
    def __getitem__(self, key): return self
    def __setitem__(self, key, value): pass
    def __iter__(self): return iter([self] * 3)
def subplots(rows, columns, **named): return Anything(), [Anything() for _ in range(columns)]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With the files that the scripts read."""
    folder = tmp_path_factory.mktemp("scripts")
    if not importlib.util.find_spec("matplotlib"):
        (folder / "matplotlib").mkdir()
        (folder / "matplotlib/pyplot.py").write_text(STAND_IN)
    mask, truth = madf.generate("sintered", size=80, count=14, radius=(9, 14), neck=0.75)
    mask.save(folder / "scan.tif")
    np.save(folder / "watershed.npy", truth)
    if importlib.util.find_spec("h5py"):
        import h5py
        with h5py.File(folder / "series.h5", "w") as file:
            for time in ("a", "b"):
                gray = 60 + 120 * np.asarray(mask).astype(np.uint8)
                file.create_dataset(f"{time}/scan", data=gray, chunks=(16, 32, 32))
    return folder


def needs(script):
    """Skips what needs a module that is not there."""
    for module in re.findall(r"^(?:import|from) (\w+)", script, re.M):
        if importlib.util.find_spec(module) is None and module != "matplotlib":
            pytest.skip(f"a script of lib/python: {module} is not installed")


def run(script, folder, name):
    needs(script)
    (folder / name).write_text(script)
    done = subprocess.run([sys.executable, "-W", "error::DeprecationWarning:__main__", name],
                          cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout
    return done.stdout


@pytest.mark.parametrize("number", range(len(SCRIPTS)))
def test_scripts_of_the_readme(number, folder):
    script = SCRIPTS[number].replace("progress=True", "progress=None")
    if number == 0:
        script = script.replace('threshold="otsu", ', "")  # the scan here is a mask
    if "grains.vdb" in script and not (folder / "grains.vdb").exists():
        madf.segment(folder / "scan.tif", voxel_size="10um").labels.save(folder / "grains.vdb")
    printed = run(script, folder, f"script_{number}.py")
    assert printed or number == 0


def test_there_are_six_and_a_first():
    assert len(SCRIPTS) == 7


def test_the_tutorial(folder):
    printed = run((PACKAGE / "tutorial.py").read_text(), folder, "tutorial.py")
    assert "otsu" in printed and "are whole" in printed
    wrong = float(re.search(r"([0-9.]+) % of the voxels", printed)[1])
    assert wrong < 10
    if not importlib.util.find_spec("matplotlib"):
        pytest.skip("the figures of lib/python: matplotlib is not installed")
    assert (folder / "tutorial.png").stat().st_size > 10000
