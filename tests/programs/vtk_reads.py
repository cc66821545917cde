# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""VTK (which ParaView reads files with) reads our VTI, VTP, VTU, PLY, OBJ and STL."""

from math import isnan

from proof import (
    Bench, EDGE, LABELS, SIZE, VOXELS, box_of, check, near, skip, values, vtk_opens_its_own)

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties, vtkThreshold
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
    from vtkmodules.vtkIOGeometry import vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
    from vtkmodules.vtkIOXML import (
        vtkXMLImageDataReader, vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader)
except ImportError as error:
    skip(f"what VTK reads: python3-vtk9 is not installed ({error})")


def read(reader, path):
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(path))
    reader.SetFileName(path)
    reader.Update()
    check(not errors, f"VTK complains about {path}")
    return reader.GetOutput()


def grain(mesh, label):
    """The polygons of one grain."""
    part = vtkThreshold()
    part.SetInputData(mesh)
    part.SetInputArrayToProcess(0, 0, 0, 1, "grain_id")
    part.SetThresholdFunction(vtkThreshold.THRESHOLD_BETWEEN)
    part.SetLowerThreshold(label)
    part.SetUpperThreshold(label)
    surface = vtkGeometryFilter()
    surface.SetInputConnection(part.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def open_edges(mesh):
    edges = vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def volume(mesh):
    mass = vtkMassProperties()
    mass.SetInputData(mesh)
    return mass.GetVolume()


with Bench() as bench:
    if not vtk_opens_its_own(bench.path("own.vti")):
        skip("what VTK reads: this one opens not even the .vti it writes")
    for name, options in {"raw.vti": [], "packed.vti": ["--compress"]}.items():
        image = read(vtkXMLImageDataReader(), bench.run("export", name, *options))
        found = vtk_to_numpy(image.GetCellData().GetArray("grain_id"))
        check(found.tolist() == values(), f"{name}: the labels differ")
        for number, label in enumerate(found.tolist()):
            if label == 0:
                continue
            x, y, z = number % SIZE[0], number // SIZE[0] % SIZE[1], number // SIZE[0] // SIZE[1]
            bounds = image.GetCell(number).GetBounds()
            middle = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)]
            check(LABELS[x, y, z] == label and near(middle, (x * EDGE, y * EDGE, z * EDGE)),
                  f"{name}: voxel {x},{y},{z} lies at {middle}")

    mesh = read(vtkXMLPolyDataReader(), bench.run("export", "mesh.vtp", "--as", "mesh", "--smooth",
                                                  "0"))
    check(mesh.GetCellData().GetArray("color").GetNumberOfComponents() == 3, "mesh.vtp: no colors")
    for label, count in VOXELS.items():
        part = grain(mesh, label)
        check(near(part.GetBounds(), box_of(label)),
              f"mesh.vtp: grain {label} at {part.GetBounds()}")
        check(open_edges(part) == 0, f"mesh.vtp: grain {label} is not closed")
        check(abs(volume(part) / EDGE**3 - count) < 1e-3, f"mesh.vtp: volume of grain {label}")

    low, high = [1e9] * 3, [-1e9] * 3
    for label in VOXELS:
        box = box_of(label)
        low = [min(a, b) for a, b in zip(low, box[0::2])]
        high = [max(a, b) for a, b in zip(high, box[1::2])]
    whole = [x for pair in zip(low, high) for x in pair]
    for name, reader in {"mesh.ply": vtkPLYReader(), "mesh.obj": vtkOBJReader(),
                         "mesh.stl": vtkSTLReader()}.items():
        other = read(reader, bench.run("export", name, "--smooth", "0"))
        check(near(other.GetBounds(), whole), f"{name}: bounds {other.GetBounds()}")
        check(other.GetNumberOfPolys() == mesh.GetNumberOfPolys(), f"{name}: number of triangles")
        check(abs(volume(other) / EDGE**3 - len(LABELS)) < 1e-3, f"{name}: volume")

    network = read(vtkXMLPolyDataReader(), bench.run("export", "bonds.vtp", "--as", "network"))
    ids = vtk_to_numpy(network.GetPointData().GetArray("grain_id")).tolist()
    check(ids == sorted(VOXELS), f"bonds.vtp: grains {ids}")
    of_mesh = dict(zip(vtk_to_numpy(mesh.GetCellData().GetArray("grain_id")).tolist(),
                       vtk_to_numpy(mesh.GetCellData().GetArray("color")).tolist()))
    colors = vtk_to_numpy(network.GetPointData().GetArray("color")).tolist()
    check(dict(zip(ids, colors)) == of_mesh, f"bonds.vtp: colors {colors}")
    sizes = vtk_to_numpy(network.GetPointData().GetArray("voxels")).tolist()
    check(sizes == [VOXELS[label] for label in ids], f"bonds.vtp: sizes {sizes}")
    check(near(network.GetPoint(0), (2 * EDGE, 3 * EDGE, 5 * EDGE)), "bonds.vtp: place of grain 1")
    check(network.GetNumberOfLines() == 1, "bonds.vtp: number of bonds")
    bond = {network.GetCellData().GetArrayName(i): network.GetCellData().GetArray(i).GetTuple1(0)
            for i in range(network.GetCellData().GetNumberOfArrays())}
    check((bond["first"], bond["second"], bond["faces"]) == (2, 3, 2), f"bonds.vtp: {bond}")
    check(near((bond["centroid_x"], bond["centroid_y"], bond["centroid_z"]),
               (7.5 * EDGE, 1 * EDGE, 2.5 * EDGE)), f"bonds.vtp: center of the bond {bond}")
    check((bond["normal_x"], bond["normal_y"], bond["normal_z"]) == (0, 0, 1), f"bonds.vtp: {bond}")
    roundness = network.GetPointData().GetArray("sphericity").GetTuple1(0)
    check(isnan(roundness), f"bonds.vtp: a grain of one voxel has the sphericity {roundness}")

    elements = read(vtkXMLUnstructuredGridReader(), bench.run("export", "elements.vtu"))
    check(elements.GetNumberOfCells() == len(LABELS), "elements.vtu: number of elements")
    corners = {(x + dx, y + dy, z + dz) for x, y, z in LABELS
               for dx in (0, 1) for dy in (0, 1) for dz in (0, 1)}
    check(elements.GetNumberOfPoints() == len(corners), "elements.vtu: number of nodes")
    sizes = vtkCellSizeFilter()
    sizes.SetInputData(elements)
    sizes.Update()
    ids = elements.GetCellData().GetArray("grain_id")
    found = {}
    for number in range(len(LABELS)):
        bounds = elements.GetCell(number).GetBounds()
        middle = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 / EDGE for axis in range(3)]
        voxel = tuple(round(x) for x in middle)
        check(near(voxel, middle), f"elements.vtu: an element at {middle}")
        found[voxel] = int(ids.GetTuple1(number))
        volume_of = sizes.GetOutput().GetCellData().GetArray("Volume").GetTuple1(number)
        check(abs(volume_of / EDGE**3 - 1) < 1e-6, f"elements.vtu: volume {volume_of}")
    check(found == LABELS, f"elements.vtu: {found}")
print("VTK reads VTI, VTP, VTU, PLY, OBJ and STL")
