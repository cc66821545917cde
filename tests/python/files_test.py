# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes are those of the labels; files that are written are those of the command."""

import gc
import os
import subprocess
import warnings

import numpy as np
import pytest

import vdb_madf as madf


def test_mesh(labels, measured):
    mesh = labels.mesh(smoothing=0)
    assert (mesh.ids == labels.ids).all() and mesh.unit == "mm"
    assert np.allclose(mesh.volumes(), measured.grains["volume"], rtol=1e-5)
    smooth = labels.mesh()
    assert np.allclose(smooth.volumes(), measured.grains["volume"], rtol=5e-3)
    points, triangles = mesh.grain(int(mesh.ids[1]))
    assert triangles.max() == len(points) - 1 and triangles.min() == 0
    low = measured.grains["box_min_x"][1] * 0.01 - 0.005
    assert points[:, 0].min() == pytest.approx(low, abs=1e-6)
    one = labels.mesh(smoothing=0, ids=[int(mesh.ids[1])])
    assert len(labels.mesh(ids=labels.ids[:0]).ids) == 0
    assert (one.points == points).all() and (one.triangles == triangles).all()
    assert len(labels.mesh(smoothing=0, triangles=2000).triangles) <= 2000
    with pytest.raises(KeyError):
        mesh.grain(99999)


def test_arrays_of_a_mesh_are_its_memory(labels):
    mesh = labels.mesh(smoothing=0)
    assert not mesh.points.flags.owndata and mesh.points.base is mesh.triangles.base
    points, total = mesh.points, mesh.points.sum()
    del mesh
    gc.collect()
    [np.empty(10**6) for _ in range(5)]
    assert points.sum() == total


HDF5 = pytest.mark.skipif(not madf.reads_hdf5(), reason="HDF5: built without libhdf5-dev")

# What is written here, and how the command writes it.
FILES = [
    ("a.npy", {}, ["convert"]), ("a.tif", {}, ["convert"]), ("a.nrrd", {}, ["convert"]),
    ("a.mha", dict(type="uint16"), ["convert", "--out-type", "uint16"]),
    ("a.vdb", {}, ["convert", "--grid", "grain"]),
    ("a.ply", {}, ["export"]), ("a.vti", dict(compress=True), ["export", "--compress"]),
    ("a.obj", dict(reduce=2, smoothing=0), ["export", "--reduce", "2", "--smooth", "0"]),
    ("a.vtp", dict(kind="mesh", triangles=3000), ["export", "--as", "mesh", "--triangles", "3000"]),
    ("a.glb", {}, ["export"]),
    ("b.glb", dict(triangles=3000, smoothing=0),
     ["export", "--triangles", "3000", "--smooth", "0"]),
    pytest.param("a.h5", {}, ["convert"], marks=HDF5),
    pytest.param("m.hdf5", dict(kind="mask"), ["export", "--as", "mask"], marks=HDF5),
    ("a.graphml", {}, ["export"]), ("a.csv", dict(kind="network", min_faces=9),
                                    ["export", "--as", "network", "--min-faces", "9"]),
    ("n.txt", dict(kind="network"), ["export", "--as", "network"]),
    ("a.txt", dict(max_balls=20, apart=True),
     ["export", "--as", "clumps", "--balls", "20", "--apart"]),
    ("a.inp", {}, ["export"]), ("a.vtu", {}, ["export"]),
    ("p.vdb", dict(kind="preview", reduce=2), ["export", "--as", "viz", "--reduce", "2"]),
    ("s.vdb", dict(kind="surface"), ["export", "--as", "surface"]),
    ("g.vdb", dict(kind="level sets"), ["export", "--as", "grids"]),
    ("m.raw", dict(kind="mask"), ["export", "--as", "mask"]),
    ("a.png", dict(size=128, azimuth=60), ["render", "--size", "128", "--azimuth", "60"]),
]


