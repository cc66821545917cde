# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A picture of an exported OBJ or PLY in the colours of its grains, by Blender without a display:

    blender --background --factory-startup --python blender_picture.py -- grains.obj picture.png

Blender 3.4 reads OBJ many times faster than PLY.
"""

import sys

import bpy
import mathutils


def show(mesh):
    """A material with the colours of the points, a camera that sees the mesh, light."""
    material = bpy.data.materials.new("grains")
    material.use_nodes = True
    attribute = material.node_tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = mesh.data.color_attributes[0].name
    shader = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    mesh.data.materials.clear()
    mesh.data.materials.append(material)

    corners = [mesh.matrix_world @ mathutils.Vector(c) for c in mesh.bound_box]
    center = sum(corners, mathutils.Vector()) / 8
    size = max((c - center).length for c in corners)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 2 * size
    camera.data.clip_start = size / 100
    away = mathutils.Vector((1, -1.6, 1.1)).normalized()
    camera.location = center + 4 * size * away
    camera.rotation_euler = away.to_track_quat("Z", "Y").to_euler()
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 2
    sun.rotation_euler = (0.6, 0.3, 0.4)
    bpy.context.collection.objects.link(sun)
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.6, 0.6, 0.6, 1)


def render(mesh, path, pixels, samples):
    show(mesh)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x = scene.render.resolution_y = pixels
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    source, picture = sys.argv[sys.argv.index("--") + 1:]
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    if source.lower().endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=source, forward_axis="Y", up_axis="Z")
    else:
        bpy.ops.import_mesh.ply(filepath=source)
    render(bpy.context.selected_objects[0], picture, 600, 16)
