# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""generate() makes what it is asked for; wrong options are refused."""

import numpy as np
import pytest

import vdb_madf as madf


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
