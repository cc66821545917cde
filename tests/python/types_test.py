# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The package is typed, and the types of its library are those that it has."""

import inspect
import os
import pathlib
import re
import subprocess
import sys

import pytest

import vdb_madf as madf

PACKAGE = pathlib.Path(madf.__file__).parent


def checked(*command, tmp_path):
    pytest.importorskip("mypy", reason="types of the Python package: mypy is not installed")
    cache = tmp_path.parent / "mypy"  # what is known of numpy's types is used again
    run = subprocess.run([sys.executable, "-m", *map(str, command)], cwd=tmp_path, text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                         env={**os.environ, "MYPYPATH": str(PACKAGE.parent),
                              "MYPY_CACHE_DIR": str(cache)})
    assert run.returncode == 0, run.stdout


def test_types_are_strict(tmp_path):
    use = tmp_path / "use.py"
    use.write_text("""\
import numpy as np
import vdb_madf as madf
seg: madf.Segmentation = madf.segment(np.zeros((2, 3, 4), np.uint8), phase=1, progress=print)
measured = madf.measure(seg.labels)
volume: float = float(measured.grains["volume"].sum()) + madf.compare(seg.labels, seg.labels).splits
""")
    checked("mypy", "--strict", use, tmp_path=tmp_path)  # and the package that it imports


def test_wrong_calls_are_seen(tmp_path):
    calls = {
        "madf.segment('scan.tif', treshold=1)": "treshold",
        "madf.generate('snow', lenght=20)": "lenght",
        "madf.segment('scan.tif', phase=1, gamma=20.0)": "float",
        "madf.measure('labels.tif', shapes=True)": "shapes",
    }
    use = tmp_path / "use.py"
    use.write_text("\n".join(["import vdb_madf as madf", *calls]))
    with pytest.raises(AssertionError) as error:
        checked("mypy", "--strict", use, tmp_path=tmp_path)
    for line, wrong in enumerate(calls.values(), 2):
        assert re.search(f"use.py:{line}: error: .*{wrong}", str(error.value))


def test_stubs_are_those_of_the_library(tmp_path):
    # pybind11's own; names of types that the stub alone knows.
    allowed = tmp_path / "allowed"
    allowed.write_text(r"""
vdb_madf._core.(ArraySource|Call|Grid|VolumeOptions)
vdb_madf._core.Grid.__(init|pybind11).*
vdb_madf._core.(Edges|Index)
""")
    checked("mypy.stubtest", "vdb_madf._core", "--concise", "--allowlist", allowed,
            tmp_path=tmp_path)


@pytest.mark.parametrize("name", [name for name in madf.__all__ if callable(getattr(madf, name))
                                  and name not in ("ArrayLike3D", "Progress", "Source")])
def test_what_is_public_is_documented(name):
    thing = getattr(madf, name)
    assert inspect.getdoc(thing), name
    for attribute, value in vars(thing).items() if inspect.isclass(thing) else ():
        if not attribute.startswith("_") and callable(value) or isinstance(value, property):
            assert inspect.getdoc(value), f"{name}.{attribute}"
