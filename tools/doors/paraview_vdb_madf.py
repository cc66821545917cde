# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains in ParaView: Tools > Manage Plugins > Load New, and this file.

A reader of labels, a filter that cuts an image into grains, and one that shows the labels of an
image as grains. They call the Python package vdb_madf, which has to be where ParaView's Python
looks for it: PYTHONPATH. tools/manual/paraview.md says more.
"""

import csv
import functools
import json
import os
import re

import numpy as np
from paraview.util.vtkAlgorithm import (
    VTKPythonAlgorithmBase, smdomain, smproperty, smproxy)
from vtkmodules.util.numpy_support import (
    numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy)
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkCellArray, vtkCompositeDataSet, vtkDataObject, vtkImageData, vtkPartitionedDataSetCollection,
    vtkPolyData)


def package():
    try:
        import vdb_madf
    except ImportError as error:
        raise OSError(f"the Python package vdb_madf cannot be imported ({error}): start ParaView "
                      "with PYTHONPATH set to the folder that it is in") from None
    return vdb_madf


def told_in_a_line(request):
    """What is wrong with files and settings is said in a line, without a traceback."""
    @functools.wraps(request)
    def run(*arguments):
        try:
            request(*arguments)
        except (ValueError, TypeError, OSError) as error:
            vtkOutputWindow.GetInstance().DisplayErrorText(f"vdb_madf: {error}\n")
            return 0
        return 1
    return run


def setting(name, kind, default, documentation, inside=""):
    """A property of that name, which a class keeps as `_name`. It is called SetName there."""
    def keep(self, value):
        if getattr(self, f"_{name}", default) != value:
            setattr(self, f"_{name}", value)
            self.Modified()
    keep.__name__ = f"Set{name}"
    return smproperty.xml(
        f'<{kind}VectorProperty name="{name}" command="Set{name}" number_of_elements="1" '
        f'default_values="{default}"><Documentation>{documentation}</Documentation>{inside}'
        f'</{kind}VectorProperty>')(keep)


def choice_of_array():
    """A property: an array of the input's points or cells."""
    return smproperty.xml("""
        <StringVectorProperty name="Array" command="SetInputArrayToProcess"
            element_types="0 0 0 0 2" number_of_elements="5">
          <ArrayListDomain name="array_list" attribute_type="Scalars" input_domain_name="arrays">
            <RequiredProperties><Property name="Input" function="Input"/></RequiredProperties>
          </ArrayListDomain>
        </StringVectorProperty>""")(lambda self, *values: self.SetInputArrayToProcess(*values))


SMOOTHING = ("Smoothing", "Int", 10, "Rounds; 0: the faces of the voxels")
TRIANGLES = ("Triangles", "Int", 1000000, "At most so many of all grains together; 0: no limit")
UNIT = ("Unit", "String", "mm", "That of the spacing of the image")
TWO_OUTPUTS = smproperty.xml('<OutputPort name="Grains" index="0"/>'
                             '<OutputPort name="Network" index="1"/>')


def image_input(function):
    arrays = '<InputArrayDomain name="arrays" attribute_type="any" number_of_components="1"/>'
    return smproperty.input(name="Input", port_index=0)(
        smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)(
            smdomain.xml(arrays)(function)))


class Image:
    """An array of an image as [z, y, x], and where its voxels lie."""

    def __init__(self, algorithm, inputs):
        self.data = vtkImageData.GetData(inputs[0], 0)
        asked = algorithm.GetInputArrayInformation(0)
        name = asked.Get(vtkDataObject.FIELD_NAME())
        if name:
            self.of_points = asked.Get(vtkDataObject.FIELD_ASSOCIATION()) == 0
            array = self.attributes_of(self.data).GetArray(name)
        else:  # in scripts Array may be left out
            self.of_points = self.data.GetPointData().GetNumberOfArrays() > 0
            array = self.attributes_of(self.data).GetArray(0)
        if array is None:
            raise ValueError(f"the image has no array {name or ''}: choose one as Array")
        extent = self.data.GetExtent()
        more = 1 if self.of_points else 0
        shape = [extent[2 * axis + 1] - extent[2 * axis] + more for axis in (2, 1, 0)]
        self.array = vtk_to_numpy(array).reshape(shape)
        self.edges = self.data.GetSpacing()
        self.first = [origin + (extent[2 * axis] + (1 - more) / 2) * self.edges[axis]
                      for axis, origin in enumerate(self.data.GetOrigin())]

    def attributes_of(self, data):
        return data.GetPointData() if self.of_points else data.GetCellData()

    def voxel_size(self, unit):
        return "x".join(f"{edge:.9g}{unit}" for edge in self.edges)

    def place(self, points, labels):
        """Where points of labels, (N, 3) x, y, z, lie in the image."""
        first, edges = (np.array(along[::-1]) for along in (labels.origin, labels.spacing))
        return np.array(self.first) + (points - first) / edges * np.array(self.edges)


