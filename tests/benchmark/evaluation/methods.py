"""What tests/benchmark/paper and accuracy run on one volume: vdb_madf, the watershed and CDGS, and
how they are judged."""
import csv
import json
import os
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
MADF = pathlib.Path(os.environ.get("VDB_MADF_BUILD",
                                   HERE.parents[2] / "build")) / "tools" / "vdb_madf"
DUST = 100  # voxels; smaller grains are counted apart

try:
    import numpy
    NO_NUMPY = None
except ImportError:
    NO_NUMPY = "skipped: python3-numpy is not installed"
try:
    from evaluation import watershed
    NO_WATERSHED = None
except ImportError:
    NO_WATERSHED = "skipped: python3-scipy, python3-skimage are not installed"

try:
    from evaluation import cdgs
    NO_CDGS = None
except ImportError:
    NO_CDGS = "skipped: python3-numpy, python3-scipy are not installed"

WATERSHEDS = {"watershed, every maximum": "plain", "watershed, smoothed": "smoothed"}
CDGS, CDGS_TUNED = "CDGS, default", "CDGS, tuned"
# What --paper stands for, of segment and of remerge.
LETTER_SEGMENT = ["--fill-holes", 0]
LETTER = ["--merge", "angle", "--adjacency", "cell", "--delta", 0, "--tidy", 0]


def angle(gamma, theta):
    return ["--gamma", gamma, *LETTER_SEGMENT], [*LETTER, "--theta", theta]


def both(theta, delta=2):
    return [], ["--merge", "both", "--theta", theta, "--delta", delta]


DEFAULT = [], []
# Of the gammas and thetas the paper took: 0, -1 for balls; 160, -0.8 for MF; 20, -0.5 for RG.
BALL_METHODS = {"MADF to the letter, theta -1": angle(0, -1),
                "MADF, both tests, theta -1, delta 0": both(-1, 0),
                "MADF, both tests, theta -0.9": both(-0.9), "MADF, our default": DEFAULT}
SNOW_METHODS = {"MADF, our default": DEFAULT, "MADF, both tests, theta -0.9": both(-0.9),
                "MADF to the letter, 0, -0.8": angle(0, -0.8),
                "MADF to the letter, 20, -0.5": angle(20, -0.5),
                "MADF to the letter, 160, -0.8": angle(160, -0.8)}


def madf(*arguments, threads=1):
    subprocess.run([MADF, *map(str, arguments), "--threads", str(threads), "-q"], check=True)


def dense(volume, work, *options):
    """The volume as an array [z, y, x]."""
    madf("convert", volume, work / "dense.npy", *options)
    return numpy.load(work / "dense.npy")


def cut(volume, work, methods, tune=False):
    """The grains by each method, each watershed and CDGS, where they can run: name -> file of
    labels.

    tune: CDGS tuned to the true grains, too; what it took is in work / "tuned.txt".
    """
    files = {}
    for segmentation in dict.fromkeys(tuple(segmentation) for segmentation, _ in methods.values()):
        madf("segment", volume, work / "stored.vdb", *segmentation, "--keep", "manifold")
        for i, (name, (its, options)) in enumerate(methods.items()):
            if tuple(its) == segmentation:
                files[name] = work / f"madf{i}.vdb"
                madf("remerge", work / "stored.vdb", files[name], *options)
    files = {name: files[name] for name in methods}
    if not NO_WATERSHED:
        result = watershed.grains(dense(volume, work) > 0)
        for name, kind in WATERSHEDS.items():
            files[name] = work / f"{kind}.npy"
            numpy.save(files[name], result[kind][0])
    if not NO_CDGS:
        solid = dense(volume, work) > 0
        normals = cdgs.Normals(solid)
        files[CDGS] = work / "cdgs.npy"
        numpy.save(files[CDGS], cdgs.grains(solid, normals))
        if tune:
            files[CDGS_TUNED] = work / "cdgs_tuned.npy"
            grid = () if volume.suffix == ".npy" else ("--grid", "truth")
            labels, taken = cdgs.tuned(dense(volume, work, *grid, "--type", "int32"), solid,
                                       normals)
            numpy.save(files[CDGS_TUNED], labels)
            (work / "tuned.txt").write_text(taken)
    return files


