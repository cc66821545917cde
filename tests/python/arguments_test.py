# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Arguments are in the signatures, and of a wrong type refused in a line that names them."""

import inspect
import re

import numpy as np
import pytest

import vdb_madf as madf

METHODS = [value for kind in (madf.Mask, madf.Labels, madf.Segmentation, madf.Measurements,
                              madf.Mesh)
           for name, value in inspect.getmembers(kind, inspect.isfunction)
           if not name.startswith("_")]
FUNCTIONS = [madf.segment, madf.measure, madf.compare, madf.track, madf.generate,
             madf.Mask.__init__, madf.Labels.__init__, *METHODS]

# What numpy makes an array or a type of.
ANYTHING = {"dtype", "values"}
# What has to be given, as it should be.
GOOD = dict(source="a.tif", labels="a.vdb", truth="a.vdb", test="a.vdb", before="a.vdb",
            after="a.vdb", kind="snow", ids=[1], values=[1], groups=[[1, 2]], edits="renumber",
            factor=2, id=1, strictness=9.5, path="a.vdb")


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.__qualname__)
def test_every_argument_is_checked(function):
    parameters = dict(inspect.signature(function).parameters)
    self = [None] if parameters.pop("self", None) else []
    needed = {name: GOOD[name] for name, p in parameters.items() if p.default is p.empty}
    for name, parameter in parameters.items():
        assert parameter.kind not in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL)
        if name in ANYTHING:
            continue
        with pytest.raises(TypeError) as refused:
            function(*self, **{**needed, name: object()})
        line = str(refused.value)
        assert re.fullmatch(rf"{name}=<object object at \w+>: give .+", line), line


@pytest.mark.parametrize("arguments, text", [
    (dict(gamma=20.0), "gamma=20.0: give a whole number"),
    (dict(gamma=True), "gamma=True: give a whole number"),
    (dict(range="1:1"), "range='1:1': give two numbers, such as (100, 180)"),
    (dict(range=(1, 2, 3)), "range=(1, 2, 3): give two numbers, such as (100, 180)"),
    (dict(threshold=(1, "b")), "threshold=(1, 'b'): give a number, a text or two numbers, such as "
                               "128, 'otsu' or (100, 120)"),
    (dict(keep="manifold"), "keep='manifold': give a list of texts"),
    (dict(crop=5), "crop=5: give three slices, such as numpy.s_[10:90, :, 5:50]"),
    (dict(source=None), "source=None: give Mask, a path or an array [z, y, x]"),
    (dict(theta=np.zeros((3, 3))), "theta=<an array of float64, (3, 3)>: give a number"),
    (dict(merge=["a" * 1000]), "merge=['" + "a" * 55 + "...: give a text"),
])
def test_what_is_said(arguments, text):
    with pytest.raises(TypeError) as refused:
        madf.segment(**{"source": "a.tif", **arguments})
    assert str(refused.value) == text


@pytest.mark.parametrize("ids", [np.array([1.9, 2.2]), np.array([True, False]), [2.9], [True],
                                 np.array([[1, 2]])])
def test_ids_are_whole_numbers(ids, expected):
    labels = madf.Labels(expected)
    for work in (labels.keep, labels.drop, lambda ids: labels.mesh(ids=ids),
                 lambda ids: labels.paint(ids, [5.0, 6.0])):
        with pytest.raises(TypeError) as refused:
            work(ids)
        text = str(refused.value)
        assert text.startswith("ids=")
        assert text.endswith(": give a list of whole numbers or an array of whole numbers")
    for groups in ([ids], ids[0]):
        with pytest.raises(TypeError) as refused:
            labels.merge(groups)
        assert str(refused.value).endswith(
            ": give a list of lists of whole numbers or arrays of whole numbers")


@pytest.mark.parametrize("arguments, text", [
    (dict(radius="wide"), "radius='wide': give a number"),
    (dict(center=5), "center=5: give two numbers"),
    (dict(axis=2), "axis=2: give a text"),
])
def test_what_is_said_of_a_cylinder(arguments, text):
    with pytest.raises(TypeError) as refused:
        madf.Cylinder(**arguments)
    assert str(refused.value) == text


def test_numbers_of_numpy_are_numbers(array, expected):
    labels = madf.segment(array, phase=np.array([1]), gamma=np.int64(0), theta=None,
                          strictness=np.float32(11), keep=()).labels
    assert np.array_equal(labels, expected)
    gray = madf.Mask(array * 100, threshold=[50, 90], smooth=np.float64(0), median=np.uint8(0))
    assert np.array_equal(gray, array)
    assert np.array_equal(madf.Mask(array, phase=np.array([0, 1])), np.ones_like(array))
    assert np.array_equal(madf.Mask(array, phase=np.array([0])), 1 - array)
    kept = madf.segment(array, phase=1, keep=("manifold",))
    assert kept.sweep(merge="both", delta=np.int64(2))["delta"] == [2]
    snow = madf.generate("snow", size=np.int64(24), length=np.float32(6))[0]
    assert np.asarray(snow).shape == (24, 24, 24)


def test_numbers_out_of_range(array):
    for name, value in (("gamma", 10**30), ("tidy", 2**40), ("fill_holes", -10**20)):
        with pytest.raises(ValueError, match=f"{name}={value}: is out of range"):
            madf.segment(array, phase=1, **{name: value})


@pytest.mark.parametrize("arguments, said", [
    (dict(threshold=float("nan")), "threshold=nan: not a finite number"),
    (dict(threshold=(1, float("inf"))), "threshold=inf: not a finite number"),
    (dict(range=(float("nan"), 1)), "range=nan: not a finite number"),
    (dict(phase=[1, float("nan")]), "phase=nan: not a finite number"),
    (dict(phase=1, crop=np.s_[-9:, :, :]), "crop: slice(-9, None, None): places are counted from"),
    (dict(phase=1, crop=np.s_[-9:9, :, :]), "crop: slice(-9, 9, None): places are counted from"),
    (dict(phase=[]), "phase=[]: names no value"),
    (dict(phase=1, grid="x"), "grid: names a part of a file, and this is an array"),
    (dict(phase=1, dataset="x"), "dataset: names a part of a file, and this is an array"),
    (dict(phase=1, crop=np.s_[:-5, :, :]), "crop: slice(None, -5, None): places are counted from")])
def test_numbers_that_select_nothing_are_refused(array, arguments, said):
    with pytest.raises(ValueError) as refused:
        madf.Mask(array, **arguments)
    assert str(refused.value).startswith(said)


def test_where_nothing_is_selected_a_warning_says_so(array):
    with pytest.warns(UserWarning, match="nothing is selected"):
        assert not np.asarray(madf.Mask(array, phase=7)).any()


def test_an_index_that_is_an_array_is_refused_in_a_line(expected):
    labels = madf.Labels(expected)
    with pytest.raises(IndexError) as refused:
        labels[labels > 3]
    assert str(refused.value).startswith(f"<an array of bool, {expected.shape}> is no whole number")
    assert len(str(refused.value)) < 160


def test_the_help_says_what_is_measured(array):
    measured = madf.measure(madf.segment(array, phase=1), shape=True, intensity=array,
                            edge_weights=True, crossing=True, voronoi=True, size_curve=True,
                            stability=True, bootstrap=100)
    text = inspect.getdoc(madf.Measurements)
    for name in {**measured.grains, **measured.bonds, **measured.sample}:
        assert f"`{re.sub('_[xyz]$', '_*', name)}`" in text, name
    for function in FUNCTIONS:
        assert "README" not in inspect.getdoc(function)
