# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Edits of labels equal the command's and plain numpy; wrong ones are refused."""

import json

import numpy as np
import pytest

import vdb_madf as madf


@pytest.fixture(scope="module")
def seg(sample):
    return madf.segment(sample[0])


def test_edits_are_those_of_the_command(seg, command, tmp_path):
    seg.save(tmp_path / "all.vdb")
    command("edit", tmp_path / "all.vdb", tmp_path / "there.vdb", "--merge", "1,2", "--split", "3",
            "--min-voxels", "200", "--renumber")
    edited = seg.edit(["merge 1 2", "split 3", "min-voxels 200", "renumber"])
    edited.save(tmp_path / "here.vdb")
    there = madf.Labels(tmp_path / "there.vdb")
    assert np.array_equal(edited.labels, there)
    assert edited.labels.digest() == there.digest() != seg.labels.digest()
    assert edited.labels.metadata == there.metadata
    assert edited.counts["grains"] == len(there.ids)
    again = madf.Labels(tmp_path / "all.vdb").edit(
        "merge 1 2\nsplit 3\nmin-voxels 200\nrenumber",
        manifold=madf.Labels(tmp_path / "all.vdb", grid="manifold"))
    assert again.digest() == there.digest()


def test_nothing_that_is_kept_has_no_counts(seg):
    none = seg.labels.keep([])
    assert len(none.ids) == 0 and none.shape == seg.labels.shape
    assert "madf_grains" in seg.labels.metadata and "madf_grains" not in none.metadata
    assert seg.labels.drop(seg.labels.ids).metadata == none.metadata


def test_counts_are_those_of_the_edited_labels(seg):
    merged, dropped = seg.edit("merge 1 2"), seg.edit("drop 1")
    assert merged.counts["object_voxels"] == seg.counts["object_voxels"]
    assert merged.counts["medial_balls"] == seg.counts["medial_balls"]
    assert "crumbs" in seg.counts and "crumbs" not in merged.counts
    assert dropped.counts["object_voxels"] == dropped.labels.voxels.sum()
    assert set(dropped.counts) == {"grains", "object_voxels", "leaves"}
    again = dropped.remerge()  # of the manifolds, which stay
    assert again.counts == {name: seg.counts[name] for name in again.counts}
    assert set(again.counts) == set(merged.counts)


def test_a_split_undoes_a_merge(seg):
    merged = seg.edit("merge 4 1 2")
    assert merged.counts["grains"] == seg.counts["grains"] - 2
    assert np.array_equal(merged.edit("split 4").labels, seg.labels)
    parts = seg.edit("split 1")
    new, = np.setdiff1d(parts.labels.ids, seg.labels.ids)
    assert np.array_equal(parts.labels.merge([(1, new)]), seg.labels)


def test_edits_equal_numpy(seg):
    labels, array = seg.labels, np.asarray(seg.labels)
    for groups in ([(2, 1), [4, 3]], np.array([[2, 1], [4, 3]])):
        assert np.array_equal(labels.merge(groups),
                              np.where(array == 1, 2, np.where(array == 3, 4, array)))
    with pytest.raises(ValueError, match="99 is no grain of these labels"):
        labels.drop([2, 99])
    kept = labels.drop([2, 5])
    _, order = np.unique(np.asarray(kept), return_inverse=True)
    assert np.array_equal(kept.relabel(), order.reshape(array.shape))
    sizes = np.bincount(array.ravel())
    median = int(np.median(sizes[1:]))
    assert np.array_equal(labels.edit(f"max-voxels {median}"),
                          np.where(sizes[array] <= median, array, 0))
    joined = np.asarray(labels.edit("join-below 200"))
    assert set(np.unique(array)) - set(np.unique(joined)) <= set(np.flatnonzero(sizes < 200))
    assert np.array_equal(joined > 0, array > 0)
    edge = np.cbrt(6 * median / np.pi) * 10
    assert np.array_equal(labels.edit(f"max-diameter {edge + .001:.6f}um"),
                          labels.edit(f"max-voxels {median}"))
    inner = array[1:-1, 1:-1, 1:-1]
    outer = set(array.ravel()) - {label for label in set(inner.ravel())
                                  if np.count_nonzero(inner == label) == sizes[label]}
    assert np.array_equal(labels.edit("drop-at-faces"),
                          np.where(np.isin(array, list(outer)), 0, array))
    assert labels.edit([]).digest() == labels.digest()


def test_digests_are_those_of_the_tables(seg, command, tmp_path):
    seg.labels.save(tmp_path / "labels.vdb")
    command("measure", tmp_path / "labels.vdb", tmp_path / "tables")
    there = json.loads((tmp_path / "tables" / "sample.json").read_text())
    assert seg.labels.digest() == there["labels_digest"]
    array = np.asarray(seg.labels)
    assert madf.Labels(array.astype(np.uint16)).digest() == seg.labels.digest()
    assert madf.Labels(array[::-1]).digest() != seg.labels.digest()


def test_wrong_edits_are_refused(seg, sample):
    for edits, says in (("merge 1 99", "there is no grain 99"),
                        ("splot 3", "line 1: 'splot' is no edit"),
                        (["drop 1", "drop 1"], "there is no grain 1 any more, after 'drop 1'"),
                        ("merge 1 1", "named twice")):
        with pytest.raises(madf.InvalidInput, match=says):
            seg.edit(edits)
    with pytest.raises(madf.InvalidInput, match="no manifolds"):
        seg.labels.edit("split 1")
    with pytest.raises(madf.InvalidInput, match="carries no graph"):
        seg.labels.edit("split 1", manifold=seg.labels)
    with pytest.raises(madf.InvalidInput, match="by which options"):
        sample[1].edit("split 1", manifold=seg.manifold)