def column(values):
    """A column as VTK holds it."""
    values = np.ascontiguousarray(values)
    return numpy_to_vtk(values.astype(np.uint8) if values.dtype == bool else values, deep=True)


def add(attributes, name, values):
    array = column(values)
    array.SetName(name)
    attributes.AddArray(array)


def cells(size, numbers):
    found = vtkCellArray()
    found.SetData(size, numpy_to_vtkIdTypeArray(
        np.ascontiguousarray(numbers, np.int64).ravel(), deep=True))
    return found


def points_of(places):
    points = vtkPoints()
    points.SetData(column(places))
    return points


def table(path):
    """The columns of numbers of a table that `vdb_madf measure` wrote, without units."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    columns = {}
    for number, name in enumerate(rows[0]):
        try:
            values = np.array([float(row[number] or "nan") for row in rows[1:]])
        except ValueError:
            continue
        columns[re.sub(r"_(per_)?(mm|um|voxel)\d?$", "", name)] = values
    return columns


def factor_to(sample, labels):
    """What places of the labels are multiplied by to be in the unit of the tables of sample.json.
    Tables of other voxels are refused."""
    meters = {"mm": 1e-3, "um": 1e-6, "voxel": 1}
    unit = sample.get("length_unit", "voxel")
    factor = meters[labels.unit] / meters[unit]
    if unit == labels.unit == "voxel":  # the tables do not tell the proportions of voxels
        return factor
    edges = np.broadcast_to(sample.get(f"voxel_size_{unit}", 1), 3)  # x, y, z
    ours = np.array(labels.spacing[::-1])
    if not np.allclose(edges, factor * ours, rtol=1e-6, atol=0):
        raise ValueError(f"the tables beside the labels are of voxels of {edges} {unit}, and these "
                         f"have {ours} {labels.unit}: measure again, or set VoxelSize")
    return factor


def columns_of(labels, path):
    """Grains and bonds: the tables beside the file if they are of these labels, else measured; and
    what places of the labels are multiplied by to be in their unit."""
    folder = os.path.dirname(path)
    try:
        with open(os.path.join(folder, "sample.json")) as file:
            sample = json.load(file)
        grains, bonds = (table(os.path.join(folder, name)) for name in ("grains.csv", "bonds.csv"))
        are_theirs = (sample.get("labels_digest") == labels.digest() and
                      np.array_equal(grains["id"], labels.ids) and
                      {"centroid_x", "centroid_y", "centroid_z"} <= grains.keys() and
                      {"first", "second"} <= bonds.keys())
    except (OSError, ValueError, AttributeError, IndexError, KeyError, csv.Error):
        are_theirs = False
    if are_theirs:
        return grains, bonds, factor_to(sample, labels)
    measured = package().measure(labels)
    return measured.grains, measured.bonds, 1


def show_grains(labels, image, columns, meshed, algorithm, outputs):
    """A closed surface a grain into the first output, the network of grains into the second: in the
    places of the labels, in the unit of the columns, or those of an image."""
    def place(points):
        return image.place(points, labels) if image else points

    grains, bonds, factor = columns
    ids = np.asarray(grains["id"]).astype(np.int32)
    known, rgb = labels.colors()
    colors = rgb[np.searchsorted(known, ids)]
    measures = {name: values for name, values in grains.items() if name != "id"}
    mesh = meshed.mesh(smoothing=algorithm._Smoothing, triangles=algorithm._Triangles or None)

    collection = vtkPartitionedDataSetCollection.GetData(outputs, 0)
    collection.SetNumberOfPartitionedDataSets(len(mesh.ids))
    for number, (id, row) in enumerate(zip(mesh.ids, np.searchsorted(ids, mesh.ids))):
        points, triangles = mesh.grain(int(id))
        surface = vtkPolyData()
        surface.SetPoints(points_of((factor * place(points)).astype(np.float32)))
        surface.SetPolys(cells(3, triangles))
        of_cells, count = surface.GetCellData(), len(triangles)
        add(of_cells, "grain_id", np.full(count, id, np.int32))
        add(of_cells, "color", np.repeat(colors[row:row + 1], count, axis=0))
        for name, values in measures.items():
            kind = np.float32 if values.dtype.kind == "f" else values.dtype
            add(of_cells, name, np.full(count, values[row], kind))
        collection.SetPartition(number, 0, surface)
        collection.GetMetaData(number).Set(vtkCompositeDataSet.NAME(), f"grain_{id:06d}")

    network = vtkPolyData.GetData(outputs, 1)
    centers = np.array([grains[f"centroid_{axis}"] for axis in "xyz"], float).T
    network.SetPoints(points_of(place(centers.reshape(-1, 3))))
    ends = [np.searchsorted(ids, np.asarray(bonds[end]).astype(np.int32))
            for end in ("first", "second")]
    network.SetLines(cells(2, np.stack(ends, axis=1)))
    add(network.GetPointData(), "grain_id", ids)
    add(network.GetPointData(), "color", colors)
    for name, values in measures.items():
        add(network.GetPointData(), name, values)
    for name, values in bonds.items():
        add(network.GetCellData(), name, values)


def grain_outputs(port, info):
    kind = "vtkPolyData" if port else "vtkPartitionedDataSetCollection"
    info.Set(vtkDataObject.DATA_TYPE_NAME(), kind)
    return 1


@smproxy.reader(name="MadfGrains", label="Madf Grains", extensions="vdb",
                file_description="Labels of grains (vdb_madf)")
@TWO_OUTPUTS
class MadfGrains(VTKPythonAlgorithmBase):
    """Labels of any file that vdb_madf reads, as surfaces and network."""

    _FileName, _VoxelSize, _Dataset = "", "", ""
    _Reduce, _Smoothing, _Triangles = 1, 10, 1000000

    SetFileName = setting("FileName", "String", "", "Labels", '<FileListDomain name="files"/>')
    SetVoxelSize = setting("VoxelSize", "String", "", "Of a file that does not say it: 8.5um")
    SetDataset = setting("Dataset", "String", "", "Of an HDF5 file or a Zarr group")
    SetReduce = setting("Reduce", "Int", 1, "Meshes of voxels so many times larger")
    SetSmoothing = setting(*SMOOTHING)
    SetTriangles = setting(*TRIANGLES)

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=0, nOutputPorts=2)

    def FillOutputPortInformation(self, port, info):
        return grain_outputs(port, info)

    @told_in_a_line
    def RequestData(self, request, inputs, outputs):
        labels = package().Labels(self._FileName, voxel_size=self._VoxelSize or None,
                                  dataset=self._Dataset or None)
        meshed = labels if self._Reduce == 1 else labels.reduce(self._Reduce)
        show_grains(labels, None, columns_of(labels, self._FileName), meshed, self, outputs)


@smproxy.filter(name="MadfSegment", label="Madf Segment")
@image_input
class MadfSegment(VTKPythonAlgorithmBase):
    """Cuts the object of an image into grains: the image with the array grain_id, 0 where there is
    none."""

    _Least, _Largest, _Strictness, _Unit = 1.0, 255.0, 11.0, "mm"

    SetArray = choice_of_array()
    SetLeast = setting("Least", "Double", 1.0, "The least value that is object")
    SetLargest = setting("Largest", "Double", 255.0, "The largest value that is object")
    SetStrictness = setting("Strictness", "Double", 11.0, "The larger, the more grains")
    SetUnit = setting(*UNIT)

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=1, nOutputPorts=1,
                                        inputType="vtkImageData", outputType="vtkImageData")

    @told_in_a_line
    def RequestData(self, request, inputs, outputs):
        image = Image(self, inputs)
        made = package().segment(image.array, range=(self._Least, self._Largest),
                                 strictness=self._Strictness,
                                 voxel_size=image.voxel_size(self._Unit))
        output = vtkImageData.GetData(outputs, 0)
        output.ShallowCopy(image.data)
        attributes = image.attributes_of(output)
        add(attributes, "grain_id", made.labels.to_array().ravel())
        attributes.SetActiveScalars("grain_id")


@smproxy.filter(name="MadfShowGrains", label="Madf Show Grains")
@TWO_OUTPUTS
@image_input
class MadfShowGrains(VTKPythonAlgorithmBase):
    """The labels of an image, measured, as surfaces and network."""

    _Smoothing, _Triangles, _Unit = 10, 1000000, "mm"

    SetArray = choice_of_array()
    SetSmoothing = setting(*SMOOTHING)
    SetTriangles = setting(*TRIANGLES)
    SetUnit = setting(*UNIT)

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=1, nOutputPorts=2,
                                        inputType="vtkImageData")

    def FillOutputPortInformation(self, port, info):
        return grain_outputs(port, info)

    @told_in_a_line
    def RequestData(self, request, inputs, outputs):
        image = Image(self, inputs)
        labels = package().Labels(image.array, voxel_size=image.voxel_size(self._Unit))
        measured = package().measure(labels)
        show_grains(labels, image, (measured.grains, measured.bonds, 1), labels, self, outputs)
