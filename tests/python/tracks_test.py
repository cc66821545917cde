# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""track() equals the command; what was done to labels is told."""

import csv
import warnings

import numpy as np
import pytest

import vdb_madf as madf


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
    there, back = madf.track_series([labels, moved, labels.drop([2])])
    assert there.labels.digest() == found.labels.digest() and back.shift == (-4, 6, -1)
    assert dict(zip(back.before["id"], back.before["fate"]))[2] == "vanished"
    assert set(back.labels.ids) < set(labels.ids)
    with pytest.raises(madf.InvalidInput, match="two or more"):
        madf.track_series([labels])


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


def balls(centers, shape, radius=6):
    """Balls about centers, the first having label 1."""
    array = np.zeros(shape, np.int32)
    places = np.moveaxis(np.indices(shape), 0, -1)
    for label, center in enumerate(centers, 1):
        array[((places - center) ** 2).sum(-1) <= radius ** 2] = label
    return array


def test_a_turned_sample_is_that_of_the_command(command, tmp_path):
    random, centers = np.random.default_rng(2), []
    while len(centers) < 40:
        center = random.random(3) * 44 + 13
        if all(np.linalg.norm(center - other) > 11.5 for other in centers):
            centers.append(center)
    motion = np.array([[0.9, 0, 0, 5], [0, 0.98, -0.2, 8], [0, 0.2, 0.98, -4]])  # z, y, x
    places = np.array(centers) @ motion[:, :3].T + motion[:, 3]
    before, after = balls(centers, (70,) * 3), balls(places[:-2], (80,) * 3)
    np.save(tmp_path / "a.npy", before)
    np.save(tmp_path / "b.npy", after)
    command("track", tmp_path / "a.npy", tmp_path / "b.npy", "--motion", "affine", "--grains",
            tmp_path / "grains.csv", "--bonds", tmp_path / "bonds.csv")
    tracks = madf.track(before, after, motion="affine")
    assert tracks.shift is None and np.abs(tracks.motion - motion)[:, :3].max() < 0.02
    for side, grains in (("before", tracks.before), ("after", tracks.after)):
        there = rows(tmp_path / "grains.csv", side)
        for name in ("fate", "track", "voxels", "partner"):
            assert [row[name] for row in there] == [str(value) for value in grains[name]]
        for name, values in (("confidence", grains["confidence"]),
                             ("displacement_y", grains["displacement"][:, 1]),
                             ("f_zx", grains["gradient"][:, 0, 2]),
                             ("strain_deviatoric", grains["strain_deviatoric"]),
                             ("rotation_z", grains["rotation"][:, 0])):
            assert np.allclose([float(row[name] or "nan") for row in there], values, rtol=1e-6,
                               equal_nan=True)
    assert [row["fate"] for row in rows(tmp_path / "bonds.csv", "before")] == list(
        tracks.bonds_before["fate"])
    assert list(tracks.before["partner"][:-2]) == list(tracks.after["id"])
    assert np.isnan(tracks.before["displacement"][-1]).all()
    moved = places[:-2] - centers[:-2]
    assert np.abs(tracks.before["displacement"][:-2] - moved).max() < 0.5
    guessed = madf.track(before, after, motion=motion)
    assert list(guessed.before["partner"]) == list(tracks.before["partner"])
    assert madf.track(before, after, motion="free").motion is None
    for wrong in ("fast", motion[:2], motion * np.nan):
        with pytest.raises(madf.InvalidInput, match="motion"):
            madf.track(before, after, motion=wrong)
    with pytest.raises(madf.InvalidInput, match="no motion is found"):
        madf.track(before, balls(random.random((30, 3)) * 44 + 13, (70,) * 3), motion="rigid")


def test_a_made_series_is_that_of_the_command(labels, command, tmp_path):
    labels.save(tmp_path / "a.vdb")
    command("generate", "evolve", tmp_path / "a.vdb", tmp_path / "made", "--steps", "2", "--strain",
            "0.1", "--turn", "8", "--axis", "1,2,3", "--drift", "1,0,-2", "--break", "0.3",
            "--break-gap", "1", "--vanish", "0.2", "--enter", "0.1", "--grow", "-1", "--noise",
            "0.3", "--seed", "5")
    made = madf.evolve(labels, steps=2, strain=0.1, turn=8, axis=(3, 2, 1), drift=(-2, 0, 1),
                       breaks=0.3, break_gap=1, vanish=0.2, enter=0.1, grow=-1, noise=0.3, seed=5)
    assert len(made) == 3
    for step, now in enumerate(made):
        there = madf.Labels(tmp_path / "made" / f"step-{step}.vdb")
        assert now.labels.digest() == there.digest()
        for table, names, name in ((now.grains, ("fate", "voxels"), "fates.csv"),
                                   (now.bonds, ("first", "second", "fate", "faces"), "bonds.csv")):
            mine = [row for row in rows(tmp_path / "made" / name) if row["step"] == str(step)]
            for column in names:
                assert [row[column] for row in mine] == [str(value) for value in table[column]]
        row = rows(tmp_path / "made" / "motion.csv")[step]
        assert np.isclose(now.motion[0, 2], float(row["f_zx"]), rtol=1e-6)
        assert np.isclose(now.motion[2, 3], float(row["shift_x"]), rtol=1e-6)
    _, broken = madf.evolve(labels, steps=1, breaks=1)
    assert set(broken.bonds["fate"]) == {"broken"} and not broken.bonds["faces"].any()
    with pytest.raises(madf.InvalidInput, match="strain"):
        madf.evolve(labels, strain=1)
