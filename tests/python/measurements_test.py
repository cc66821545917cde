# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Measures are those of the command."""

import csv
import json
import pickle

import numpy as np
import pytest

import vdb_madf as madf


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {name: np.array([float(row[i]) if row[i] else np.nan for row in rows[1:]])
            for i, name in enumerate(rows[0])}


SUFFIX = {"": "", "mm": "_mm", "mm^2": "_mm2", "mm^3": "_mm3", "1/mm": "_per_mm",
          "1/mm^2": "_per_mm2"}


@pytest.mark.parametrize("table", ["grains", "bonds"])
def test_tables_are_those_of_the_command(table, measured, tables):
    here, there = getattr(measured, table), columns(tables / f"{table}.csv")
    assert [name + SUFFIX[measured.units[name]] for name in here] == list(there)
    for name, values in here.items():
        assert np.allclose(values, there[name + SUFFIX[measured.units[name]]], rtol=1e-8, atol=0,
                           equal_nan=True), name


def test_types_of_columns(measured):
    assert measured.unit == "mm"
    kinds = {name: column.dtype for name, column in {**measured.grains, **measured.bonds}.items()}
    assert kinds["id"] == kinds["first"] == np.int32 and kinds["voxels"] == np.int64
    assert kinds["at_domain_face"] == bool and kinds["box_min_x"] == np.int64
    assert kinds["volume"] == kinds["centroid_z"] == kinds["mean_curvature"] == np.float64


def test_the_sample(measured, tables):
    there = json.loads((tables / "sample.json").read_text())
    here = measured.sample
    for name in ("grains", "bonds", "object_voxels", "solid_fraction", "euler_characteristic",
                 "components", "mean_coordination", "labels_digest", "boundary", "box"):
        assert here[name] == there[name], name
    assert here["specific_surface"] == pytest.approx(there["specific_surface_per_mm"], rel=1e-12)
    assert here["correlation_length"][::-1] == pytest.approx(there["correlation_length_mm"])
    assert np.allclose(here["bond_fabric"][::-1, ::-1], there["bond_normal_fabric"]["tensor"])
    assert np.allclose(here["grain_fabric"][::-1, ::-1], there["grain_axis_fabric"]["tensor"])
    assert here["diameter_by_volume"][50] == pytest.approx(
        there["grain_diameter_by_volume_mm"]["d50"])
    assert list(here["coordinations"]) == there["coordination_distribution"]
    assert measured.provenance["madf_strictness"] == 11


@pytest.fixture(scope="module")
def scan(labels):
    return np.random.default_rng(3).integers(0, 60000, labels.shape).astype(np.uint16)


