# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A picture of exports by VTK, with which ParaView draws, on a display that is not there:

    xvfb-run -a python3 vtk_picture.py grains.vti grains.vtp bonds.vtp picture.png

From left to right: the voxels of the grains, their meshes, and the network, with a ball of half the
diameter of each grain and a line per bond.
"""

import sys

import numpy
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  the part that draws
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkFiltersCore import vtkGlyph3D, vtkThreshold, vtkTubeFilter
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter)

PIXELS = 300  # of each of the three


def read(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def filtered(algorithm, data):
    algorithm.SetInputData(data)
    algorithm.Update()
    return algorithm.GetOutput()


def voxels(image):
    """The outer faces of the voxels that have a grain."""
    grains = vtkThreshold()
    grains.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "grain_id")
    grains.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
    grains.SetUpperThreshold(1)
    return filtered(vtkGeometryFilter(), filtered(grains, image))


def balls(network):
    sphere = vtkSphereSource()
    sphere.SetRadius(0.5)
    sphere.SetThetaResolution(32)
    sphere.SetPhiResolution(32)
    glyphs = vtkGlyph3D()
    glyphs.SetSourceConnection(sphere.GetOutputPort())
    glyphs.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS,
                                  "equivalent_diameter")
    glyphs.SetScaleModeToScaleByScalar()
    glyphs.SetScaleFactor(0.5)
    return filtered(glyphs, network)


def tubes(network):
    radii = vtk_to_numpy(network.GetCellData().GetArray("radius"))
    tube = vtkTubeFilter()
    tube.SetNumberOfSides(16)
    tube.SetRadius(0.2 * float(numpy.median(radii)))
    return filtered(tube, network)


def shown(data, colors):
    """In the colors of the grains; gray without."""
    mapper = vtkPolyDataMapper()
    actor = vtkActor()
    actor.SetMapper(mapper)
    mapper.ScalarVisibilityOff()
    for attributes, use in ((data.GetCellData(), mapper.SetScalarModeToUseCellFieldData),
                            (data.GetPointData(), mapper.SetScalarModeToUsePointFieldData)):
        if colors is not None and attributes.HasArray("grain_id"):
            array = numpy_to_vtk(colors[vtk_to_numpy(attributes.GetArray("grain_id"))], deep=True)
            array.SetName("color_of_grain")
            attributes.AddArray(array)
            mapper.ScalarVisibilityOn()
            use()
            mapper.SelectColorArray("color_of_grain")
            break
    mapper.SetInputData(data)
    return actor


def main(image_path, mesh_path, network_path, picture):
    mesh = read(vtkXMLPolyDataReader(), mesh_path)
    network = read(vtkXMLPolyDataReader(), network_path)
    ids = vtk_to_numpy(mesh.GetCellData().GetArray("grain_id"))
    colors = numpy.zeros((ids.max() + 1, 3), numpy.uint8)
    colors[ids] = vtk_to_numpy(mesh.GetCellData().GetArray("color"))

    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetSize(3 * PIXELS, PIXELS)
    parts = ([shown(voxels(read(vtkXMLImageDataReader(), image_path)), colors)],
             [shown(mesh, colors)],
             [shown(balls(network), colors), shown(tubes(network), None)])
    for number, actors in enumerate(parts):
        renderer = vtkRenderer()
        renderer.SetViewport(number / 3, 0, (number + 1) / 3, 1)
        renderer.SetBackground(0.8, 0.8, 0.8)
        for actor in actors:
            renderer.AddActor(actor)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetPosition(1, -1.6, 1.1)
        camera.SetViewUp(0, 0, 1)
        renderer.ResetCamera(mesh.GetBounds())
        camera.Zoom(1.15)
        window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtkPNGWriter()
    writer.SetFileName(picture)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main(*sys.argv[1:])
