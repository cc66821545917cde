"""The methods of tests/benchmark/accuracy and how each is judged on one sample."""
import csv
import json
import statistics

import numpy
from scipy import ndimage
from skimage import measure

from evaluation import cdgs, methods as m, watershed

OURS = {"ours, default": "",
        "ours, angle and neck (theta -0.9, delta 2)": "--merge both --theta -0.9 --delta 2",
        "the paper to the letter (160, -0.8)": "--paper --gamma 160 --theta -0.8"}
WATERSHEDS = {"watershed, every maximum": "plain", "watershed, smoothed": "smoothed",
              "SNOW's steps": "snow", "watershed, h-maxima": "h_maxima"}
CDGS = "CDGS, tuned to the truth"
FILLED = ", holes filled"
RIVALS = [*WATERSHEDS, CDGS, *(name + FILLED for name in WATERSHEDS), CDGS + FILLED]
METHODS = {"ours": list(OURS), "all": [*OURS, *RIVALS]}
TRUTH = "the truth"
SLIVER = 20  # voxels; smaller grains are no slivers
# pixels of a section: smaller grains are not counted as spurious; true ones not as missed
SECTION_DUST, SECTION_LEAST = 40, 30


def grains(solid, truth, work, methods):
    """name -> file of labels, of the object by each of these METHODS."""
    numpy.save(work / "object.npy", solid.astype(numpy.uint8))
    files = {}

    def new(name):
        files[name] = work / f"{len(files)}.npy"
        return files[name]

    def keep(name, labels):
        numpy.save(new(name), labels)
    for name, options in OURS.items():
        m.madf("segment", work / "object.npy", new(name), *options.split())
    if methods == "ours":
        return files
    for name, kind in WATERSHEDS.items():
        keep(name, watershed.grains(solid, [kind])[kind][0])
    thin = 1 in solid.shape  # has no normals
    if not thin:
        keep(CDGS, cdgs.tuned(truth, solid)[0])
    body = watershed.filled(solid)
    if (body == solid).all():
        files.update({name + FILLED: files[name] for name in (*WATERSHEDS, CDGS) if name in files})
        return files
    for name, kind in WATERSHEDS.items():
        keep(name + FILLED, numpy.where(solid, watershed.grains(body, [kind])[kind][0], 0))
    keep(CDGS + FILLED, numpy.where(solid, cdgs.tuned(truth, body)[0], 0))
    return files


def form(labels, dust):
    """How many crumbs, slivers, large grains and grains in pieces there are: accuracy_report.py
    says what these are."""
    sizes = numpy.bincount(labels.ravel())
    sizes[0] = 0
    touching = numpy.zeros(len(sizes), bool)
    for axis in range(3):
        a, b = (numpy.moveaxis(labels, axis, 0)[ends] for ends in (slice(None, -1), slice(1, None)))
        meet = (a > 0) & (b > 0) & (a != b)
        touching[a[meet]] = touching[b[meet]] = True
    deep = numpy.zeros(len(sizes), bool)
    deep[labels[ndimage.minimum_filter(labels, 3) == ndimage.maximum_filter(labels, 3)]] = True
    pieces = measure.label(labels, background=0, connectivity=1)
    first = numpy.unique(pieces, return_index=True)[1]
    counts = numpy.bincount(labels.ravel()[first], minlength=len(sizes))
    counts[0] = 0
    return {"crumbs": int((touching & (sizes < dust)).sum()),
            "slivers": int((touching & ~deep & (sizes >= SLIVER)).sum()),
            "large": int((sizes >= dust).sum()),
            "in_pieces": int((counts > 1).sum())}


def flatness(file, work):
    values = [flat for _, _, flat in m.interfaces(file, work) if flat is not None]
    return statistics.mean(values) if values else None


def agreement(truth, file, work, dust, least):
    """How the grains of a file are those of the truth. Grains of fewer than `dust` voxels are not
    spurious, true ones of fewer than `least` not looked for."""
    m.madf("compare", truth, file, "--json", work / "compare.json", "--grains", work / "grains.csv")
    all_of = json.loads((work / "compare.json").read_text())
    with open(work / "grains.csv", newline="") as lines:
        rows = [(r["side"], int(r["voxels"]), float(r["intersection_over_union"]))
                for r in csv.DictReader(lines)]
    shares = [share for side, voxels, share in rows if side == "truth" and voxels >= least]
    true, found = len(shares), sum(share > 0.5 for share in shares)
    spurious = sum(side == "test" and voxels >= dust and share <= 0.5
                   for side, voxels, share in rows)
    return {"true": true, "grains": all_of["test_grains"], "found": found, "spurious": spurious,
            "found_percent": 100 * found / true, "spurious_percent": 100 * spurious / true,
            "missed_percent": 100 * (true - found) / true,
            "misclassified_percent": all_of["misclassified_percent"],
            "adjusted_rand_index": all_of["adjusted_rand_index"],
            "variation_of_information_bits": all_of["variation_of_information_bits"]}


def judge(solid, truth, work, methods, section):
    """name -> its figures, of these METHODS and the truth itself."""
    files = {TRUTH: work / "truth.npy"}
    numpy.save(files[TRUTH], truth)
    files.update(grains(solid, truth, work, methods))
    dust, least = (SECTION_DUST, SECTION_LEAST) if section else (m.DUST, 0)
    figures = {file: {**agreement(files[TRUTH], file, work, dust, least),
                      **form(numpy.load(file), dust),
                      "flatness_voxel2": flatness(file, work)}
                      for file in dict.fromkeys(files.values())}
    return {name: figures[file] for name, file in files.items()}
