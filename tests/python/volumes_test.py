# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Volumes are read like arrays; what they cost, how they are copied and kept."""

import multiprocessing
import operator
import os
import pickle
import random
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import vdb_madf as madf


@pytest.fixture(scope="module")
def dense(labels):
    return np.asarray(labels)


def random_part(draw, length):
    kind = draw.random()
    if kind < 0.3:
        return draw.randrange(-length, length)
    ends = [draw.choice([None, draw.randrange(-length - 5, length + 5)]) for _ in range(2)]
    return slice(*ends, draw.choice([None, 1, 1, 2, 3, 7, -1, -2, 50]))


def test_random_keys(labels, sample, dense):
    draw = random.Random(7)
    for volume, whole in ((labels, dense), (sample[0], np.asarray(sample[0]))):
        for _ in range(250):
            key = tuple(random_part(draw, n) for n in dense.shape[:draw.randrange(1, 4)])
            if draw.random() < 0.3:
                key = draw.choice([(..., *key[1:]), (*key[:2], ...), (key[0],)])
            got, want = volume[key if len(key) > 1 else key[0]], whole[key]
            assert np.shape(got) == want.shape and got.dtype == whole.dtype, key
            assert np.array_equal(got, want), key


def test_iteration_and_numpy(labels, dense):
    assert len(labels) == len(dense) and labels.size == dense.size and labels.ndim == 3
    assert all((a == b).all() for a, b in zip(labels, dense))
    assert np.asarray(labels, np.float32).dtype == np.float32
    assert np.max(labels) == dense.max()


@pytest.mark.parametrize("compare", [operator.eq, operator.ne, operator.lt, operator.le,
                                     operator.gt, operator.ge])
def test_comparisons_are_those_of_arrays(compare, labels, sample, dense):
    mask = sample[0]
    others = [3, np.int16(3), 2.5, True, dense[::-1], dense.astype(np.float64), mask, labels]
    for volume, whole in ((labels, dense), (mask, np.asarray(mask))):
        for other in others:
            got, want = compare(volume, other), compare(whole, np.asarray(other))
            assert isinstance(got, np.ndarray) and got.dtype == bool
            assert np.array_equal(got, want), other
            assert np.array_equal(compare(np.asarray(other), volume), compare(np.asarray(other),
                                                                              whole)), other
    with pytest.raises(ValueError, match="compared with"):
        compare(labels, dense[1:])


def test_a_volume_is_no_text_and_stays_a_key(labels):
    assert not labels == "a" and labels != "a"
    with pytest.raises(TypeError):
        labels < "a"
    assert {labels: 1}[labels] == 1 and labels not in {labels.relabel()}
    seg = madf.segment(labels > 0)
    assert seg == seg and seg != madf.segment(labels > 0)


@pytest.mark.parametrize("key", [True, "a", 1.5, [1, 2], (1, 2, 3, 4), (..., ...), 64, -65,
                                 np.zeros(3, bool), None])
def test_other_keys_are_refused(labels, key):
    with pytest.raises(IndexError):
        labels[key]


