# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What the proofs with other programs share: a label volume without any symmetry, and the command.

The volume has voxels of 10 um: voxel (i,j,k) lies at (i,j,k) * 0.01 mm in every file we write.
"""

import array
import os
import shutil
import subprocess
import sys
import tempfile

SIZE = (11, 9, 8)
EDGE = 0.01  # mm
LABELS = {  # voxel: label; 1 is one voxel, 2 and 3 share two faces, 70000 needs more than 16 bits
    (2, 3, 5): 1,
    (7, 1, 2): 2, (8, 1, 2): 2, (7, 2, 2): 2, (8, 2, 2): 2,
    (7, 1, 3): 3, (8, 1, 3): 3,
    (0, 8, 7): 70000, (1, 8, 7): 70000,
}
VOXELS = {label: sum(l == label for l in LABELS.values()) for label in set(LABELS.values())}


def skip(what):
    """Ends the proof so that CTest says Skipped, not Passed."""
    print(f"SKIPPED: {what}")
    sys.exit(77)


def values():
    """All labels of the volume, x fastest."""
    nx, ny, nz = SIZE
    return [LABELS.get((x, y, z), 0) for z in range(nz) for y in range(ny) for x in range(nx)]


class Bench:
    """A folder with the volume in it, in which the command runs. First argument: the command."""

    def __init__(self):
        self.tool = os.path.abspath(sys.argv[1])
        self.folder = tempfile.mkdtemp(prefix="vdb_madf_")
        with open(self.path("labels.raw"), "wb") as file:
            file.write(array.array("i", values()).tobytes())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, verb, output, *options, source="labels.raw"):
        """Writes an output of the volume; returns its path."""
        raw = ["--dims", "x".join(map(str, SIZE)), "--type",
               "int32"] if source.endswith(".raw") else []
        subprocess.run([self.tool, verb, self.path(source), self.path(output), "-q",
                        *raw, "--voxel-size", "10um", *options], check=True)
        return self.path(output)

    def segment_sintered(self, size, count):
        """Writes grains.vdb: grains of a sample of balls, with the balls that clumps are made
        of."""
        subprocess.run([self.tool, "generate", "sintered", self.path("sample.vdb"), "--size",
                        str(size), "--count", str(count), "--voxel-size", "10um", "-q"], check=True)
        self.run("segment", "grains.vdb", "--keep", "balls", "--boundary", "closed",
                 source="sample.vdb")


def run_in_blender(script, folder, what):
    """Runs a script with a folder as its argument inside Blender; returns what it says is done."""
    if not shutil.which("blender"):
        skip(f"{what}: blender is not installed (tools/setup --blender)")
    # Blender takes the modules of the first Python of its version in the PATH: Debian's own has
    # numpy.
    places = os.pathsep.join(["/usr/bin", os.environ.get("PATH", "")])
    result = subprocess.run(
        ["blender", "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1",
         "--python", os.path.abspath(script), "--", folder],
        capture_output=True, text=True, timeout=900, env=dict(os.environ, PATH=places))
    lines = [line for line in (result.stdout + result.stderr).splitlines()
             if line.strip() and not line.startswith("Fra:")]
    done = [line for line in lines if line.startswith("DONE: ")]
    check(result.returncode == 0 and done, "Blender: " + "\n".join(lines[-20:]))
    return done[0][len("DONE: "):]


def vtk_opens_its_own(path):
    """Does VTK open an image that it writes? Older ones do not with newer or mended libexpat."""
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter
    image = vtkImageData()
    image.SetDimensions(20, 20, 20)  # more than the piece of a file that the reader takes
    image.AllocateScalars(3, 1)  # bytes
    writer, reader = vtkXMLImageDataWriter(), vtkXMLImageDataReader()
    for each in (writer, reader):
        each.SetFileName(path)
    reader.AddObserver("ErrorEvent", lambda *_: None)
    writer.SetInputData(image)
    writer.SetCompressorTypeToNone()
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.Write()
    reader.Update()
    return reader.GetOutput().GetNumberOfPoints() == 8000


def near(a, b, tolerance=1e-6):
    return len(a) == len(b) and all(abs(x - y) <= tolerance for x, y in zip(a, b))


def check(truth, what):
    if not truth:
        sys.exit(f"FAILED: {what}")


def box_of(label):
    """World bounds of the voxels of a label: xmin, xmax, ymin ..."""
    places = [p for p, l in LABELS.items() if l == label]
    bounds = []
    for axis in range(3):
        bounds += [(min(p[axis] for p in places) - 0.5) * EDGE,
                   (max(p[axis] for p in places) + 0.5) * EDGE]
    return bounds
