# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A picture of an export in the colors of its grains, by Blender without a display:

    blender --background --factory-startup --python blender_picture.py -- grains.obj picture.png

It takes the meshes .obj and .ply (Blender 3.4 reads OBJ many times faster) and the volume that
'--as viz' writes.
"""

import colorsys
import sys

import bpy
import mathutils


def opened(path):
    """Empties the scene and loads a file into it, with the colors of its grains as material."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    if path.lower().endswith(".vdb"):
        bpy.ops.object.volume_import(filepath=path, align="WORLD", location=(0, 0, 0))
        paint_volume(bpy.context.object)
        return bpy.context.object
    if path.lower().endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    elif "ply_import" in dir(bpy.ops.wm):
        bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z")
    else:
        bpy.ops.import_mesh.ply(filepath=path)
    paint_mesh(bpy.context.selected_objects[0])
    return bpy.context.selected_objects[0]


def new_material(thing):
    material = bpy.data.materials.new("grains")
    material.use_nodes = True
    for node in list(material.node_tree.nodes):
        if node.type != "OUTPUT_MATERIAL":
            material.node_tree.nodes.remove(node)
    thing.data.materials.clear()
    thing.data.materials.append(material)
    return material.node_tree, material.node_tree.nodes["Material Output"]


def paint_mesh(mesh):
    """Base Color from the colors of the points."""
    tree, output = new_material(mesh)
    attribute = tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = mesh.data.color_attributes[0].name
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    tree.links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])


def paint_volume(fog):
    """Colors from the grid `color`; dense enough that light ends within a voxel or two."""
    fog.data.grids.load()
    edge = fog.data.grids["density"].matrix_object[0][0]
    tree, output = new_material(fog)
    shader = tree.nodes.new("ShaderNodeVolumePrincipled")
    shader.inputs["Color Attribute"].default_value = "color"
    shader.inputs["Density"].default_value = 2 / edge
    tree.links.new(shader.outputs["Volume"], output.inputs["Volume"])


def box_of(thing):
    """The corners of its box in the world."""
    return [thing.matrix_world @ mathutils.Vector(corner) for corner in thing.bound_box]


def render(corners, sunlight, path, pixels, samples):
    """Looks at a box of the world from the front, right and above."""
    center = sum(corners, mathutils.Vector()) / 8
    size = max((corner - center).length for corner in corners)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 2 * size
    camera.data.clip_start = size / 100
    camera.data.clip_end = 8 * size
    away = mathutils.Vector((1, -1.6, 1.1)).normalized()
    camera.location = center + 4 * size * away
    camera.rotation_euler = away.to_track_quat("Z", "Y").to_euler()
    bpy.context.collection.objects.link(camera)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = sunlight
    sun.rotation_euler = (0.6, 0.3, 0.4)
    bpy.context.collection.objects.link(sun)

    scene = bpy.context.scene
    scene.camera = camera
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.6, 0.6, 0.6, 1)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.volume_bounces = 2
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x = scene.render.resolution_y = pixels
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def render_export(thing, path, pixels, samples, corners=None):
    """A picture of what `opened` returned. Fog scatters light away: it wants a stronger sun."""
    render(corners or box_of(thing), 14 if thing.type == "VOLUME" else 2, path, pixels, samples)


def hues(path, kinds):
    """For each pixel of a picture which of so many hues it has; None for gray and dark ones."""
    image = bpy.data.images.load(path)
    values = list(image.pixels)
    found = []
    for i in range(0, len(values), 4):
        hue, saturation, value = colorsys.rgb_to_hsv(*values[i:i + 3])
        found.append(int(kinds * hue) % kinds if saturation > 0.2 and value > 0.15 else None)
    return found


if __name__ == "__main__":
    source, picture = sys.argv[sys.argv.index("--") + 1:]
    grains = opened(source)
    render_export(grains, picture, 600, 48 if grains.type == "VOLUME" else 16)
