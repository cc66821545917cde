# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Shapes, gray values, edge weights and bootstrap intervals of `measure` are those of NumPy and
SciPy.

Seeded samples: cells of random points in a noisy object, with grains of one voxel, a row and a
sheet, of cubes and of unequal voxels. Everything is computed again by its definition from the array
of labels.
"""

import csv
import itertools
import json
import subprocess

from proof import Bench, check, skip

try:
    import numpy as np
    from scipy import ndimage, spatial
except ImportError as error:
    skip(f"measures by NumPy and SciPy: {error} (tools/setup --tests)")

REPLICATES = 300


def sample(seed, shape=(30, 34, 38)):
    """Labels [z, y, x]."""
    random = np.random.default_rng(seed)
    object_ = ndimage.gaussian_filter(random.random(shape), 2.5) > 0.5
    points = random.random((18, 3)) * shape
    places = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)
    _, nearest = spatial.cKDTree(points).query(places)
    labels = np.where(object_, 3 * nearest + 2, 0).astype(np.int32)
    labels[:12, :12, :12] = 0
    labels[2, 2, 2] = 1
    labels[5, 2:9, 5] = 4
    labels[8, 1:9, 1:6] = 70000
    return labels


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {name: np.array([float(row[i]) if row[i] else np.nan for row in rows[1:]])
            for i, name in enumerate(rows[0])}


def near(found, expected, what, tolerance=6e-9):  # nine digits are written
    check(np.allclose(found, expected, rtol=tolerance, atol=1e-12, equal_nan=True),
          f"{what}: {found}, not {expected}")


def hull_measures(voxels, edges):
    """Of voxels (n, 3): largest distance, least width, volume of the hull of their corners."""
    corners = (voxels[:, None] + np.array(list(itertools.product((0, 1), repeat=3)))).reshape(-1, 3)
    points = np.unique(corners, axis=0) * edges
    hull = spatial.ConvexHull(points)
    points = points[hull.vertices]
    normals = [hull.equations[:, :3]]
    sides = {tuple(sorted(pair)) for triangle in hull.simplices
             for pair in itertools.combinations(triangle, 2)}
    along = np.array([hull.points[b] - hull.points[a] for a, b in sides])
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = np.cross(along[:, None], along[None]).reshape(-1, 3)  # of any two sides
    length = np.linalg.norm(across, axis=1)
    normals.append(across[length > 1e-9] / length[length > 1e-9, None])
    extents = np.concatenate([np.ptp(points @ part.T, axis=0)
                              for part in np.array_split(np.concatenate(normals), 50)])
    return spatial.distance.pdist(points).max(), extents.min(), hull.volume


def check_shapes(labels, grains, edges, unit):
    for row, label in enumerate(grains["id"].astype(int)):
        voxels = np.argwhere(labels == label)[:, ::-1]
        if len(voxels) > 400:
            continue
        longest, width, volume = hull_measures(voxels, edges)
        near(grains[f"feret_max_{unit}"][row], longest, f"feret_max of {label}")
        near(grains[f"feret_min_{unit}"][row], width, f"feret_min of {label}")
        near(grains[f"convex_volume_{unit}3"][row], volume, f"convex volume of {label}")
        near(grains["solidity"][row], len(voxels) * np.prod(edges) / volume, f"solidity of {label}")
    wide, thick = grains["aspect_2_to_1"] > 2 / 3, grains["aspect_3_to_2"] > 2 / 3
    near(grains["zingg_class"], np.choose(wide * 2 + thick, [3, 4, 1, 2]), "Zingg's classes")


def gray_numbers(values):
    values = values[np.isfinite(values)].astype(float)
    if not len(values):
        return [0] + [np.nan] * 5
    return [len(values), values.mean(), values.std(), values.min(), values.max(), np.median(values)]


def check_gray(labels, scan, grains, bonds):
    names = ["gray_" + name for name in ("voxels", "mean", "sd", "min", "max", "median")]
    for row, label in enumerate(grains["id"]):
        near([grains[name][row] for name in names], gray_numbers(scan[labels == label]),
             f"gray values of grain {label}")
    for row, (first, second) in enumerate(zip(bonds["first"], bonds["second"])):
        beside = np.zeros(labels.shape, bool)
        for axis in range(3):
            low = tuple(slice(None, -1) if i == axis else slice(None) for i in range(3))
            high = tuple(slice(1, None) if i == axis else slice(None) for i in range(3))
            a, b = labels[low], labels[high]
            touch = ((a == first) & (b == second)) | ((a == second) & (b == first))
            beside[low] |= touch
            beside[high] |= touch
        near([bonds[name][row] for name in names], gray_numbers(scan[beside]),
             f"gray values of bond {first}, {second}")


def percentile(values, weights, share):
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weights[order])
    return values[order][np.searchsorted(below, share * below[-1] * (1 - 1e-12))]


def check_weights(labels, grains, numbers, unit):
    weights = []
    for label in grains["id"]:
        weight = 1
        for size, place in zip(labels.shape, np.nonzero(labels == label)):
            whole = 0 < place.min() and place.max() < size - 1
            weight *= size / (size - np.ptp(place) - 2) if whole else 0
        weights.append(weight)
    weights = np.array(weights)
    near(grains["edge_weight"], weights, "edge weights")
    check((weights == 0).any() and (weights > 1).any(), "grains of both kinds")
    check(numbers["grains_at_faces"] == (weights == 0).sum(), "grains at faces")
    diameters = grains[f"equivalent_diameter_{unit}"]
    near(numbers["corrected_grains"], weights.sum(), "corrected number")
    near(numbers[f"grain_diameter_mean_{unit}"], diameters.mean(), "mean diameter")
    near(numbers[f"corrected_grain_diameter_mean_{unit}"], np.average(diameters, weights=weights),
         "corrected mean diameter")
    near(numbers[f"corrected_grain_volume_mean_{unit}3"],
         np.average(grains[f"volume_{unit}3"], weights=weights), "corrected mean volume")
    near(numbers["corrected_mean_coordination"],
         np.average(grains["coordination"], weights=weights), "corrected coordination")
    for kind, factor in (("number", 1), ("volume", grains["voxels"])):
        found = numbers[f"corrected_grain_diameter_by_{kind}_{unit}"]
        for percent in (5, 10, 25, 50, 75, 90, 95):
            near(found[f"d{percent}"], percentile(diameters, weights * factor, percent / 100),
                 f"corrected d{percent} by {kind}")


def check_intervals(grains, bonds, numbers, unit):
    ids = grains["id"]
    ratios = np.zeros(len(ids))
    diameters = grains[f"equivalent_diameter_{unit}"]
    for first, second, radius in zip(bonds["first"], bonds["second"], bonds[f"radius_{unit}"]):
        ends = np.searchsorted(ids, [first, second])
        ratios[ends] += 2 * radius / diameters[ends].min()
    one, weights = np.ones(len(ids)), grains["edge_weight"]
    quotients = {
        f"grain_diameter_mean_interval_{unit}": (diameters, one),
        f"grain_volume_mean_interval_{unit}3": (grains[f"volume_{unit}3"], one),
        "sphericity_mean_interval": (np.nan_to_num(grains["sphericity"]),
                                     np.isfinite(grains["sphericity"]).astype(float)),
        f"specific_surface_interval_per_{unit}": (grains[f"free_area_{unit}2"],
                                                  grains[f"volume_{unit}3"]),
        "mean_coordination_interval": (grains["coordination"], one),
        "bond_to_grain_ratio_interval": (ratios, grains["coordination"]),
        "solidity_mean_interval": (grains["solidity"], one),
        f"corrected_grain_diameter_mean_interval_{unit}": (weights * diameters, weights),
    }
    check(numbers["bootstrap_replicates"] == REPLICATES, "replicates")
    drawn = {name: [] for name in quotients}
    for replicate in range(1, REPLICATES + 1):
        generator = np.random.MT19937()
        generator._legacy_seeding(replicate)  # that of C++
        picks = generator.random_raw(len(ids)).astype(np.uint64) * np.uint64(len(ids)) >> np.uint64(
            32)
        for name, (above, below) in quotients.items():
            if below[picks].sum() > 0:
                drawn[name].append(above[picks].sum() / below[picks].sum())
    for name, (above, below) in quotients.items():
        found = numbers[name]
        near([found["mean"], found["low"], found["high"]],
             [above.sum() / below.sum(), *np.percentile(drawn[name], [2.5, 97.5])], name, 1e-8)


with Bench() as bench:
    for seed, voxel, edges, unit in ((1, None, (1, 1, 1), "voxel"), (2, "10um", (0.01,) * 3, "mm"),
                                     (3, "10x14x25um", (0.01, 0.014, 0.025), "mm")):
        labels = sample(seed)
        random = np.random.default_rng(100 + seed)
        scan = [random.integers(0, 256, labels.shape).astype(np.uint8),
                random.integers(-30000, 30000, labels.shape).astype(np.int16),
                random.normal(size=labels.shape).astype(np.float32)][seed - 1]
        if seed == 3:
            scan[random.random(scan.shape) < 0.1] = np.nan
        np.save(bench.path("labels.npy"), labels)
        np.save(bench.path("scan.npy"), scan)
        subprocess.run([bench.tool, "measure", bench.path("labels.npy"), bench.path("tables"), "-q",
                        "--shape", "--intensity", bench.path("scan.npy"), "--edge-weights",
                        "--bootstrap", str(REPLICATES),
                        *(["--voxel-size", voxel] if voxel else [])],
                       check=True)
        grains, bonds = read(bench.path("tables/grains.csv")), read(bench.path("tables/bonds.csv"))
        with open(bench.path("tables/sample.json")) as file:
            numbers = json.load(file)
        check(len(bonds["first"]) > 10, "bonds")
        check_shapes(labels, grains, np.array(edges), unit)
        check_gray(labels, scan, grains, bonds)
        check_weights(labels, grains, numbers, unit)
        check_intervals(grains, bonds, numbers, unit)
print("NumPy and SciPy agree: hulls, gray values, edge weights and bootstrap intervals")
