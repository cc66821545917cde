# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Layers of napari are tuples that lie where the grains are; the manifest names their reader."""

import importlib
import pathlib
import re

import numpy as np
import pytest

import vdb_madf as madf

PACKAGE = pathlib.Path(madf.__file__).parent


@pytest.fixture(scope="module")
def labels():
    """Two grains that touch, and one alone; voxels of 10 x 20 x 30 um along x, y, z."""
    array = np.zeros((6, 7, 8), np.int32)
    array[1:3, 2:4, 1:3] = 5
    array[1:3, 2:4, 3:5] = 9
    array[4, 5, 6] = 70000
    return madf.Labels(array, voxel_size="10x20x30um")


def test_layers(labels):
    (grains, of_grains, kind), (bonds, of_bonds, other) = madf.to_napari(labels)
    assert (kind, other) == ("labels", "vectors")
    assert grains.dtype.kind == "i" and (grains == labels.to_array()).all()
    assert of_grains["scale"] == pytest.approx((0.03, 0.02, 0.01))
    assert of_grains["translate"] == pytest.approx((0, 0, 0))
    features = of_grains["features"]
    assert features["index"].tolist() == [5, 9, 70000]
    assert features["voxels"].tolist() == [8, 8, 1]
    assert {len(column) for column in features.values()} == {3}
    assert of_grains["metadata"]["unit"] == "mm"
    assert of_grains["metadata"]["units"]["volume"] == "mm^3"
    # (N, 2, 3): the start, and the way to the other end, where the layer of labels shows them.
    assert bonds.shape == (1, 2, 3)
    index = (bonds[0, 0] - of_grains["translate"]) / of_grains["scale"]
    assert index == pytest.approx([1.5, 2.5, 1.5])
    assert bonds[0, 1] == pytest.approx([0, 0, 0.02])
    assert (of_bonds["features"]["first"][0], of_bonds["features"]["second"][0]) == (5, 9)
    assert "scale" not in of_bonds and of_bonds["edge_width"] > 0


def test_unequal_voxels_of_unknown_size(tmp_path):
    """A header of NIfTI may have edges without a unit."""
    nibabel = pytest.importorskip("nibabel", reason="NIfTI: not installed")
    array = np.zeros((12, 10, 8), np.int16)
    array[1:5, 2:6, 1:5], array[5:9, 2:6, 1:5] = 1, 2
    image = nibabel.Nifti1Image(array, np.diag([0.4, 0.4, 0.6, 1]))
    image.header.set_xyzt_units(0, 0)
    nibabel.save(image, tmp_path / "a.nii")
    labels = madf.Labels(tmp_path / "a.nii")
    assert labels.unit == "voxel" and labels.spacing == pytest.approx((0.6, 0.4, 0.4))
    (_, of_grains, _), (bonds, _, _) = madf.to_napari(labels)
    assert bonds[0, 0] == pytest.approx([2.5 * 0.6, 3.5 * 0.4, 2.5 * 0.4])
    assert of_grains["scale"] == labels.spacing


def test_reduced_labels_and_bonds_lie_on_each_other():
    array = np.zeros((40, 40, 40), np.int32)
    array[4:16, 8:24, 4:20], array[4:16, 8:24, 20:36] = 1, 2
    reduced = madf.Labels(array, voxel_size="2um").reduce(4)
    (_, of_grains, _), (bonds, _, _) = madf.to_napari(reduced)
    assert of_grains["translate"] == pytest.approx((0.003, 0.003, 0.003))
    assert bonds[0, 0] == pytest.approx(np.multiply(0.002, (9.5, 15.5, 11.5)))


def test_labels_and_bonds_of_a_crop_lie_on_each_other(tmp_path):
    """Also where it is reduced, and as the plug-in reads it."""
    array = np.zeros((40, 40, 40), np.uint8)
    array[4:16, 8:24, 4:20], array[4:16, 8:24, 20:36] = 1, 1
    crop = np.s_[4:36, 4:36, 3:39]
    array[4:16, 8:24, 20] = 0
    array[9:11, 14:18, 20] = 1
    whole = madf.segment(array, phase=1, voxel_size="2x2x3um", crop=crop).labels
    get_reader = importlib.import_module("vdb_madf._napari").get_reader
    for labels in (whole, whole.reduce(2)):
        path = str(tmp_path / "crop.vdb")
        labels.save(path)
        for layers in (madf.to_napari(labels), get_reader(path)(path)):
            (grains, of_grains, _), (bonds, of_bonds, _) = layers
            assert any(labels.first) and len(bonds) == 1
            first = of_bonds["features"]["first"][0]
            center = np.argwhere(grains == first).mean(axis=0)
            assert bonds[0, 0] == pytest.approx(
                center * of_grains["scale"] + of_grains["translate"])


