# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""track() equals the command; what was done to labels is told."""

import csv
import warnings

import numpy as np
import pytest

import vdb_madf as madf


@pytest.fixture(scope="module")
def labels(sample):
    return madf.segment(sample[0], keep=()).labels


def rows(path, side=None):
    with open(path) as file:
        return [row for row in csv.DictReader(file) if side is None or row["side"] == side]


def test_tracks_are_those_of_the_command(labels, command, tmp_path):
    later = madf.Labels(np.asarray(labels.merge([(1, 2)]).drop([4]))[3:, :, :-2], voxel_size="10um")
    labels.save(tmp_path / "a.vdb")
    later.save(tmp_path / "b.vdb")
    command("track", tmp_path / "a.vdb", tmp_path / "b.vdb", tmp_path / "there.vdb", "--min-faces",
            "3", "--grains", tmp_path / "grains.csv", "--bonds", tmp_path / "bonds.csv",
            "--links", tmp_path / "links.csv")
    tracks = madf.track(labels, later, min_faces=3)
    assert tracks.shift == (-3, 0, 0)
    assert tracks.labels.digest() == madf.Labels(tmp_path / "there.vdb").digest()
    for side, grains, bonds in (("before", tracks.before, tracks.bonds_before),
                                ("after", tracks.after, tracks.bonds_after)):
        there = rows(tmp_path / "grains.csv", side)
        assert [row["grain"] for row in there] == [str(i) for i in grains["id"]]
        for name in ("fate", "track", "voxels", "shared_voxels", "links", "partner",
                     "overlap_voxels"):
            assert [row[name] for row in there] == [str(value) for value in grains[name]]
        there = rows(tmp_path / "bonds.csv", side)
        for name in ("first", "second", "faces", "shared_faces", "fate"):
            assert [row[name] for row in there] == [str(value) for value in bonds[name]]
    there = rows(tmp_path / "links.csv")
    for name in ("before", "after", "voxels"):
        assert [row[name] for row in there] == [str(value) for value in tracks.overlaps[name]]
    assert [row["link"] == "1" for row in there] == list(tracks.overlaps["link"])


def test_what_was_done_is_told(labels):
    tracks = madf.track(labels, labels.merge([(1, 2)]).drop([4]).relabel())
    fates = dict(zip(tracks.before["id"], tracks.before["fate"]))
    assert fates.pop(1) == fates.pop(2) == "merged" and fates.pop(4) == "vanished"
    assert set(fates.values()) == {"kept"}
    larger = 1 + int(labels.voxels[1] > labels.voxels[0])  # of the two has the number
    assert np.array_equal(tracks.labels, labels.merge([(larger, 3 - larger)]).drop([4]))
    assert tracks.common_voxels == tracks.voxels_after < tracks.voxels_before
    kept = set(tracks.labels.ids)
    for first, second, fate in zip(*(tracks.bonds_before[name]
                                     for name in ("first", "second", "fate"))):
        assert fate == ("inside" if {first, second} == {1, 2} else
                        "kept" if {first, second} <= kept | {1, 2} else "unmatched")


def test_a_series_and_a_given_shift(labels):
    array = np.asarray(labels)
    moved = np.zeros_like(array)
    moved[4:, :-6, 1:] = array[:-4, 6:, :-1]
    found = madf.track(array, moved)
    assert found.shift == (4, -6, 1)
    assert madf.track(labels, moved, shift=(4, -6, 1)).labels.digest() == found.labels.digest()
    assert madf.track(found.labels, array, shift=(-4, 6, -1)).shift == (-4, 6, -1)
    assert madf.track(array, moved, max_shift=0).shift == (0, 0, 0)


def test_unrelated_samples_are_said_to_be(labels):
    other = madf.generate("sintered", size=labels.shape, count=9, radius=(8, 13), seed=7)[1]
    with pytest.warns(UserWarning, match="after: has .* of unrelated samples: .*max_shift"):
        madf.track(labels, other)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        madf.track(labels, labels.merge([(1, 2)]))
    with pytest.raises(ValueError, match="no labeled voxel comes to lie on one of before"):
        madf.track(labels, other, shift=(900, 0, 0))


def test_wrong_arguments_are_refused(labels):
    for wrong in (dict(share=0), dict(share=1.5), dict(max_shift=-1), dict(max_shift=1000),
                  dict(min_faces=-1)):
        with pytest.raises(madf.InvalidInput):
            madf.track(labels, labels, **wrong)
