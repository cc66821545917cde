# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains in Blender: Edit > Preferences > Add-ons > Install, this file, and tick it.

File > Import > Grains of labels (vdb_madf): one object a grain, its pivot at the centroid, with its
measures as custom properties. It calls the command vdb_madf, whose place the preferences of the
add-on say. Without a display:

    blender --background --factory-startup --python blender_vdb_madf.py -- grains.vdb grains.blend
"""

import csv
import os
import subprocess
import sys
import tempfile

import bpy
import mathutils
from bpy_extras.io_utils import ImportHelper

bl_info = {
    "name": "Grains of labels (vdb_madf)",
    "author": "The vdb_madf authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import",
    "description": "An object a grain, with its measures",
    "category": "Import-Export",
}

COLORS = ((0.267, 0.005, 0.329), (0.230, 0.322, 0.546), (0.128, 0.567, 0.551),
          (0.369, 0.789, 0.383), (0.993, 0.906, 0.144))  # viridis, sRGB


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __name__

    command: bpy.props.StringProperty(name="Command", default="vdb_madf", subtype="FILE_PATH")

    def draw(self, _):
        self.layout.prop(self, "command")


def run(*words):
    """Runs the command, returns its notes. An OSError is a line that says what was wrong."""
    addon = bpy.context.preferences.addons.get(__name__)
    command = addon.preferences.command if addon else os.environ.get("VDB_MADF", "vdb_madf")
    try:
        done = subprocess.run([bpy.path.abspath(command), *words], capture_output=True, text=True)
    except OSError as error:
        raise OSError(f"{command} cannot be run ({error.strerror}): say in the preferences of the "
                      "add-on where the command vdb_madf is") from None
    if done.returncode:
        raise OSError((done.stderr.strip().splitlines() or ["vdb_madf failed"])[-1])
    return [line for line in done.stderr.splitlines() if line.startswith("vdb_madf: note:")]


def linear(channel):
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4


def import_meshes(path):
    """The objects of a .glb, by Blender's own importer."""
    import numpy
    if not hasattr(numpy, "bool"):
        numpy.bool = bool  # the importer of Blender 3.4 asks for it; newer numpy has it no more
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=path)
    return sorted(set(bpy.data.objects) - before, key=lambda thing: thing.name)


def set_pivot(grain):
    """The origin of the object lies at the centroid, and no point moves."""
    centroid = mathutils.Vector([grain[f"centroid_{axis}"] for axis in "xyz"])
    grain.data.transform(mathutils.Matrix.Translation(-centroid) @ grain.matrix_world)
    grain.matrix_world = mathutils.Matrix.Translation(centroid)


