# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""libtiff's tiffinfo and tifffile (which scikit-image reads with) read our label images."""

import shutil
import subprocess

from proof import Bench, SIZE, check, skip, values

try:
    import tifffile
except ImportError as error:
    skip(f"what tifffile reads: python3-tifffile is not installed ({error})")
if not shutil.which("tiffinfo"):
    skip("what tiffinfo reads: libtiff-tools is not installed")

with Bench() as bench:
    path = bench.run("convert", "labels.tif", "--out-type", "uint32")
    text = subprocess.run(["tiffinfo", path], check=True, capture_output=True, text=True)
    check(not text.stderr, f"tiffinfo: {text.stderr}")
    check(text.stdout.count("TIFF Directory") == SIZE[2], "tiffinfo: number of pages")
    image = tifffile.imread(path)
    check(image.shape == SIZE[::-1], f"tifffile: shape {image.shape}")
    check(image.reshape(-1).tolist() == values(), "tifffile: the labels differ")
print("tiffinfo and tifffile read label images")
