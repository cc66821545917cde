# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What SciPy and scikit-image make of gray volumes: tests/scans/image_object_test.cc compares.

    gray_reference.py FOLDER    writes volumes and results as .npy, and prints a line for each
    result:
                                "VOLUME RESULT METHOD NUMBERS..."; or "skipped MODULE"
"""
import sys

try:
    import numpy as np
    import scipy.ndimage as ndi
    from skimage import filters, morphology
except ImportError as error:
    print("skipped", error.name)
    sys.exit(0)

SHAPE = (21, 27, 30)


def volumes():
    """Two phases with noise; the objects have a size of some voxels."""
    random = np.random.default_rng(11)
    field = ndi.gaussian_filter(random.standard_normal(SHAPE), 2.2)
    gray = (field > 0.3 * field.std()) * 70 + 60 + random.normal(0, 11, SHAPE)
    yield "uint8", np.clip(gray, 0, 255).astype(np.uint8)
    yield "uint16", (gray.clip(0) * 190).astype(np.uint16)
    yield "int16", (gray * 90 - 9000).astype(np.int16)
    yield "float32", (gray / 100).astype(np.float32)


def results(gray):
    yield "median 1", ndi.median_filter(gray, size=3)
    yield "median 2", ndi.median_filter(gray, size=5)
    for sigma in (0.5, 1.3):
        yield f"smooth {sigma}", ndi.gaussian_filter(gray.astype(np.float32), sigma)
    if gray.dtype != np.float32:
        yield "otsu", gray > filters.threshold_otsu(gray)
    if gray.dtype in (np.uint8, np.float32):
        yield "valley", gray > filters.threshold_minimum(gray)
    low, high = (float(np.quantile(gray, share)) for share in (0.45, 0.95))
    below = [np.nextafter(value, -np.inf) for value in (low, high)]  # theirs is >, ours >=
    yield f"hysteresis {low!r} {high!r}", filters.apply_hysteresis_threshold(gray.astype(float),
                                                                             *below)
    level = float(np.quantile(gray, 0.6))
    for size in (2, 9, 40):
        kept = morphology.remove_small_objects(gray >= level, size)
        yield f"despeckle {level!r} {size}", morphology.remove_small_holes(kept, size)


for name, gray in volumes():
    np.save(f"{sys.argv[1]}/{name}.npy", gray)
    for number, (method, result) in enumerate(results(gray)):
        np.save(f"{sys.argv[1]}/{name}_{number}.npy",
                result.astype(np.uint8) if result.dtype == bool else result)
        print(f"{name}.npy {name}_{number}.npy {method}")