def test_stability(command, tmp_path):
    mask = madf.generate("snow", size=64, fraction=0.4, length=12)[0]
    seg = madf.segment(mask, strictness=12, tidy=0)
    seg.save(tmp_path / "all.vdb")
    measured = madf.measure(seg, stability=True)
    born, dies, stability = (measured.grains[name] for name in ("born", "dies", "stability"))
    assert len(born) > 20 and np.isfinite(born).any() and np.isfinite(dies).any()
    assert not (born < 12).any() and not (dies >= 12).any()
    assert np.array_equal(stability, np.fmin(born - 12, 12 - dies), equal_nan=True)
    place = measured.points("representative").astype(int)

    def voxels_at(strictness, z, y, x):
        labels = np.asarray(seg.cut(strictness).labels)
        return np.count_nonzero(labels == labels[z, y, x])

    step = 1 / 512
    for grain in np.flatnonzero(np.isfinite(dies))[:10]:
        voxels = measured.grains["voxels"][grain]
        assert voxels >= 0.98 * voxels_at(dies[grain] + step, *place[grain])
        assert voxels < 0.98 * voxels_at(dies[grain], *place[grain])
    vanishes = measured.bonds["vanishes"]
    assert len(vanishes) > 20 and (vanishes < 12).any()
    for bond in range(0, len(vanishes), 5):
        ends = [tuple(place[measured.bonds[end][bond] - 1]) for end in ("first", "second")]
        for strictness, are_one in ((vanishes[bond] + step, False), (vanishes[bond], True)):
            labels = np.asarray(seg.cut(strictness).labels)
            assert (labels[ends[0]] == labels[ends[1]]) == are_one

    command("segment", tmp_path / "all.vdb", tmp_path / "all.slabs", "--grid", "grain",
            "--strictness", "12", "--tidy", "0", "--keep", "manifold", "--slab-height", "24")
    for file in ("all.vdb", "all.slabs"):
        command("measure", tmp_path / file, tmp_path / "tables", "--stability", "--grid", "grain")
        grains, bonds = (columns(tmp_path / "tables" / f"{name}.csv")
                         for name in ("grains", "bonds"))
        for name in ("born", "dies", "stability"):
            assert np.allclose(grains[name], measured.grains[name], rtol=1e-8, equal_nan=True)
        assert np.allclose(bonds["vanishes"], vanishes, rtol=1e-8, equal_nan=True)
    assert not {"born", "dies", "stability"} & set(madf.measure(seg).grains)

    small = madf.segment(mask, min_grain=300)  # as without: its grains are some of those
    few, all_ = (madf.measure(s, stability=True).grains for s in (small, seg.cut(11)))
    assert len(few["id"]) < len(all_["id"]) and set(few["dies"][:3]) <= set(all_["dies"])
    with pytest.raises(madf.InvalidInput, match="give the Segmentation itself"):
        madf.measure(seg.labels, stability=True)
    with pytest.raises(madf.InvalidInput, match="manifolds were not kept"):
        madf.measure(madf.segment(mask, keep=()), stability=True)
    with pytest.raises(madf.InvalidInput, match="of grains merged by score"):
        madf.measure(seg.remerge(merge="both"), stability=True)
    with pytest.raises(madf.InvalidInput, match="and these were edited"):
        madf.measure(seg.edit("merge 1 2"), stability=True)


def test_what_is_there_on_demand(labels, scan, command, tmp_path):
    everything = dict(shape=True, edge_weights=True, crossing=True, voronoi=True, bootstrap=200)
    np.save(tmp_path / "scan.npy", scan)
    labels.save(tmp_path / "labels.vdb")
    command("measure", tmp_path / "labels.vdb", tmp_path / "out", "--shape", "--edge-weights",
            "--crossing", "--voronoi", "--bootstrap", "200", "--intensity", tmp_path / "scan.npy")
    there = json.loads((tmp_path / "out" / "sample.json").read_text())
    for source in (scan, str(tmp_path / "scan.npy")):
        here = madf.measure(labels, intensity=source, **everything)
        for table in ("grains", "bonds"):
            columns_there = columns(tmp_path / "out" / f"{table}.csv")
            for (name, values), expected in zip(getattr(here, table).items(),
                                                columns_there.values()):
                assert np.allclose(values, expected, rtol=1e-8, atol=0, equal_nan=True), name
            assert len(getattr(here, table)) == len(columns_there)
    assert here.grains["zingg_class"].dtype == here.grains["gray_voxels"].dtype == np.int64
    assert here.units["convex_volume"] == "mm^3" and here.units["gray_mean"] == ""
    assert here.bonds["cut_x"].dtype == here.grains["at_domain_face"].dtype == bool
    for name, key in (("corrected_grain_diameter_mean", "corrected_grain_diameter_mean_mm"),
                      ("grain_volume_mean", "grain_volume_mean_mm3"),
                      ("grains_at_faces", "grains_at_faces"),
                      ("corrected_grains", "corrected_grains"),
                      ("corrected_mean_coordination", "corrected_mean_coordination")):
        assert here.sample[name] == pytest.approx(there[key], rel=1e-12), name
    assert list(here.sample["corrected_diameter_by_volume"].values()) == pytest.approx(
        list(there["corrected_grain_diameter_by_volume_mm"].values()))
    for name, unit in (("minimum_cut_area", "_mm2"), ("minimum_cut_share", ""),
                       ("minimum_cut_bonds", ""), ("bond_conductivity", "")):
        assert here.sample[name] == pytest.approx(
            [there[f"{name}_{axis}{unit}"] for axis in "zyx"], rel=1e-12), name
    for name, interval in here.sample["intervals"].items():
        key = next(key for key in there if key.startswith(f"{name}_interval"))
        assert interval == pytest.approx(there[key], rel=1e-12), name
    assert here.units["specific_surface"] == "1/mm" and len(here.sample["intervals"]) == 8
    inside = np.asarray(labels) == here.grains["id"][0]
    assert here.grains["gray_mean"][0] == pytest.approx(scan[inside].mean())
    assert here.grains["gray_median"][0] == np.median(scan[inside])
    here.to_pandas()