@pytest.mark.parametrize("name, arguments, verb", FILES)
def test_files_are_those_of_the_command(name, arguments, verb, labels, tables, command, tmp_path):
    (tmp_path / "here").mkdir()
    (tmp_path / "there").mkdir()
    labels.save(tmp_path / "here" / name, **arguments)
    command(verb[0], tables / "labels.vdb", tmp_path / "there" / name, *verb[1:])
    assert (tmp_path / "here" / name).read_bytes() == (tmp_path / "there" / name).read_bytes()


@HDF5
def test_h5py_reads_labels_and_masks_while_others_are_written(labels, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "theirs.h5", "w") as theirs:
        theirs["labels"] = np.asarray(labels)
        labels.save(tmp_path / "ours.h5")
        assert (np.asarray(madf.Labels(tmp_path / "ours.h5")) == np.asarray(labels)).all()
        theirs["again"] = np.asarray(labels)
    with h5py.File(tmp_path / "ours.h5") as ours:
        assert (ours["data"][...] == np.asarray(labels)).all()
        edges = np.array(labels.spacing) * {"mm": 1e3, "um": 1}[labels.unit]
        assert np.allclose(ours["data"].attrs["element_size_um"], edges, rtol=1e-12)
    madf.Mask(np.asarray(labels) > 0).save(tmp_path / "mask.h5")
    with h5py.File(tmp_path / "mask.h5") as mask:
        assert (mask["data"][...] == (np.asarray(labels) > 0)).all()


@pytest.mark.parametrize("name, arguments, said", [
    ("a.tif", dict(reduce=2), "reduce=2: is for mesh and zarr and preview, not labels"),
    ("a.inp", dict(reduce=2), "reduce=2: is for"), ("a.vti", dict(smoothing=3), "smoothing=3: is"),
    ("a.csv", dict(kind="network", apart=True), "apart=True: is for clumps, not network"),
    ("a.zarr", dict(triangles=99), "triangles=99: is of the meshes of a .zarr: give meshes=True")])
def test_arguments_of_other_kinds_are_refused(labels, tmp_path, name, arguments, said):
    with pytest.raises(ValueError) as refused:
        labels.save(tmp_path / name, **arguments)
    assert str(refused.value).startswith(said)
    assert not list(tmp_path.iterdir())


def test_a_folder_of_meshes(labels, tmp_path):
    labels.save(tmp_path / "grains", kind="mesh")
    assert len(list((tmp_path / "grains").glob("grain_*.stl"))) == len(labels.ids)


def test_ome_zarr_is_that_of_the_command_and_is_read_back(labels, tables, command, tmp_path):
    for ome in ("0.4", "0.5", "0.6"):
        ours, theirs = (tmp_path / f"{place}{ome}.ome.zarr" for place in ("here", "there"))
        with_meshes = ome == "0.5"
        labels.save(ours, ome=ome, meshes=with_meshes, reduce=2 if with_meshes else 1)
        command("export", tables / "labels.vdb", theirs, "--ome", ome,
                *["--meshes", "--reduce", "2"] * with_meshes)
        files = sorted(path.relative_to(ours) for path in ours.rglob("*"))
        assert len(files) > 8 and files == sorted(path.relative_to(theirs)
                                                  for path in theirs.rglob("*"))
        for file in files:
            if file.name == "state.json":  # it has the name of the folder
                continue
            assert (ours / file).is_dir() or (ours / file).read_bytes() == (theirs
                                                                            / file).read_bytes()
        read = madf.Labels(ours, dataset="labels/grain")
        assert np.array_equal(read, labels) and read.spacing == labels.spacing
        with pytest.raises(madf.IoError, match="already"):
            labels.save(ours)


@pytest.mark.parametrize("arguments, options", [
    (dict(kind="sandatlas", smoothing=2), ["--as", "sandatlas", "--smooth", "2"]),
    (dict(kind="clumps", max_balls=5), ["--as", "clumps", "--balls", "5"]),
])
def test_folders_are_those_of_the_command(arguments, options, labels, tables, command, tmp_path):
    ours, theirs = tmp_path / "here" / "sand", tmp_path / "there" / "sand"
    ours.parent.mkdir()
    theirs.parent.mkdir()
    labels.save(ours, **arguments)
    command("export", tables / "labels.vdb", theirs, *options)
    files = sorted(path.relative_to(ours) for path in ours.rglob("*.*"))
    assert len(files) > 2 and files == sorted(path.relative_to(theirs)
                                              for path in theirs.rglob("*.*"))
    assert all((ours / file).read_bytes() == (theirs / file).read_bytes() for file in files)


