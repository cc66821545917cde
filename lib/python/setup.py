# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Builds the module with CMake: `pip install ./lib/python`."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent


def version():
    text = (HERE.parent / "vdb_madf/base/version.h").read_text()
    return re.search(r'kVersion\[\] = "([^"]+)"', text)[1]


class CMakeBuild(build_ext):
    """An installed vdb_madf is linked, as CMAKE_PREFIX_PATH tells; else all of it is built."""

    def build_extension(self, extension):
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        build = pathlib.Path(self.build_temp).resolve()
        options = [f"-DPython_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release",
                   f"-DCMAKE_LIBRARY_OUTPUT_DIRECTORY={target.parent}"]
        if shutil.which("ninja"):  # Debian's CMake comes without make
            options += ["-G", "Ninja"]
        try:
            import pybind11
            options.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
        except ImportError:
            pass  # CMake finds that of the system
        options += shlex.split(os.environ.get("CMAKE_ARGS", ""))  # as other packages have it
        subprocess.run(["cmake", "-S", HERE, "-B", build, *options], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "vdb_madf_python", "--parallel"],
                       check=True)


setup(version=version(), packages=["vdb_madf"],
      package_data={"vdb_madf": ["py.typed", "*.pyi", "napari.yaml"]},
      ext_modules=[Extension("vdb_madf._core", [])], cmdclass={"build_ext": CMakeBuild},
      zip_safe=False)
