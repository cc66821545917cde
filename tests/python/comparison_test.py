# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Comparisons mean what the manual says, and say what is not alike."""

import warnings

import numpy as np
import pytest

import vdb_madf as madf


def test_comparison(sample, labels):
    truth = sample[1]
    found = madf.compare(truth, np.asarray(labels))
    again = madf.compare(truth, madf.segment(sample[0]))
    assert again.adjusted_rand_index == found.adjusted_rand_index
    a, b = np.asarray(truth), np.asarray(labels)
    assert found.truth_grains == len(truth.ids) and found.common_voxels == ((a > 0) & (b > 0)).sum()
    pairs, counts = np.unique(np.stack([a[a > 0], b[a > 0]]), axis=1, return_counts=True)
    assert (found.overlaps["truth"] == pairs[0]).all() and (
        found.overlaps["voxels"] == counts).all()
    same = madf.compare(labels, labels)
    assert same.adjusted_rand_index == 1 and same.misclassified_percent == 0


def test_what_is_said_of_a_comparison(labels):
    dense = np.asarray(labels)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        madf.compare(labels, labels)
        madf.compare(labels, dense)
    with pytest.warns(UserWarning, match="the domains differ") as heard:
        madf.compare(labels, labels[1:])
    assert any("differ in topology" in str(warning.message) for warning in heard)
    assert {warning.filename for warning in heard} == {__file__}
    for work in (madf.compare, madf.track):
        with pytest.raises(ValueError, match="its voxels are 2 times as long as those of"):
            work(labels, madf.Labels(dense, voxel_size="20um"))
    with pytest.raises(ValueError, match="test: no voxel is labeled both here and in truth"):
        madf.compare(labels, np.zeros_like(dense))
