# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""segment() and what comes of it equal the command; wrong options are refused."""

import warnings

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


@pytest.mark.parametrize("voxel_size, edges", [
    ("2um", (2, 2, 2)), ("0.5x0.5x1.2um", (1.2, 0.5, 0.5)), ("1x1x1.37um", (1.37, 1, 1))])
def test_squared_lengths_have_a_unit(voxel_size, edges):
    """The largest ball of a ball has its radius, whatever the voxels are."""
    places = (np.indices((31, 31, 31)).T - 15).T * np.reshape(edges, (3, 1, 1, 1))
    ball = (places**2).sum(axis=0) <= (9 * min(edges))**2
    seg = madf.segment(ball, voxel_size=voxel_size, keep=("balls", "distance"))
    nearest = (places**2).sum(axis=0)[~ball].min()  # to the background, from the middle
    for squares, unit in ((seg.balls["squared_radius"], seg.labels.squared_unit),
                          (np.asarray(seg.distance_squared), seg.distance_squared.squared_unit)):
        largest = np.sqrt(squares.max() * unit)
        assert seg.labels.unit == "mm" and largest == pytest.approx(1e-3 * nearest**0.5, rel=1e-5)


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
    (dict(threads=10**9), ValueError, "threads=1000000000: must be from 0"),
    (dict(threshold=1), ValueError, "only one"),
    (dict(despeckle=-1), ValueError, "despeckle=-1: must be 0 or more"),
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


def test_a_slice_with_a_closed_boundary_is_a_warning():
    slice_ = np.zeros((1, 20, 20), np.uint8)
    slice_[0, 5:15, 5:15] = 1
    with pytest.warns(UserWarning, match="one voxel along z"):
        madf.segment(slice_, phase=1, boundary="closed")