def test_measured_and_empty(labels):
    measured = madf.measure(labels, shape=True)
    (_, arguments, _), _ = madf.to_napari(labels, measured, name="sample")
    assert arguments["name"] == "sample" and "feret_max" in arguments["features"]
    (_, arguments, _), (bonds, _, _) = madf.to_napari(np.zeros((3, 4, 5), np.int32))
    assert len(arguments["features"]["index"]) == 0 and bonds.shape == (0, 2, 3)


def test_bonds_lie_where_the_labels_are(labels):
    """Whatever the unit of the measures is; those of other labels or voxels are refused."""
    _, (bonds, _, _) = madf.to_napari(labels)
    (_, arguments, _), (same, _, _) = madf.to_napari(labels, madf.measure(labels, unit="um"))
    assert same == pytest.approx(bonds) and arguments["metadata"]["unit"] == "um"
    array = labels.to_array()
    with pytest.raises(ValueError, match="of other labels"):
        madf.to_napari(labels, madf.measure(np.where(array == 5, 6, array)))
    for edge in ("20x20x30um", None):
        with pytest.raises(ValueError, match="voxels of another size"):
            madf.to_napari(labels, madf.measure(array, voxel_size=edge))
    voxels = madf.Labels(array)
    _, (bonds, _, _) = madf.to_napari(voxels, madf.measure(voxels))
    assert bonds[0, 1] == pytest.approx([0, 0, 2])
    with pytest.raises(ValueError, match="voxels of another size"):
        madf.to_napari(voxels, madf.measure(labels))


def test_manifest(labels, tmp_path):
    """The fields that npe2 wants, by its reference; what it names is there, and reads."""
    yaml = pytest.importorskip("yaml", reason="the manifest of napari: python3-yaml is missing")
    manifest = yaml.safe_load((PACKAGE / "napari.yaml").read_text())
    project = (PACKAGE.resolve() / "__init__.py").resolve().parents[1] / "pyproject.toml"
    if project.exists():  # not beside an installed package
        assert re.search(rf'"napari.manifest"\]\n{manifest["name"]} = "vdb_madf:napari.yaml"',
                         project.read_text())
    assert re.fullmatch(r"[A-Za-z0-9][\w.-]*[A-Za-z0-9]", manifest["name"])
    assert 3 <= len(manifest["display_name"]) <= 90
    assert set(manifest) <= {"name", "display_name", "schema_version", "contributions"}
    command, = manifest["contributions"]["commands"]
    assert set(command) == {"id", "title", "python_name"}
    assert command["id"].startswith(manifest["name"] + ".")
    reader, = manifest["contributions"]["readers"]
    assert reader["command"] == command["id"]
    assert set(reader) == {"command", "filename_patterns", "accepts_directories"}
    module, function = command["python_name"].split(":")
    get_reader = getattr(importlib.import_module(module), function)
    for pattern in reader["filename_patterns"]:
        assert get_reader(pattern.replace("*", "sample")) is not None
    assert get_reader("sample.png") is None and get_reader([]) is None

    path = str(tmp_path / "sample.vdb")
    labels.save(path)
    for given, count in ((path, 1), ([path, path], 2)):
        layers = get_reader(given)(given)
        assert [kind for _, _, kind in layers] == ["labels", "vectors"] * count
        assert layers[0][1]["name"] == "sample"


def test_plugin_engine(labels, tmp_path):
    """The engine that napari reads by takes the manifest, and finds the layers by the ending."""
    npe2 = pytest.importorskip("npe2", reason="napari's plug-in engine: python3-npe2 is missing")
    manifest = npe2.PluginManifest.from_file(PACKAGE / "napari.yaml")
    manifest.validate_imports()
    manager = npe2.PluginManager.instance()
    if manifest.name not in {known.name for known in manager.iter_manifests()}:
        manager.register(manifest)
    path = str(tmp_path / "sample.vdb")
    labels.save(path)
    read = npe2.read([path], stack=False)
    assert [kind for _, _, kind in read] == ["labels", "vectors"]
    assert np.array_equal(read[0][0], madf.to_napari(labels)[0][0])
    with pytest.raises(ValueError, match="[Nn]o (compatible )?readers"):
        npe2.read([str(tmp_path / "sample.png")], stack=False)
