# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Labels of arrays of every kind are those of the command, byte for byte."""

import itertools
import mmap
import subprocess
import sys

import numpy as np
import pytest

import vdb_madf as madf

# Selections that tell samples whose bytes are swapped.
PHASE = {"phase": 1}


def strided(array):
    wide = np.zeros([2 * n for n in array.shape], np.int16)
    wide[::2, 1::2, ::2] = array
    return wide[::2, 1::2, ::2]


def turned(array):
    return np.ascontiguousarray(array[::-1, :, ::-1])[::-1, :, ::-1]


KINDS = {
    "C order": lambda a: a,
    "Fortran order": np.asfortranarray,
    "transposed": lambda a: np.ascontiguousarray(a.T).T,
    "strided": strided,
    "negative strides": turned,
    "bool": lambda a: a.astype(bool),
    "a list": lambda a: a.tolist(),
    **{t: (lambda a, t=t: a.astype(t)) for t in
       ("i1", ">i2", "<u2", ">u2", ">i4", "<u4", "<i8", ">i8", ">u8", "<f2", "<f4", ">f4", ">f8")},
}


@pytest.mark.parametrize("kind", KINDS)
def test_labels_are_those_of_the_command(kind, array, expected):
    volume = KINDS[kind](array)
    labels = np.asarray(madf.segment(volume, voxel_size="10um", **PHASE).labels)
    assert labels.dtype == np.int32 and labels.tobytes() == expected.tobytes()


def test_bool_needs_no_selection(array, expected):
    assert (np.asarray(madf.segment(array.astype(bool)).labels) == expected).all()
    assert (np.asarray(madf.segment(array == 0, invert=True).labels) == expected).all()


def test_memmap_and_its_file(array, expected, command, tmp_path):
    np.save(tmp_path / "scan.npy", array)
    volume = np.load(tmp_path / "scan.npy", mmap_mode="r")
    of_array = madf.segment(volume, voxel_size="10um", **PHASE).labels
    assert np.asarray(of_array).tobytes() == expected.tobytes()
    of_array.save(tmp_path / "array.vdb")
    madf.segment(tmp_path / "scan.npy", voxel_size="10um",
                 **PHASE).labels.save(tmp_path / "file.vdb")
    command("segment", tmp_path / "scan.npy", tmp_path / "command.vdb", "--phase", "1",
            "--voxel-size", "10um")
    of_command = (tmp_path / "command.vdb").read_bytes()
    assert (tmp_path / "array.vdb").read_bytes() == of_command
    assert (tmp_path / "file.vdb").read_bytes() == of_command


def test_a_memmap_does_not_become_memory(tmp_path):
    """Of 64 MiB, a slab at a time is there; changes that are nowhere else stay."""
    shape, slab = (64, 1024, 1024), 8 * 2**20
    np.lib.format.open_memmap(tmp_path / "scan.npy", "w+", np.uint8, shape).flush()
    script = (
        "import resource, numpy as np, vdb_madf as madf\n"
        "madf.Mask(np.ones((8, 8, 8), bool))\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "madf.Mask(np.load('scan.npy', mmap_mode='r'), phase=1)\n"
        "print(1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before))\n")
    run = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, stdout=subprocess.PIPE,
                         check=True)
    assert int(run.stdout) < 4 * slab
    changed = np.load(tmp_path / "scan.npy", mmap_mode="c")
    changed[40, 5, 6] = 1
    assert madf.Mask(changed[30:], phase=1).voxels == 1 and changed[40, 5, 6] == 1


@pytest.mark.parametrize("make", [
    lambda file, size: mmap.mmap(file.fileno(), size, access=mmap.ACCESS_COPY),
    lambda file, size: mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)])
def test_what_only_a_private_map_has_stays(make, array, tmp_path):
    np.zeros_like(array).tofile(tmp_path / "zeros.raw")
    with open(tmp_path / "zeros.raw", "r+b") as file:
        volume = np.ndarray(array.shape, np.uint8, make(file, array.nbytes))
    volume[:] = array
    assert np.array_equal(madf.Mask(volume, **PHASE), array) and np.array_equal(volume, array)
    changed = np.memmap(tmp_path / "zeros.raw", np.uint8, "c", shape=array.shape)
    changed[:] = array
    view = changed.view(np.ndarray)
    assert np.array_equal(madf.Mask(view, **PHASE), array) and np.array_equal(view, array)


def test_h5py(array, expected, tmp_path):
    h5py = pytest.importorskip("h5py", reason="arrays of h5py: not installed")
    with h5py.File(tmp_path / "scan.h5", "w") as file:
        chunked = file.create_dataset("scan", data=array, chunks=(5, 9, 11), compression="gzip")
        assert np.asarray(madf.segment(chunked, **PHASE).labels).tobytes() == expected.tobytes()