@pytest.mark.parametrize("name, arguments, text", [
    ("a.zarr", dict(ome="0.3"), "0.4, 0.5 or 0.6"),
    ("a.docx", {}, "no format has the ending '.docx'"),
    ("a.csv", {}, "kind='network' or 'clumps'"),
    ("a.png", dict(kind="mesh"), "must be one of .ply"),
    ("a.vdb", dict(kind="fog"), "must be one of labels"),
    ("a.tif", dict(type="uint1"), "no sample type"),
    ("a.vdb", dict(type="uint8"), "type='uint8': .*a.vdb has no type"),
    ("a.vdb", dict(kind="mask", type="foo"), "type='foo': .*a.vdb has no type"),
    ("a.ply", dict(type="float32"), "type='float32': .*a.ply has no type"),
    ("nowhere/a.vdb", {}, "nowhere/a.vdb"),
])
def test_files_that_cannot_be_written(name, arguments, text, labels, tmp_path):
    with pytest.raises((madf.InvalidInput, madf.IoError), match=text):
        labels.save(tmp_path / name, **arguments)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a.csv", "a.data", "folder"])
def test_grains_without_a_ball_are_a_warning_as_the_command_says(name, tmp_path):
    """A voxel at the corner of a block has none."""
    array = np.zeros((9, 9, 30), np.int32)
    array[:, :, 2:28] = 1
    array[0, 0, 2] = 2
    labels = madf.Labels(array)
    labels.save(tmp_path / "labels.vdb")
    command = [os.environ["VDB_MADF_TOOL"], "export", tmp_path / "labels.vdb",
               tmp_path / f"there{name}", "--as", "clumps"]
    said = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    with pytest.warns(UserWarning) as heard:
        labels.save(tmp_path / f"here{name}", kind="clumps")
    text = str(heard[0].message)
    assert text.endswith("; 1 grain without a ball") and text.startswith(str(tmp_path / "here"))
    assert text.replace("here", "there") == said.strip()


def test_what_a_file_does_not_hold_is_a_warning(tmp_path):
    array = np.zeros((20, 20, 20), np.int32)
    array[5:15, 5:15, 5:15] = 1
    round_ = madf.segment(array, phase=1, voxel_size="1x1x2um",
                          roi=madf.Cylinder("z", (9.5, 9.5), 8)).labels
    for name, texts in [("a.tif", ["where the region ends", "begins at voxel 2,2,0"]),
                        ("a.npy", ["no cubes", "where the region ends", "begins at voxel 2,2,0"]),
                        ("a.nrrd", ["where the region ends"]), ("a.vti", ["where the region ends"]),
                        ("a.zarr", ["where the region ends", "begins at voxel 2,2,0"]),
                        ("a.vdb", [])]:
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            round_.save(tmp_path / name)
        said = [str(one.message) for one in heard]
        assert len(said) == len(texts), (name, said)
        assert all(text in line for text, line in zip(texts, said)), (name, said)
    closed = madf.segment(array, phase=1, voxel_size="2um", boundary="closed").labels
    for name in ("b.tif", "b.nrrd", "b.zarr"):
        with pytest.warns(UserWarning, match=f"{name}: does not say that the boundary is closed"):
            closed.save(tmp_path / name)
    with pytest.warns(UserWarning, match="center of its first voxel is at 0.0015,0.0015,0.0015 mm"):
        madf.Labels(array, voxel_size="1um").reduce(4).save(tmp_path / "c.tif")
    mask = madf.Mask(array, phase=1, crop=np.s_[2:9, 0:20, 0:20])
    with pytest.warns(UserWarning, match="begins at voxel 0,0,2"):
        mask.save(tmp_path / "m.tif")