def material_of(measure, grains):
    """One material for all: it looks up the measure of each object, from least to largest."""
    values = [grain[measure] for grain in grains if measure in grain]
    if not values:
        raise ValueError(f"no grain has the measure {measure}: there are "
                         f"{', '.join(sorted(grains[0].keys()))}")
    material = bpy.data.materials.new(measure)
    material.use_nodes = True
    tree = material.node_tree
    attribute = tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_type, attribute.attribute_name = "OBJECT", measure
    scale = tree.nodes.new("ShaderNodeMapRange")
    scale.inputs["From Min"].default_value = min(values)
    scale.inputs["From Max"].default_value = max(max(values), min(values) + 1e-30)
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    stops = ramp.color_ramp.elements
    for number, color in enumerate(COLORS):
        place = number / (len(COLORS) - 1)
        stop = stops[0] if number == 0 else stops[-1] if place == 1 else stops.new(place)
        stop.color = (*map(linear, color), 1)
    tree.links.new(attribute.outputs["Fac"], scale.inputs["Value"])
    tree.links.new(scale.outputs["Result"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return material


def network_curve(path, name):
    """The bonds as straight curves between the centroids, as thick as their radius."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    pores = [[float(row[f"pore.coords[{axis}]"]) for axis in range(3)] for row in rows
             if row["pore.coords[0]"]]
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 1
    for row in rows:
        if not row["throat.conns[0]"]:
            continue
        line = curve.splines.new("POLY")
        line.points.add(1)
        for point, end in zip(line.points, ("throat.conns[0]", "throat.conns[1]")):
            point.co = (*pores[int(row[end])], 1)
            point.radius = float(row["throat.radius"])
    return bpy.data.objects.new(name, curve)


def import_grains(path, voxel_size="", smoothing=10, triangles=1000000, measure="", bonds=False):
    """Returns the grains, and notes. An OSError or a ValueError is a line that says what was wrong;
    nothing is left in the scene then."""
    size = ["--voxel-size", voxel_size] if voxel_size else []
    coarser = ["--triangles", str(triangles)] if triangles else []
    name = os.path.splitext(os.path.basename(path))[0]
    with tempfile.TemporaryDirectory() as folder:
        meshes, network = os.path.join(folder, "grains.glb"), os.path.join(folder, "network.csv")
        notes = run("export", path, meshes, "--smooth", str(smoothing), *coarser, *size)
        if bonds:
            run("export", path, network, "--as", "network", *size)
        grains = import_meshes(meshes)
        try:
            material = material_of(measure, grains) if measure and grains else None
        except ValueError:
            for grain in grains:
                bpy.data.meshes.remove(grain.data)
            raise
        collection = bpy.data.collections.new(name)
        bpy.context.scene.collection.children.link(collection)
        if bonds:
            collection.objects.link(network_curve(network, f"{name} bonds"))
    for grain in grains:
        for other in list(grain.users_collection):
            other.objects.unlink(grain)
        collection.objects.link(grain)
        set_pivot(grain)
        if material:
            grain.data.materials.clear()
            grain.data.materials.append(material)
        elif grain.data.materials:
            grain.color = grain.data.materials[0].diffuse_color
    return grains, notes


class ImportGrains(bpy.types.Operator, ImportHelper):
    """Import labels: an object a grain"""
    bl_idname = "import_scene.vdb_madf"
    bl_label = "Import grains"
    bl_options = {"UNDO", "PRESET"}

    filter_glob: bpy.props.StringProperty(
        default="*.vdb;*.tif;*.tiff;*.nrrd;*.mha;*.npy;*.h5", options={"HIDDEN"})
    voxel_size: bpy.props.StringProperty(
        name="Voxel size", description="Of a file that does not say it: 8.5um")
    smoothing: bpy.props.IntProperty(
        name="Smoothing", default=10, min=0, description="Rounds; 0: the faces of the voxels")
    triangles: bpy.props.IntProperty(
        name="Triangles", default=1000000, min=0,
        description="At most so many of all grains together; 0: no limit")
    measure: bpy.props.StringProperty(
        name="Color by", description="A measure, such as equivalent_diameter; else touching grains "
        "have different colors")
    bonds: bpy.props.BoolProperty(name="Bonds", description="The network, as curves")

    def execute(self, _):
        try:
            grains, notes = import_grains(self.filepath, self.voxel_size, self.smoothing,
                                          self.triangles, self.measure, self.bonds)
        except (OSError, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for note in notes:
            self.report({"WARNING"}, note)
        self.report({"INFO"}, f"{len(grains)} grains")
        return {"FINISHED"}


def menu(self, _):
    self.layout.operator(ImportGrains.bl_idname, text="Grains of labels (vdb_madf)")


def register():
    for one in (Preferences, ImportGrains):
        bpy.utils.register_class(one)
    bpy.types.TOPBAR_MT_file_import.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu)
    for one in (ImportGrains, Preferences):
        bpy.utils.unregister_class(one)


def main(source, target, measure="", bonds=""):
    """LABELS OUT.blend [MEASURE [bonds]]: the labels alone in a file of Blender."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    try:
        for note in import_grains(source, measure=measure, bonds=bonds == "bonds")[1]:
            print(note)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(target))
    except (OSError, ValueError, RuntimeError) as error:
        sys.exit(f"{error}".strip())


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if not 2 <= len(words) <= 4:
        sys.exit("give after -- the labels, the .blend to write, and maybe a measure and 'bonds'")
    main(*words)
