# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""segment() and what comes of it equal the command; wrong options are refused."""

import json
import os
import re
import subprocess
import warnings
from xml.etree import ElementTree

import numpy as np
import pytest

import vdb_madf as madf


@pytest.fixture(scope="module")
def scan(array, tmp_path_factory):
    path = tmp_path_factory.mktemp("scan") / "scan.npy"
    np.save(path, array)
    return path


@pytest.fixture(scope="module")
def gray(array, tmp_path_factory):
    noise = np.random.default_rng(3).normal(0, 12, array.shape)
    path = tmp_path_factory.mktemp("gray") / "gray.npy"
    np.save(path, (60 + 90.0 * array + noise).clip(0, 255).astype(np.uint8))
    return path


# Arguments here, options there.
SAME = [
    ({}, []),
    (dict(strictness=9.5), ["--strictness", "9.5"]),
    (dict(min_grain=5000), ["--min-grain", "5000"]),
    (dict(theta=-0.5, merge="angle", adjacency="cell", delta=0),
     ["--theta", "-0.5", "--merge", "angle", "--adjacency", "cell", "--delta", "0"]),
    (dict(gamma=30, fill_holes=0, tidy=0), ["--gamma", "30", "--fill-holes", "0", "--tidy", "0"]),
    (madf.PAPER, ["--paper"]),
    (dict(boundary="closed", invert=True), ["--boundary", "closed", "--invert"]),
    (dict(voxel_size="1x1.5x3um"), ["--voxel-size", "1x1.5x3um"]),
    (dict(roi="cylinder"), ["--roi", "cylinder"]),
    (dict(roi=madf.Cylinder("y", (30, 42.5), 25)), ["--roi", "cylinder:y:42.5,30:25"]),
    (dict(crop=np.s_[10:50, 3:, :70]), ["--crop", "0,3,10:69,71,49"]),
    (dict(threads=1), ["--threads", "2"]),
]


@pytest.mark.parametrize("arguments, options", SAME)
def test_files_are_those_of_the_command(arguments, options, scan, command, tmp_path):
    madf.segment(scan, phase=1, **arguments).labels.save(tmp_path / "here.vdb")
    command("segment", scan, tmp_path / "there.vdb", "--phase", "1", *options)
    assert (tmp_path / "here.vdb").read_bytes() == (tmp_path / "there.vdb").read_bytes()