def test_size_curves(labels, command, tmp_path):
    reference = tmp_path / "sieves.csv"
    reference.write_text("size_um,percent_passing\n300,10\n400,50\n500,80\n")
    labels.save(tmp_path / "labels.vdb")
    command("measure", tmp_path / "labels.vdb", tmp_path / "out", "--size-curve",
            tmp_path / "curve.csv", "--size-reference", reference)
    there = json.loads((tmp_path / "out" / "sample.json").read_text())["size_curve_rms_percent"]
    here = madf.measure(labels, size_curve=True, size_reference=str(reference))
    assert here.sample["size_curve_rms_percent"] == pytest.approx(there, rel=1e-12)
    assert len(there) == 4 and min(there.values()) > 0
    curve = here.sample["size_curve"]
    for (name, values), expected in zip(curve.items(), columns(tmp_path / "curve.csv").values()):
        assert np.allclose(values, expected, rtol=1e-8, atol=0), name
    diameters = np.sort(here.grains["equivalent_diameter"])
    share = np.cumsum(diameters**3) / np.sum(diameters**3)
    assert curve["equivalent_diameter"][50] == diameters[np.searchsorted(share, 0.5)]
    reference.write_text("size_um,percent_passing\n300,x\n")
    with pytest.raises(ValueError, match="sieves.csv: '300,x': is no size"):
        madf.measure(labels, size_reference=str(reference))


def test_binder(labels, command, tmp_path):
    inside = np.asarray(labels) > 0
    map = np.where(inside, 2, 1).astype(np.uint8)
    map[:20] = 0  # binder fills the upper pores
    np.save(tmp_path / "map.npy", map)
    labels.save(tmp_path / "labels.vdb")
    command("measure", tmp_path / "labels.vdb", tmp_path / "out", "--phases", tmp_path / "map.npy",
            "--bridges", tmp_path / "bridges.csv")
    there = columns(tmp_path / "bridges.csv")
    for source in (map, str(tmp_path / "map.npy")):
        here = madf.measure(labels, phases=source)
        assert len(here.bridges) == len(there) and len(here.bridges["first"]) > 3
        for (name, values), expected in zip(here.bridges.items(), there.values()):
            assert np.allclose(values, expected, rtol=1e-8, atol=0), name
    assert here.bridges["volume"].sum() + here.sample["binder_loose_volume"] == pytest.approx(
        here.sample["binder_volume"])
    assert madf.measure(labels, phases=map, binder=7).sample["binder_volume"] == 0
    with pytest.raises(ValueError, match="binder is a value in the map of phases"):
        madf.measure(labels, binder=2)
    with pytest.raises(ValueError, match="the phases have 79x72x64 voxels"):
        madf.measure(labels, phases=map[:, :, 1:])