def test_edges_of_h5py(array, tmp_path):
    h5py = pytest.importorskip("h5py", reason="arrays of h5py: not installed")
    labels = madf.Labels((array > 0).astype(np.int32), voxel_size="1x2x3um")
    labels.save(tmp_path / "labels.h5")
    with h5py.File(tmp_path / "labels.h5") as file:
        assert madf.Labels(file["data"]).spacing == pytest.approx(labels.spacing)
    with h5py.File(tmp_path / "named.h5", "w") as file:
        data = file.create_dataset("data", data=np.asarray(labels).transpose())
        data.attrs["element_size_um"] = 1, 2, 3
        for axis, name in enumerate("xyz"):
            data.dims[axis].label = name
        again = madf.Labels(data)
        assert again.spacing == pytest.approx(labels.spacing) and again.digest() == labels.digest()
        data.attrs["element_size_um"] = 1, 0, 3
        assert madf.Labels(data).unit == "voxel"


def test_an_array_of_another_type_than_it_says():
    values = np.arange(27, dtype=np.float32).reshape(3, 3, 3)

    class Lies(Slabs):
        def __init__(self, array, dtype):
            super().__init__(array)
            self.dtype = np.dtype(dtype)

    assert madf.Mask(Lies(values, np.uint8), threshold=10).voxels == 17
    assert madf.Mask(Lies(values.astype(float) / 3, np.float32), threshold=3).voxels == 18
    for bad in (values - 1, values + 0.5, values + 240, values * np.nan):
        with pytest.raises(madf.InvalidInput, match="said to be of uint8, and gives .* float32"):
            madf.Mask(Lies(bad, np.uint8), threshold=10)


def test_zarr(array, expected, tmp_path):
    zarr = pytest.importorskip("zarr", reason="arrays of zarr: not installed")
    chunked = zarr.open(str(tmp_path / "scan.zarr"), mode="w", shape=array.shape,
                        chunks=(10, 20, 30), dtype=">i2")
    chunked[...] = array
    assert np.asarray(madf.segment(chunked, **PHASE).labels).tobytes() == expected.tobytes()


class Slabs:
    """The least that an array has to have; remembers what was asked for."""

    def __init__(self, array):
        self.array, self.shape, self.dtype, self.asked = array, array.shape, array.dtype, []

    def __getitem__(self, key):
        self.asked.append(key)
        return self.array[key]


def test_arrays_are_read_in_slabs(array, expected):
    slabs = Slabs(array)
    assert (np.asarray(madf.segment(slabs, **PHASE).labels) == expected).all()
    assert all(key.stop - key.start <= 8 for key in slabs.asked)
    assert [key.start for key in slabs.asked] == list(range(0, array.shape[0], 8))


class Named(Slabs):
    """An array that names its axes, as an xarray.DataArray does."""

    def __init__(self, array, dims):
        super().__init__(array)
        self.dims = dims

    def __array__(self, dtype=None, copy=None):
        return self.array


@pytest.mark.parametrize("order", itertools.permutations("zyx"))
def test_names_of_axes_are_looked_at(order, array):
    turned = array.transpose(["zyx".index(name) for name in order])
    named = Named(turned, order)
    mask = madf.Mask(named, voxel_size="1x2x3um", **PHASE)
    assert mask.shape == array.shape and mask.voxel_size == (3e-6, 2e-6, 1e-6)
    assert np.array_equal(mask, array)
    along_z = [key[order.index("z")] if isinstance(key, tuple) else key for key in named.asked]
    assert all(key.stop - key.start <= 8 for key in along_z)
    assert (mask == Named(turned, order)).all()


def test_other_names_of_axes_are_taken_in_order(array):
    for names in (("time", "row", "column"), ("depth", "y", "x"), ("Z", "Y", "X")):
        assert np.array_equal(madf.Mask(Named(array, names), **PHASE), array)
    with pytest.raises(ValueError, match="the axes are called x, y, depth: call all three"):
        madf.Mask(Named(array, ("x", "y", "depth")), **PHASE)


def test_an_error_of_the_array_comes_out(array):
    class Broken(Slabs):
        def __getitem__(self, key):
            if key.start > 20:
                raise RuntimeError("the disk is gone")
            return super().__getitem__(key)

    with pytest.raises(RuntimeError, match="the disk is gone"):
        madf.Mask(Broken(array), **PHASE)

    class Short(Slabs):
        def __getitem__(self, key):
            return super().__getitem__(key)[:1]

    with pytest.raises(OSError, match="the array: gave .* bytes for slices 0 to 7"):
        madf.Mask(Short(array), **PHASE)


@pytest.mark.parametrize("volume, error, text", [
    (np.zeros((4, 4)), ValueError, "three, .z, y, x."),
    (np.zeros((4, 0, 4)), ValueError, "no voxels"),
    (np.zeros((4, 4, 4), complex), TypeError, "holds no samples"),
    (np.ma.zeros((4, 4, 4)), TypeError, "filled"),
    (np.full((4, 4, 4), 2**40), ValueError, "relabel_sequential"),
    (np.random.default_rng(1).random((9, 9, 9)), ValueError, "threshold="),
])
def test_what_cannot_be_read_is_refused(volume, error, text):
    with pytest.raises(error, match=text):
        madf.Mask(volume)


def test_labels_of_64_bits(expected):
    labels = madf.Labels(expected.astype(np.int64))
    assert (np.asarray(labels) == expected).all()
    with pytest.raises(ValueError, match="value 4294967296 in the slices from 32 on"):
        wide = expected.astype(np.int64)
        wide[39, 0, 0] = 2**32
        madf.Labels(wide)