def judge(volume, work, methods):
    """The score of each method on a sample with known truth."""
    scores = {name: score(volume, file, work)
              for name, file in cut(volume, work, methods, tune=True).items()}
    if CDGS_TUNED in scores:
        scores[CDGS_TUNED]["tuned"] = (work / "tuned.txt").read_text()
    return scores


def score(truth, test, work):
    madf("compare", truth, test, "--json", work / "compare.json", "--grains", work / "grains.csv")
    all_of = json.loads((work / "compare.json").read_text())
    with open(work / "grains.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    found = sum(r["side"] == "truth" and float(r["intersection_over_union"]) > 0.5 for r in rows)
    dust = sum(r["side"] == "test" and int(r["voxels"]) < DUST for r in rows)
    return {"true": all_of["truth_grains"], "grains": all_of["test_grains"], "found": found,
            "dust": dust, "extra": all_of["test_grains"] - dust - found,
            "percent": all_of["misclassified_percent"],
            "mirror": all_of["mirror_misclassified_percent"]}


def interfaces(labels, work):
    """For each interface |mean curvature|, |Gaussian curvature| (None where too small) and
    flatness."""
    madf("measure", labels, work / "tables")
    with open(work / "tables" / "bonds.csv", newline="") as file:
        rows = list(csv.DictReader(file))

    def of(row, key):
        return abs(float(row[key])) if row[key] else None
    return [(of(r, "mean_curvature_per_voxel"), of(r, "gaussian_curvature_per_voxel2"),
             of(r, "flatness_voxel2"))
            for r in rows]


def bond_ratio(labels, work):
    madf("measure", labels, work / "tables")
    return json.loads((work / "tables" / "sample.json").read_text())["bond_to_grain_ratio"]


def interface_voxels(labels):
    """Of an array of labels: voxels with a face in common with another grain, labeled by the
    pair."""
    pair = numpy.zeros(labels.shape, numpy.int64)
    for axis in range(3):
        low = [slice(None)] * 3
        high = [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        low, high = tuple(low), tuple(high)
        a, b = labels[low], labels[high]
        key = numpy.where((a > 0) & (b > 0) & (a != b),
                          numpy.minimum(a, b).astype(numpy.int64) << 32 | numpy.maximum(a, b), 0)
        pair[low] = numpy.maximum(pair[low], key)
        pair[high] = numpy.maximum(pair[high], key)
    return numpy.unique(pair, return_inverse=True)[1].reshape(labels.shape).astype(numpy.int32)


def power_cells(squared_radius, z):
    """Slice z of the power map of balls (array of squared radii, 0: none): a number for each
    ball."""
    least = numpy.zeros(squared_radius.shape[1:], numpy.int64)
    cells = numpy.zeros(squared_radius.shape[1:], numpy.int32)
    zs, ys, xs = numpy.nonzero(squared_radius)
    ds = squared_radius[zs, ys, xs].astype(numpy.int64)
    for n, i in enumerate(numpy.lexsort((zs, ys, xs, -ds)), 1):  # larger first, then x, y, z
        d = int(ds[i]) - int(zs[i] - z) ** 2
        if d <= 0:
            continue
        reach = int(d**0.5) + 1
        y0, y1 = max(0, ys[i] - reach), ys[i] + reach + 1
        x0, x1 = max(0, xs[i] - reach), xs[i] + reach + 1
        box = least[y0:y1, x0:x1]
        power = ((numpy.arange(y0, y0 + box.shape[0]) - ys[i]) ** 2)[:, None] \
            + (numpy.arange(x0, x0 + box.shape[1]) - xs[i]) ** 2 - d
        nearer = power < box
        box[nearer] = power[nearer]
        cells[y0:y1, x0:x1][nearer] = n
    return cells