def test_what_cannot_be_had_on_demand(labels, measured, scan):
    assert "feret_max" not in measured.grains and "gray_mean" not in measured.bonds
    assert "intervals" not in measured.sample and "edge_weight" not in measured.grains
    with pytest.raises(ValueError, match="has 79x72x64 voxels, and the labels are those of a scan "
                       "of 80x"):
        madf.measure(labels, intensity=scan[:, :, 1:])
    with pytest.raises(ValueError, match="from 100 to 100000"):
        madf.measure(labels, bootstrap=7)
    with pytest.raises(ValueError, match="boundary is closed"):
        madf.measure(labels, boundary="closed", edge_weights=True)
    with pytest.raises(OSError, match="nowhere.tif"):
        madf.measure(labels, intensity="nowhere.tif")
    lazy = [False]

    class Slabs:
        shape, dtype = scan.shape, scan.dtype

        def __getitem__(self, key):
            assert key.stop - key.start <= 8
            lazy[0] = True
            return scan[key]

    again = madf.measure(labels, intensity=Slabs())
    assert lazy[0] and again.grains["gray_voxels"].sum() == measured.grains["voxels"].sum()


def test_pandas(measured):
    pd = pytest.importorskip("pandas", reason="tables of pandas: not installed")
    grains, bonds = measured.to_pandas()
    assert isinstance(grains, pd.DataFrame) and list(grains.index) == list(measured.grains["id"])
    assert grains.attrs["unit"] == "mm" and grains.attrs["units"]["volume"] == "mm^3"
    assert grains.attrs["provenance"] == measured.provenance
    assert (bonds["area"] == measured.bonds["area"]).all()


def test_what_the_command_notes_is_a_warning():
    array = np.zeros((40, 40, 40), np.int32)
    array[4:16, 8:24, 4:20], array[4:16, 8:24, 20:36] = 1, 2
    labels = madf.Labels(array, voxel_size="2um")
    with pytest.warns(UserWarning, match="places in the tables count from voxel 0,0,0"):
        madf.measure(labels.reduce(4))
    with pytest.warns(UserWarning, match="1 grain: is this a mask"):
        madf.measure(array > 0)


def test_points(measured):
    centers = measured.points()
    assert (centers[:, 0] == measured.grains["centroid_z"]).all() and centers.shape[1] == 3
    normals = measured.points("normal", of="bonds")
    assert np.allclose((normals**2).sum(1), 1)


def test_unit(labels, measured):
    small = madf.measure(labels, unit="um")
    assert small.unit == "um" and small.units["area"] == "um^2"
    assert np.allclose(small.grains["volume"], 1e9 * measured.grains["volume"], rtol=1e-12)
    assert np.isclose(small.sample["specific_surface"], measured.sample["specific_surface"] / 1e3)
    with pytest.raises(madf.InvalidInput, match="the unit of length cm: must be mm or um"):
        madf.measure(labels, unit="cm")
    with pytest.raises(madf.InvalidInput, match="the voxel size is unknown"):
        madf.measure(np.asarray(labels).astype(np.uint16), unit="um")


def test_measures_of_foreign_labels(labels, measured):
    again = madf.measure(np.asarray(labels).astype(np.uint16), voxel_size="10um")
    for name, column in measured.grains.items():
        assert np.array_equal(column, again.grains[name], equal_nan=column.dtype == float), name
    assert again.sample["labels_digest"] == measured.sample["labels_digest"]
    with pytest.raises(TypeError, match="voxel_size: for files and arrays"):
        madf.measure(labels, voxel_size="10um")
    with pytest.raises(ValueError, match="gray image"):
        madf.measure(np.random.default_rng(5).integers(0, 60000, (20, 20, 20)))
    pickle.loads(pickle.dumps(measured))


