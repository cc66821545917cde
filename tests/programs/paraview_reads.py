# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""ParaView, without a display, shows grains by our plug-in: of a file, and of its own images.

Runs itself again in pvpython, and the script of the manual's page.
"""

import array
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from proof import (  # noqa: E402
    EDGE, VOXELS, Bench, box_of, check, near, skip, vtk_opens_its_own)

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
PLUGIN = os.path.join(ROOT, "tools/doors/paraview_vdb_madf.py")
NO_IMAGES = "ParaView does not open its own images"


def pvpython(script, folder, *words, env=None):
    result = subprocess.run(["pvpython", script, *words], cwd=folder, capture_output=True,
                            text=True, timeout=600, env=env)
    return result.returncode, result.stdout + result.stderr


def start():
    if not shutil.which("pvpython"):
        skip("what ParaView shows: pvpython is not installed (tools/setup --paraview)")
    try:
        import vdb_madf  # noqa: F401
    except ImportError as error:
        skip(f"what ParaView shows: the Python package vdb_madf was not built ({error})")
    with Bench() as bench:
        bench.run("edit", "labels.vdb", "--min-voxels", "1")
        bench.run("export", "labels.vti")
        bench.run("measure", "tables", "--shape")
        os.mkdir(bench.path("beside"))
        shutil.copy(bench.path("labels.vdb"), bench.path("beside"))
        for name in ("grains.csv", "bonds.csv", "sample.json"):
            shutil.copy(bench.path(f"tables/{name}"), bench.path("beside"))
        for folder, options in (("micrometers", ["--unit", "um"]),
                                ("other voxels", ["--voxel-size", "20um"]),
                                ("no bonds", ["--min-faces", "1000"])):
            os.mkdir(bench.path(folder))
            labels = shutil.copy(bench.path("labels.vdb"), bench.path(folder))
            subprocess.run([bench.tool, "measure", labels, bench.path(folder), "-q", *options],
                           check=True)
        with open(bench.path("two.raw"), "wb") as file:  # an object of two balls of 1 and 2 mm
            file.write(array.array("B", [128 * two_balls(x, y, z) for z in range(20)
                                         for y in range(24) for x in range(40)]).tobytes())
        code, said = pvpython(os.path.abspath(__file__), bench.folder, "inside")
        check(code == 0 and "DONE" in said, f"ParaView: {said[-3000:]}")
        check("are of voxels of [0.02 0.02 0.02] mm" in said and "Traceback" not in said,
              f"tables of other voxels: {said[-3000:]}")
        opens_images = NO_IMAGES not in said
        # Without the package: a line.
        clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        with open(bench.path("alone.py"), "w") as file:
            file.write("import inspect\ninspect.getargspec = inspect.getfullargspec\n"
                       "from paraview.simple import *\n"
                       f"LoadPlugin({PLUGIN!r}, ns=globals())\n"
                       "MadfGrains(FileName='labels.vdb').UpdatePipeline()\n")
        said = pvpython("alone.py", bench.folder, env=clean)[1]
        check("PYTHONPATH" in said and "Traceback" not in said, f"without the package: {said}")
        if not opens_images:
            skip("images and the page's script in ParaView: it opens not even the .vti it writes")
        # The script of the page.
        with open(os.path.join(ROOT, "tools/manual/paraview.md")) as file:
            scripts = re.findall(r"^```python\n(.*?)^```", file.read(), re.M | re.S)
        check(scripts, "the page has no script")
        os.symlink(os.path.join(ROOT, "tools"), bench.path("tools"))
        shutil.copy(bench.path("labels.vdb"), bench.path("grains.vdb"))
        shutil.copy(bench.path("labels.vti"), bench.path("scan.vti"))
        for number, script in enumerate(scripts):
            with open(bench.path(f"page{number}.py"), "w") as file:
                file.write(script)
            code, said = pvpython(f"page{number}.py", bench.folder)
            check(code == 0 and "rror" not in said, f"the script of the page: {said[-3000:]}")
    print("ParaView shows grains of labels, of images, and segments")


def two_balls(x, y, z):
    return int(min((x - 11) ** 2, (x - 28) ** 2) + (y - 12) ** 2 + (z - 10) ** 2 <= 81)


def inside():
    import numpy as np
    import inspect
    from paraview import simple
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkMassProperties
    inspect.getargspec = inspect.getfullargspec  # as the page says
    simple.LoadPlugin(PLUGIN, ns=vars(simple))

    def arrays(attributes):
        return {attributes.GetArrayName(i): vtk_to_numpy(attributes.GetArray(i))
                for i in range(attributes.GetNumberOfArrays())}

    def fetched(proxy, port=0):
        # Without the client's delivery, which merges.
        proxy.UpdatePipeline()
        return proxy.SMProxy.GetClientSideObject().GetOutputDataObject(port)

    def check_grains(proxy, more=(), edge=EDGE):
        grains, network = fetched(proxy), fetched(proxy, 1)
        check(grains.GetNumberOfPartitionedDataSets() == len(VOXELS), "the number of grains")
        for number, label in enumerate(sorted(VOXELS)):
            name = grains.GetMetaData(number).Get(grains.NAME())
            check(name == f"grain_{label:06d}", f"grain {label} is called {name}")
            surface = grains.GetPartition(number, 0)
            bounds = surface.GetBounds()
            box = [edge / EDGE * end for end in box_of(label)]
            check(near(bounds, box, 1e-4 * edge), f"{name} lies at {bounds}, not {box}")
            mass = vtkMassProperties()
            mass.SetInputData(surface)
            check(abs(mass.GetVolume() / edge**3 - VOXELS[label]) < 1e-3, f"{name}: its volume")
            of = arrays(surface.GetCellData())
            check((of["grain_id"] == label).all() and (of["voxels"] == VOXELS[label]).all() and
                  np.allclose(of["volume"], VOXELS[label] * edge**3) and
                  of["color"].shape == (surface.GetNumberOfCells(), 3), f"{name} has {of}")
            check(set(more) <= set(of), f"{name} has {sorted(of)}, not {more}")
        of = arrays(network.GetPointData())
        check(of["grain_id"].tolist() == sorted(VOXELS), f"the network has {of['grain_id']}")
        place = network.GetPoint(0)
        check(near(place, (2 * edge, 3 * edge, 5 * edge)), f"grain 1 lies at {place}")
        of = arrays(network.GetCellData())
        check((of["first"].tolist(), of["second"].tolist(), of["faces"].tolist()) ==
              ([2], [3], [2]), f"the bonds are {of}")

    reader = simple.MadfGrains(FileName="labels.vdb", Smoothing=0)
    check_grains(reader)
    # It is the reader of the ending, and takes tables beside the file that are of these labels.
    beside = simple.OpenDataFile("beside/labels.vdb")
    check(beside.SMProxy.GetXMLName() == "MadfGrains", beside.SMProxy.GetXMLName())
    beside.Smoothing = 0
    check_grains(beside, more=["feret_max", "solidity"])
    # All is in the unit of the tables. Those of other voxels are refused, unless the reader knows.
    check_grains(simple.MadfGrains(FileName="micrometers/labels.vdb", Smoothing=0), edge=10)
    other = simple.MadfGrains(FileName="other voxels/labels.vdb", Smoothing=0)
    check(fetched(other).GetNumberOfPartitionedDataSets() == 0, "tables of other voxels")
    other.VoxelSize = "20um"
    check_grains(other, edge=0.02)
    other = simple.MadfGrains(FileName="no bonds/labels.vdb", Smoothing=0)
    check(fetched(other).GetNumberOfPartitionedDataSets() == len(VOXELS), "tables without bonds")
    network = fetched(other, 1)
    check((network.GetNumberOfPoints(), network.GetNumberOfLines()) == (len(VOXELS), 0),
          "the network of tables without bonds")
    other = simple.MadfGrains(FileName="labels.vdb", Reduce=2, Smoothing=0)
    check(fetched(other).GetNumberOfPartitionedDataSets() < len(VOXELS), "coarser: no grain less")

    # An image with labels in its cells.
    if vtk_opens_its_own("own.vti"):
        image = simple.XMLImageDataReader(FileName=["labels.vti"])
        check_grains(simple.MadfShowGrains(Input=image, Array=["CELLS", "grain_id"], Smoothing=0))
    else:
        print(NO_IMAGES)

    # Two balls: gray values at points, with an origin of their own.
    raw = simple.ImageReader(FileNames=["two.raw"], DataScalarType="unsigned char",
                             DataExtent=[0, 39, 0, 23, 0, 19], DataByteOrder="LittleEndian",
                             DataSpacing=[0.5, 0.5, 0.5], DataOrigin=[7, 8, 9])
    cut = simple.MadfSegment(Input=raw, Least=100, Largest=200)
    found = fetched(cut)
    ids = arrays(found.GetPointData())["grain_id"]
    scan = np.fromfile("two.raw", np.uint8)
    check(ids.shape == scan.shape and ((ids > 0) == (scan > 0)).all() and ids.max() == 2,
          f"{ids.max()} grains")
    import vdb_madf
    same = vdb_madf.segment(scan.reshape(20, 24, 40), range=(100, 200), voxel_size="0.5mm").labels
    check((same.to_array().ravel() == ids).all(), "other labels than the package's")
    balls = simple.MadfShowGrains(Input=cut, Array=["POINTS", "grain_id"])
    network = fetched(balls, 1)
    for number, x in enumerate((11, 28)):
        place = network.GetPoint(number)
        check(near(place, (7 + x / 2, 8 + 12 / 2, 9 + 10 / 2), 0.15), f"a ball at {place}")
    bounds = fetched(balls).GetPartition(0, 0).GetBounds()
    check(7 < bounds[0] < bounds[1] < 7 + 20, f"a ball from {bounds}")

    print("DONE")


if __name__ == "__main__":
    if sys.argv[1] == "inside":
        inside()
    else:
        start()