@pytest.mark.parametrize("arguments, options", [
    (dict(threshold="otsu"), ["--threshold", "otsu"]),
    (dict(threshold=(95, 120), despeckle=20), ["--threshold", "95:120", "--despeckle", "20"]),
    (dict(threshold=105, median=1, smooth=0.7),
     ["--threshold", "105", "--median", "1", "--smooth", "0.7"]),
    (dict(range=(100, 180)), ["--range", "100:180"]),
    (dict(threshold="valley", smooth=1, roi="cylinder"), ["--threshold", "valley", "--smooth", "1",
                                                          "--roi", "cylinder"]),
])
def test_gray_scans(arguments, options, gray, command, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what was fitted and left out
        of_file = madf.Mask(gray, **arguments)
        of_array = madf.Mask(np.load(gray), **arguments)
    of_file.save(tmp_path / "here.vdb")
    command("convert", gray, tmp_path / "there.vdb", *options)
    assert (tmp_path / "here.vdb").read_bytes() == (tmp_path / "there.vdb").read_bytes()
    assert (np.asarray(of_file) == np.asarray(of_array)).all()


def test_a_region_of_voxels(array, scan, command, tmp_path):
    inside = np.zeros(array.shape, np.uint8)
    inside[5:60, 10:60, 4:66] = 7
    inside[20:30, 20:30, 20:30] = 0
    np.save(tmp_path / "roi.npy", inside)
    command("segment", scan, tmp_path / "there.npy", "--phase", "1", "--roi", tmp_path / "roi.npy")
    want = np.load(tmp_path / "there.npy")
    for roi in (inside, inside > 0, madf.Mask(inside > 0), tmp_path / "roi.npy"):
        with pytest.warns(UserWarning, match="left out"):
            labels = madf.segment(array, phase=1, roi=roi).labels
        first = labels.first
        assert np.asarray(labels).tobytes() == want.tobytes(), (labels.shape, want.shape, first)
    with pytest.raises(madf.InvalidInput, match="does not cover"):
        madf.Mask(array, phase=1, roi=inside[:50])


def test_remerge_and_sweep_equal_fresh_segmentations(sample):
    seg = madf.segment(sample[0])
    thetas = [-1, -0.7, -0.3, 0.2]
    rows = seg.sweep(theta=np.array(thetas), merge=["both", "angle"])
    assert rows["merge"] == ["both"] * 4 + ["angle"] * 4 and list(rows["theta"]) == 2 * thetas
    for row, (merge, theta) in enumerate((m, t) for m in ("both", "angle") for t in thetas):
        fresh = madf.segment(sample[0], theta=theta, merge=merge)
        again = seg.remerge(theta=theta, merge=merge)
        assert (np.asarray(fresh.labels) == np.asarray(again.labels)).all()
        assert again.options == fresh.options and again.counts["grains"] == fresh.counts["grains"]
        assert again.labels.metadata == fresh.labels.metadata
        assert rows["grains"][row] == fresh.counts["grains"]
        assert rows["largest_voxels"][row] == fresh.labels.voxels.max()
    assert rows["grains"][0] > rows["grains"][3]
    with pytest.raises(madf.InvalidInput, match="keep"):
        madf.segment(sample[0], keep=()).remerge(strictness=0)


def test_a_least_grain_stays_until_it_is_given_anew(sample):
    seg = madf.segment(sample[0], merge="both", min_grain=np.int64(5000))
    plain = madf.segment(sample[0])
    assert seg.options["min_grain"] == 5000 and "min_grain" not in plain.options
    fresh = madf.segment(sample[0], min_grain=5000)
    assert fresh.counts["grains"] < plain.counts["grains"]
    for again in (seg.cut(11), plain.remerge(min_grain=5000)):
        assert again.options == fresh.options
        assert np.array_equal(again.labels, fresh.labels)
    assert seg.sweep([11], merge="score")["grains"] == [fresh.counts["grains"]]
    back = fresh.remerge(min_grain=0)
    assert back.options == plain.options and back.labels.metadata == plain.labels.metadata
    for wrong, error, says in ((-1, madf.InvalidInput, "must not be negative"),
                               (2.5, TypeError, "min_grain=2.5: give a whole number"),
                               ("few", TypeError, "min_grain='few': give a whole number")):
        with pytest.raises(error, match=says):
            madf.segment(sample[0], min_grain=wrong)
    with pytest.raises(TypeError, match="delta=0.5: give a whole number"):
        madf.segment(sample[0], merge="both", delta=0.5)


def test_merging_by_score():
    mask = madf.generate("snow", size=64, fraction=0.4, length=12)[0]
    seg = madf.segment(mask, strictness=12)
    assert seg.options["merge"] == "score" and seg.options["strictness"] == 12
    assert not {"theta", "delta", "adjacency"} & set(seg.options)
    joins = seg.hierarchy
    made_at = joins["strictness"]
    assert len(made_at) > 4
    for strictness in (made_at[0], made_at[len(made_at) // 2], made_at[-1]):
        fresh = madf.segment(mask, strictness=strictness)
        again = seg.cut(strictness)
        assert (np.asarray(fresh.labels) == np.asarray(again.labels)).all()
        assert again.options == fresh.options and again.labels.metadata == fresh.labels.metadata
        made = joins["strictness"] >= strictness
        assert joins["grains"][made][-1] == fresh.counts["grains"]
    assert (np.diff(joins["strictness"]) <= 0).all()
    assert (joins["strictness"] <= joins["score"]).all()
    both = seg.remerge(merge="both")
    assert both.options == madf.segment(mask, merge="both").options
    assert both.cut(12).options == seg.options
    assert list(seg.sweep(made_at[:3])["grains"]) == [
        joins["grains"][made_at >= at][-1] for at in made_at[:3]]
    rows = seg.sweep(merge=["score", "neck"], strictness=[9, 11], theta=[-0.9])
    assert rows["merge"] == ["score", "score", "neck"]
    assert rows["grains"][1] == seg.cut(11).counts["grains"]
    assert np.isnan(rows["theta"][:2]).all() and np.isnan(rows["strictness"][2])
    with pytest.raises(madf.InvalidInput, match="theta: belongs to merge='both'"):
        seg.remerge(theta=-0.5)
    with pytest.raises(madf.InvalidInput, match="theta: belongs to merge='both'"):
        seg.sweep(theta=[-0.5])
    with pytest.raises(madf.InvalidInput, match="strictness: belongs to merge='score'"):
        madf.segment(mask, merge="neck", strictness=9)
    with pytest.raises(madf.InvalidInput, match="strictness: belongs to merge='score'"):
        seg.sweep([9], merge="neck")


def test_cuts_at_forty_numbers():
    mask = madf.generate("snow", size=48, fraction=0.5, length=8)[0]
    seg = madf.segment(mask)
    numbers = np.linspace(0, 25, 40)
    grains = set()
    for number, swept in zip(numbers, seg.sweep(numbers)["grains"]):
        fresh = madf.segment(mask, strictness=number, keep=())
        again = seg.cut(number)
        assert np.array_equal(again.labels, fresh.labels), number
        assert again.counts["grains"] == fresh.counts["grains"] == swept
        grains.add(swept)
    assert len(grains) > 15


def trees_of(newick):
    """(names of the leaves, length of the branch above, names and lengths of the items) of each
    tree."""
    tokens = re.findall(r"[(),;]|[^(),;]+", newick.replace("\n", ""))
    position = 0

    def item():
        nonlocal position
        parts = []
        if tokens[position] == "(":
            while tokens[position] != ")":
                position += 1
                parts.append(item())
            position += 1
        name, _, length = tokens[position].partition(":")
        position += 1
        return name, float(length or 0), parts

    while position < len(tokens):
        yield item()
        assert tokens[position] == ";"
        position += 1


def test_the_hierarchy_as_trees(command, tmp_path):
    seg = madf.segment(madf.generate("snow", size=64, fraction=0.4, length=12)[0], strictness=30)
    joins = seg.hierarchy
    seg.save(tmp_path / "all.vdb")
    for ending in ("nwk", "graphml"):
        command("hierarchy", tmp_path / "all.vdb", tmp_path / f"joins.{ending}")

    command("hierarchy", tmp_path / "all.vdb", tmp_path / "parents.csv", "--levels", "12,11,9.5")
    header, *rows = (tmp_path / "parents.csv").read_text().split()
    assert header == "grain_at_12,grain_at_11,grain_at_9.5,voxels"
    rows = np.array([row.split(",") for row in rows], int)
    fine, *coarse = (np.asarray(seg.remerge(strictness=k, tidy=0).labels) for k in (12, 11, 9.5))
    assert (rows[:, 0] == np.arange(1, fine.max() + 1)).all() and len(np.unique(rows[:, 2])) > 1
    assert (rows[:, 3] == np.bincount(fine.ravel())[1:]).all()
    for column, labels in zip((1, 2), coarse):
        parents = np.concatenate([[0], rows[:, column]])
        assert np.array_equal(parents[fine], labels)

    command("sweep", tmp_path / "all.vdb", tmp_path / "sweep.csv", "--strictness", "9,11.5")
    header, *rows = (tmp_path / "sweep.csv").read_text().split()
    grains = [int(row.split(",")[header.split(",").index("grains")]) for row in rows]
    assert grains == list(seg.sweep([9, 11.5])["grains"])

    # Cut where the height above the leaves says so, the trees have the grains of that strictness.
    leaves, made = [], {}

    def walk(name, parts):
        heights = [walk(*child[::2]) + child[1] for child in parts]
        if not parts:
            leaves.append(name)
            return 0.0
        assert len(parts) == 2 and np.isclose(*heights)
        made[name] = (joins["strictness"][0] - heights[0], {child[0] for child in parts})
        return heights[0]

    trees = list(trees_of((tmp_path / "joins.nwk").read_text()))
    for name, length, parts in trees:
        assert length == 0
        walk(name, parts)
    count = len(joins["score"])
    assert set(made) == {f"j{i + 1}" for i in range(count)}
    assert len(trees) == len(leaves) - count
    assert np.allclose([made[f"j{i + 1}"][0] for i in range(count)], joins["strictness"], atol=1e-9)
    first = {name for _, parts in made.values() for name in parts if name[0] != "j"}
    assert first <= {str(i + 1) for i in np.concatenate([joins["first"], joins["second"]])}

    graph = ElementTree.parse(tmp_path / "joins.graphml").getroot()
    space = "{http://graphml.graphdrawing.org/xmlns}"
    keys = {key.get("id") for key in graph.iter(space + "key")}
    nodes = {node.get("id"): {data.get("key"): float(data.text) for data in node}
             for node in graph.iter(space + "node")}
    edges = [(edge.get("source"), edge.get("target")) for edge in graph.iter(space + "edge")]
    assert set(nodes) == set(leaves) | set(made) and len(nodes) == count + len(leaves)
    assert {key for data in nodes.values() for key in data} == keys
    assert sum(nodes[name]["voxels"] for name in leaves) == seg.counts["object_voxels"]
    for i in range(count):
        name = f"j{i + 1}"
        parts = [part for source, part in edges if source == name]
        assert set(parts) == made[name][1]
        assert nodes[name]["voxels"] == sum(nodes[part]["voxels"] for part in parts)
        assert nodes[name]["score"] == joins["score"][i]
        assert nodes[name]["grains"] == joins["grains"][i]
    for name in leaves:
        place = [nodes[name][axis] for axis in "zyx"]
        assert place == seg.graph["position"][int(name) - 1].tolist()


def test_the_most_stable_strictness(command, tmp_path):
    mask = madf.generate("particles", shape="rods", size=64, count=12, radius=(3, 6))[0]
    mask.save(tmp_path / "mask.vdb")
    seg = madf.segment(mask, tidy=0)
    stable = seg.stable_strictness
    best = stable["strictness"]
    assert best != 11
    levels = stable["levels"]
    assert np.allclose(levels, np.arange(80, 141) / 10)
    assert stable["stability"][levels == best] == stable["stability"].max()
    for level in (8, 10, best):
        measured = madf.measure(seg.cut(level), stability=True).grains
        weights = np.fmin(measured["stability"], 1)  # NaN: always there
        mean = (weights * measured["voxels"]).sum() / measured["voxels"].sum()
        at = np.flatnonzero(levels == level)
        assert np.isclose(stable["stability"][at], mean, atol=0.002)
        assert stable["grains"][at] == len(measured["id"])
    if stable["plateau"]:
        first, last = (stable["grains"][levels == end] for end in stable["plateau"])
        assert first <= last < 1.05 * first

    command("segment", tmp_path / "mask.vdb", tmp_path / "auto.vdb", "--strictness", "auto",
            "--json", tmp_path / "auto.json", "--keep", "manifold")
    said = json.loads((tmp_path / "auto.json").read_text())
    assert said["strictness"] == best and said["strictness_auto"]
    expected = seg.remerge(strictness=best, tidy=2).labels
    command("segment", tmp_path / "mask.vdb", tmp_path / "all.slabs", "--keep", "manifold",
            "--slab-height", "24")
    for source, result in (("auto.vdb", "again.vdb"), ("all.slabs", "again.slabs")):
        command("remerge", tmp_path / source, tmp_path / result, "--strictness", "auto")
        again = madf.Labels(tmp_path / result, grid="grain")
        assert np.array_equal(again, expected)
        assert again.metadata["madf_strictness"] == best
    labels = madf.Labels(tmp_path / "auto.vdb", grid="grain")
    assert np.array_equal(labels, expected) and labels.metadata == expected.metadata
    tool = os.environ["VDB_MADF_TOOL"]
    for options, says in ((["x.slabs"], "is not for slabs: segment with --keep manifold"),
                          (["x.vdb", "--merge", "both"], "belongs to --merge score")):
        refused = subprocess.run([tool, "segment", tmp_path / "mask.vdb", *options, "--strictness",
                                  "auto"], stderr=subprocess.PIPE, text=True, cwd=tmp_path)
        assert refused.returncode == 2 and says in refused.stderr


def test_what_is_kept(sample, command, tmp_path):
    seg = madf.segment(sample[0], keep=("manifold", "distance", "power", "balls"))
    mask = np.asarray(sample[0])
    distance = np.asarray(seg.distance_squared)
    assert (distance > 0).sum() == mask.sum() and distance.max() == seg.counts[
        "largest_squared_distance"]
    assert seg.manifold.ids[-1] == seg.counts["critical_points"] == len(seg.graph["position"])
    z, y, x = seg.graph["position"].T
    inside = mask[z, y, x]  # or in a filled cavity
    assert (distance[z, y, x][inside] == seg.graph["squared_radius"][inside]).all()
    margin = np.min([np.minimum(p + 1, n - p) for p, n in zip((z, y, x), mask.shape)], axis=0)
    assert (seg.graph["reaches_out"] == (margin**2 < seg.graph["squared_radius"])).all()
    assert 0 < seg.graph["reaches_out"].sum() < len(margin)
    assert seg.graph["voxels"].sum() == mask.sum() == seg.counts["object_voxels"]
    assert (seg.graph["first"] < seg.graph["second"]).all()
    assert seg.graph["second"].max() < seg.counts["critical_points"]
    assert len(seg.balls["position"]) == seg.counts["medial_balls"]
    assert set(seg.seconds) >= {"squared_distance", "power_map", "merge", "labels"}
    seg.save(tmp_path / "all.vdb")
    command("remerge", tmp_path / "all.vdb", tmp_path / "there.vdb", "--strictness", "7")
    here, there = seg.remerge(strictness=7).labels, madf.Labels(tmp_path / "there.vdb")
    assert (np.asarray(here) == np.asarray(there)).all() and here.metadata == there.metadata


def test_memory_is_said_and_limited(sample, array):
    mask = sample[0]
    assert mask.segment_memory > mask._grid.memory
    assert madf.segment(mask, max_memory=mask.segment_memory).counts["grains"] > 0
    for error in (MemoryError, ValueError, madf.NotEnoughMemory):
        with pytest.raises(error, match="max_memory="):
            madf.segment(mask, max_memory="2MiB")


@pytest.mark.parametrize("arguments, error, text", [
    (dict(voxel_size=8.5), TypeError, "unit"),
    (dict(voxel_size="8.5"), ValueError, "voxel_size: 8.5: give a unit"),
    (dict(voxel_size="8,5um"), ValueError, "point, not a comma"),
    (dict(theta=2, merge="both"), ValueError, "cosine"),
    (dict(strictness=1e6), ValueError, "strictness"),
    (dict(theta=-0.8), ValueError, "belongs to merge='both'"),
    (dict(merge="most"), ValueError, "both, angle, neck"),
    (dict(keep=("ball",)), ValueError, "manifold"),
    (dict(boundary="half"), ValueError, "auto, open, closed"),
    (dict(max_memory="12"), ValueError, "max_memory: 12: give a size with its unit"),
    (dict(threads=-1), ValueError, "threads"),
    (dict(threshold=1), ValueError, "only one"),
    (dict(roi=madf.Cylinder("w")), ValueError, "axis"),
    (dict(crop=np.s_[5:5, :, :]), ValueError, "empty"),
    (dict(crop=np.s_[::2, :, :]), ValueError, "step"),
    (dict(gama=3), TypeError, "gama"),
])
def test_wrong_arguments_are_refused(arguments, error, text, array):
    with pytest.raises(error, match=text):
        madf.segment(array, phase=1, **arguments)


def test_a_mask_takes_no_selection(sample):
    with pytest.raises(TypeError, match="phase: a Mask is chosen already"):
        madf.segment(sample[0], phase=1)


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(madf.IoError, match="nothing.tif: cannot be opened"):
        madf.segment(tmp_path / "nothing.tif")
    with pytest.raises(OSError):
        madf.Labels(tmp_path / "nothing.vdb")


def test_scans_of_samples():
    centers = np.array([(0, 0, 0, 8), (0, 0, 15.5, 8)])
    mask, truth, scan = madf.generate("balls", centers=centers, size=40, gray=True)
    assert scan.shape == (40, 40, 40) and scan.dtype == np.uint16
    assert scan.min() == 10000 and scan.max() == 30000
    solid = (scan.astype(float) - 10000).sum() / 20000
    assert solid == pytest.approx(2 * 4 / 3 * np.pi * 8**3, rel=2e-3)
    assert (np.asarray(mask)[(scan == 30000)]).all() and not np.asarray(mask)[scan == 10000].any()
    noisy = madf.generate("balls", centers=centers, size=40, gray=True, blur=0.7, noise=0.05)
    assert (np.asarray(noisy[0]) == np.asarray(mask)).all() and noisy[2].std() != scan.std()
    with pytest.raises(madf.InvalidInput, match="bodies"):
        madf.generate("snow", size=30, gray=True)


def test_samples():
    mask, truth = madf.generate("particles", size=40, count=4, radius=(6, 9), shape="plates",
                                blur=1, noise=0.1)
    assert mask.shape == (40, 40, 40) and 1 <= len(truth.ids) <= 4
    snow, none = madf.generate("snow", size=(16, 20, 24), fraction=0.3, length=12)
    assert snow.shape == (16, 20, 24) and none is None and abs(snow.fraction - 0.3) < 0.01
    rods, truth = madf.generate("particles", size=60, count=3, radius=(5, 5), shape="rods",
                                aspect=(4, 5), neck=1.5)
    assert rods.shape == (60, 60, 60) and len(truth.ids) == 3
    balls, truth = madf.generate("balls", centers=np.array([(0, 0, 0, 5), (0, 0, 12, 7)]))
    assert balls.shape == (14, 14, 24) and sorted(truth.ids) == [1, 2]
    assert np.asarray(truth)[7, 7, 5] == 1 and np.asarray(truth)[7, 7, 17] == 2
    for bad in ([(0, 0, 0)], [(0, 0, float("nan"), 5)], [("0", "0", "0", "5")], 5):
        with pytest.raises(madf.InvalidInput, match="^centers: "):
            madf.generate("balls", centers=np.array(bad), size=20)
    with pytest.raises(madf.InvalidInput, match="there are no balls"):
        madf.generate("balls", size=20)
    with pytest.raises(TypeError, match="no option 'aspect'"):
        madf.generate("particles", aspect=(4, 5))
    with pytest.raises(TypeError, match="no option 'neck'"):
        madf.generate("snow", neck=3)
    with pytest.raises(ValueError, match="seed: is out of range"):
        madf.generate("snow", seed=-1)
    with pytest.raises(ValueError, match="must be spheres"):
        madf.generate("rain")