def test_necks_in_a_gray_scan(command, tmp_path):
    z, y, x = np.indices((40, 40, 64), np.float64)
    sharp = np.max([np.clip(10.5 - np.sqrt((z - 19.6) ** 2 + (y - 20.2) ** 2 + (x - c) ** 2), 0, 1)
                    for c in (22.4, 40.4)], axis=0)  # 18 apart: a neck of radius 4.36
    gray = sharp.copy()
    for axis in range(3):  # a blur of variance 1/2 along each axis
        gray = (np.roll(gray, 1, axis) + 2 * gray + np.roll(gray, -1, axis)) / 4
    gray += np.random.default_rng(1).normal(0, 0.03, gray.shape)
    values = (1000 + 2000 * gray).astype(np.float32)
    labels = madf.segment(values, threshold=2000.0, voxel_size="10um").labels
    measured = madf.measure(labels, gray=values)
    assert len(measured.bonds["first"]) == 1 and measured.bonds["neck_confirmed"][0]
    assert measured.bonds["neck_confirmed"].dtype == bool  # chooses rows, and ~ turns it round
    truth = np.pi * (10 ** 2 - 9 ** 2) * 1e-4  # mm^2
    assert measured.bonds["neck_area"][0] == pytest.approx(truth, rel=0.08)
    assert measured.bonds["area"][0] > 1.2 * truth
    assert measured.units["neck_area"] == "mm^2" and measured.units["scan_blur"] == "mm"
    assert measured.sample["scan_blur"] == pytest.approx(np.sqrt(0.5 + 1 / 12) * 0.01, rel=0.05)
    assert measured.sample["scan_noise_of_contrast"] == pytest.approx(0.03, rel=0.05)
    np.save(tmp_path / "scan.npy", values)
    labels.save(tmp_path / "labels.vdb")
    command("measure", tmp_path / "labels.vdb", tmp_path / "out", "--gray", tmp_path / "scan.npy")
    there = columns(tmp_path / "out" / "bonds.csv")
    assert there["neck_area_mm2"] == pytest.approx(measured.bonds["neck_area"], rel=1e-8)
    sample = json.loads((tmp_path / "out" / "sample.json").read_text())
    for name in ("necks_confirmed", "scan_gray_inside", "scan_gray_outside"):
        assert measured.sample[name] == sample[name]
    for name in ("neck_area_mm2", "contact_gap_mm"):
        assert measured.sample[name[:name.rindex("_")]] == pytest.approx(sample[name])
    assert sample["necks_confirmed"] == 1
    assert sample["scan_blur_mm"] == pytest.approx(measured.sample["scan_blur"])
    again = madf.measure(labels, gray=values, sensitivity=5, vary={"gamma": 0})
    assert again.bonds["p_bond"][0] == 1 and again.units["area_sd"] == "mm^2"
    assert again.sample["sensitivity"]["gamma"] == (1, 1)
    command("measure", tmp_path / "labels.vdb", tmp_path / "again", "--gray", tmp_path / "scan.npy",
            "--sensitivity", "5", "--vary", "gamma:0")
    assert columns(tmp_path / "again" / "bonds.csv")["area_sd_mm2"] == pytest.approx(
        again.bonds["area_sd"], rel=1e-8)
    for arguments in (dict(sensitivity=5), dict(gray=values, vary={"gamma": 0}),
                      dict(gray=values, sensitivity=5, vary={"fog": 1}),
                      dict(gray=values, sensitivity=4)):
        with pytest.raises(ValueError, match="gray|sensitivity|fog"):
            madf.measure(labels, **arguments)
    with pytest.raises(ValueError, match="its edges tell no blur"):
        madf.measure(labels, gray=(values > 2000).astype(np.uint8))
    part = np.asarray(labels)[:30, :30, :40].copy()  # does not say where in the scan it lies
    for arguments in (dict(gray=values), dict(phases=(values > 2000).astype(np.uint8))):
        with pytest.raises(ValueError, match="do not say where in it they were cropped"):
            madf.measure(part, **arguments)
    noise = np.random.default_rng(2).integers(0, 4000, (20, 20, 20)).astype(np.uint16)
    labels = madf.segment(noise, threshold=2000.0).labels
    with pytest.warns(UserWarning, match="tell no blur: necks are not measured"):
        madf.measure(labels, gray=noise, sensitivity=5)


def test_where_a_grain_reaches_across_nothing_is_cut():
    halves = np.ones((12, 12, 12), np.int32)
    halves[:6] = 2
    sample = madf.measure(halves, crossing=True).sample
    assert sample["minimum_cut_bonds"][0] == 1
    for name in ("minimum_cut_bonds", "minimum_cut_area", "minimum_cut_share"):
        assert np.isnan(sample[name][1:]).all(), name