def test_a_slice_of_a_large_volume_costs_a_slice():
    labels = madf.generate("spheres", size=1024, count=4, radius=(20, 30), overlap=0)[1]
    assert labels.shape == (1024, 1024, 1024) and labels._grid.memory < 2**25
    for id, voxels in zip(labels.ids, labels.voxels):
        grain, (z, y, x) = labels.crop(int(id), pad=2)
        assert grain.sum() == voxels and not grain[:2].any() and grain[2].any()
        middle = z + len(grain) // 2
        assert ((labels[middle] == id)[y:y + grain.shape[1], x:x + grain.shape[2]] ==
                grain[len(grain) // 2]).all()


def test_to_array(labels, dense):
    assert labels.to_array("auto").dtype == np.uint8
    out = np.empty(dense.shape, np.int64, order="F")
    assert labels.to_array(out=out) is out and (out == dense).all()
    view = np.zeros(dense.shape + (2,), np.int32)[..., 1]
    labels.to_array(out=view)
    assert (view == dense).all()
    with pytest.raises(ValueError, match="does not fit"):
        madf.Labels(dense * 100).to_array(np.uint8)
    with pytest.raises(ValueError, match="volume of"):
        labels.to_array(out=np.empty((1, 2, 3), np.int32))


def test_labels_that_floats_do_not_hold():
    far = np.array([[[0, 2**24, 2**24 + 1]]], np.int32)
    volume = madf.Labels(far)
    for read in (lambda dtype: volume.to_array(dtype), lambda dtype: np.asarray(volume, dtype)):
        assert (read(np.float64) == far).all() and (read(bool) == (far > 0)).all()
        with pytest.raises(ValueError, match="16777217 does not fit float32"):
            read(np.float32)
    assert (madf.Labels(far[:, :, :2]).to_array("f4") == far[:, :, :2]).all()


def test_ids_and_sizes(labels, dense):
    ids, counts = np.unique(dense[dense > 0], return_counts=True)
    assert (labels.ids == ids).all() and (labels.voxels == counts).all()


def test_paint(labels, dense):
    values = np.arange(len(labels.ids)) * 0.5
    table = np.full(dense.max() + 1, np.nan, np.float32)
    table[labels.ids] = values
    assert np.array_equal(labels.paint(labels.ids, values), table[dense], equal_nan=True)
    some = labels.paint(labels.ids[[3, 1]], [30, 10], background=-1, dtype=np.int16)
    want = np.full(dense.shape, -1, np.int16)
    want[dense == labels.ids[3]], want[dense == labels.ids[1]] = 30, 10
    assert some.dtype == np.int16 and (some == want).all()
    assert (labels.paint([], [], background=0) == 0).all()
    far = madf.Labels(np.array([[[0, 5, 2**31 - 1]]], np.int32))  # no table as long as that
    painted = far.paint([2**31 - 1, 5, 7], [0.5, 2, 9], background=-1)
    assert painted.tolist() == [[[-1, 2, 0.5]]]
    with pytest.raises(ValueError, match="one for each"):
        labels.paint([1, 2], [1])
    with pytest.raises(ValueError, match="0 is no id"):
        labels.paint([0, 2], [1, 1])


@pytest.mark.parametrize("values, background, dtype, wrong", [
    ([1, 300], 0, np.uint8, 300), ([1, -1], 0, np.uint64, -1), ([1, 1.5], 0, np.int32, 1.5),
    ([1, 2], np.nan, np.int16, np.nan), ([1, 2], -1.5, np.uint8, -1.5), ([1, 2], 0, bool, 2)])
def test_what_integers_do_not_hold_is_not_painted(labels, values, background, dtype, wrong):
    with pytest.raises(ValueError, match=f"^{wrong} does not fit {np.dtype(dtype)}$"):
        labels.paint(labels.ids[:2], values, background, dtype)
    assert labels.paint(labels.ids[:2], [1, 1], 0, dtype).max() == 1


def test_colors(labels, dense):
    ids, rgb = labels.colors()
    assert (ids == labels.ids).all() and rgb.shape == (len(ids), 3) and rgb.dtype == np.uint8
    look = {i: tuple(c) for i, c in zip(ids, rgb)}
    a, b = dense[1:], dense[:-1]
    touching = set(zip(a[(a != b) & (a > 0) & (b > 0)], b[(a != b) & (a > 0) & (b > 0)]))
    assert touching and all(look[i] != look[j] for i, j in touching)


def test_grains_are_chosen(labels, dense):
    some = labels.keep(labels.ids[:2])
    assert (np.asarray(some) == np.where(dense <= labels.ids[1], dense, 0)).all()
    assert list(labels.drop(labels.ids[:2]).ids) == list(labels.ids[2:])
    assert (np.asarray(labels.keep([])) == 0).all()
    with pytest.raises(madf.InvalidInput):
        labels.keep([999])
    half = labels.reduce(2)
    assert half.shape == tuple(n // 2 for n in labels.shape)
    assert half.spacing == tuple(2 * s for s in labels.spacing)


def test_grains_that_a_reduction_loses_are_said(tmp_path):
    small = np.zeros((8, 8, 8), np.int32)
    small[:4], small[6, 6, 6] = 1, 2
    labels = madf.Labels(small)
    for work in (lambda: labels.reduce(2), lambda: labels.save(tmp_path / "a.ply", reduce=2)):
        with pytest.warns(UserWarning, match="1 of 2 grains are too small to be seen"):
            work()


def test_places(sample, labels, array):
    assert labels.unit == "mm" and labels.spacing == (0.01,) * 3 and labels.origin == (0, 0, 0)
    assert labels.voxel_size == (1e-5,) * 3 and labels.first == (0, 0, 0)
    unknown = madf.Mask(array, phase=1)
    assert unknown.unit == "voxel" and unknown.spacing == (1, 1, 1) and unknown.voxel_size is None
    flat = madf.Mask(array, phase=1, voxel_size="1x2x3um")
    assert flat.voxel_size == (3e-6, 2e-6, 1e-6)
    assert flat.spacing == pytest.approx((3e-3, 2e-3, 1e-3))
    crop = madf.Mask(array, phase=1, crop=np.s_[8:40, :, 5:70])
    assert crop.first == (8, 0, 5) and crop.shape == (32, 72, 65) and crop.origin == (8, 0, 5)
    assert (np.asarray(crop) == array[8:40, :, 5:70]).all()


def test_a_mask_lies_within_its_domain(array):
    with pytest.raises(madf.InvalidInput, match="the object leaves the domain: object"):
        madf.Mask(array, phase=1, domain=np.s_[5:10, 5:10, 5:10])
    wide = madf.Mask(array, phase=1, domain=np.s_[0:100, 0:100, 0:100])
    assert wide.fraction == pytest.approx(array.sum() / 1e6)


def test_pickling(sample, labels, dense):
    again = pickle.loads(pickle.dumps(labels))
    assert (np.asarray(again) == dense).all() and again.metadata == labels.metadata
    mask = pickle.loads(pickle.dumps(sample[0]))
    assert (np.asarray(mask) == np.asarray(sample[0])).all() and mask.spacing == sample[0].spacing
    core = pickle.loads(pickle.dumps(madf.Mask(np.asarray(sample[0]), roi="cylinder")))
    assert core.fraction == madf.Mask(np.asarray(sample[0]), roi="cylinder").fraction


def grains_of(mask):
    return madf.segment(mask).labels


def test_pickling_to_another_process(sample, dense):
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        labels = pool.submit(grains_of, sample[0]).result(timeout=300)
    assert (np.asarray(labels) == dense).all()


def test_pictures(labels):
    png = labels._repr_png_()
    assert png.startswith(b"\x89PNG") and len(png) > 1000


def test_an_empty_volume():
    empty = madf.Labels(np.zeros((3, 4, 5), int))
    assert empty.shape == (3, 4, 5) and len(empty.ids) == 0 and (np.asarray(empty) == 0).all()
    assert len(empty.mesh().points) == 0
    seg = madf.segment(np.zeros((3, 4, 5), bool))
    assert seg.counts["grains"] == 0

def test_labels_of_labels(labels, dense):
    object_ = madf.Mask(labels, phase=[int(labels.ids[0]), int(labels.ids[2])])
    assert (np.asarray(object_) == np.isin(dense, labels.ids[[0, 2]])).all()
    assert object_.spacing == labels.spacing
    assert madf.Labels(dense, voxel_size="3um").spacing == (0.003,) * 3


def test_warnings_point_to_the_caller(array):
    for work in (lambda: madf.Mask(array, phase=1, roi="cylinder"),
                 lambda: madf.segment(array, phase=1, roi="cylinder")):
        with pytest.warns(UserWarning, match="fitted") as heard:
            work()
        assert {warning.filename for warning in heard} == {__file__}


def test_a_file_that_is_not_what_was_written_is_refused(tmp_path):
    path = tmp_path / "a.vdb"
    madf.Labels(np.ones((3, 4, 5), np.int32)).save(path)
    data = bytearray(path.read_bytes())
    data[data.index(b"madf_domain_max") + 5] ^= 1
    path.write_bytes(data)
    with pytest.raises(madf.IoError, match=r"is not what was written.*verify_files\(False\)"):
        madf.Labels(path)
    madf.verify_files(False)
    try:
        assert madf.Labels(path).ids.tolist() == [1]
    finally:
        madf.verify_files(True)


def test_metadata_of_other_encodings(array, command, tmp_path):
    name = tmp_path / os.fsdecode(b"\xb5.npy")
    np.save(name, array)
    command("segment", name, tmp_path / "l.vdb", "--phase", "1")
    assert madf.Labels(tmp_path / "l.vdb").metadata["madf_source"].endswith("\ufffd.npy")


def test_a_volume_made_of_one_keeps_place_and_region(array):
    mask = madf.Mask(array, phase=1, voxel_size="10um", roi="cylinder", crop=np.s_[8:40, :, 5:70])
    labels = madf.segment(mask).labels
    for volume, kind in ((mask, madf.Mask), (labels, madf.Labels)):
        copy = kind(volume, voxel_size="10um")
        assert copy.first == volume.first and copy.metadata == volume.metadata
        assert np.array_equal(copy, volume)
        with pytest.raises(ValueError, match="voxel_size='20um': the volume has"):
            kind(volume, voxel_size="20um")
    copied, measured = madf.measure(madf.Labels(labels)), madf.measure(labels)
    assert measured.sample["box"] == "region" and repr(copied.sample) == repr(measured.sample)
    for kind, other in ((lambda v: madf.Mask(v, invert=True), mask), (madf.Labels, mask),
                        (lambda v: madf.Mask(v, threshold=1), madf.Labels(array).reduce(2))):
        with pytest.warns(UserWarning, match="its place and its region are left behind"):
            kind(other)


def test_what_labels_keep_cannot_be_changed_from_outside(labels):
    with pytest.raises(ValueError, match="read-only"):
        labels.voxels.sort()
    with pytest.raises(ValueError, match="read-only"):
        labels.ids[0] = 7
    ids = set(labels.ids[:2])
    assert labels.drop(ids).ids.tolist() == sorted(set(labels.ids) - ids)


def test_a_volume_has_no_parts_to_name(labels):
    for kind, source in ((madf.Labels, labels), (madf.Mask, madf.Mask(labels, range=(1, 9)))):
        for part in ("grid", "dataset"):
            with pytest.raises(ValueError, match=f"{part}: names a part of a file"):
                kind(source, **{part: "manifold"})


def test_a_type_in_the_place_of_a_text_is_told(labels, tmp_path):
    with pytest.raises(TypeError, match="type=<class 'numpy.uint16'>: give a text"):
        labels.save(tmp_path / "t.tif", type=np.uint16)


def test_what_a_volume_leaves_behind_as_an_array_is_told(tmp_path):
    values = np.zeros((9, 10, 11), np.uint8)
    values[2:6, :, 3:] = 1
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 11 10 9\nspacings: 1 1 3\n"
              "encoding: raw\n\n")
    (tmp_path / "u.nrrd").write_bytes(header.encode() + values.tobytes())
    mask = madf.Mask(tmp_path / "u.nrrd", phase=1)
    with pytest.warns(UserWarning, match="the proportions of its voxels are left behind"):
        madf.Mask(mask, despeckle=5)
    closed = madf.segment(values, boundary="closed").labels
    with pytest.warns(UserWarning, match="its closed faces are left behind"):
        madf.Mask(closed, range=(1, 9))
