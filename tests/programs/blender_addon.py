# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Blender, without a display, installs our add-on and imports labels by it: an object a grain.

Runs itself again inside Blender.
"""

import os
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from proof import EDGE, LABELS, VOXELS, Bench, box_of, check, near, run_in_blender  # noqa: E402

try:
    import bpy
except ImportError:
    bpy = None
else:
    import blender_picture

ADDON = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                     "../../tools/doors/blender_vdb_madf.py")


def start():
    with Bench() as bench:
        bench.run("edit", "labels.vdb", "--min-voxels", "1")
        os.environ["BLENDER_USER_SCRIPTS"] = bench.path("scripts")
        os.environ["VDB_MADF"] = bench.tool
        print(run_in_blender(__file__, bench.folder, "what the add-on for Blender imports"))
        # By the command line, as the manual has it.
        line = ["blender", "--background", "--factory-startup", "-noaudio", "--python", ADDON, "--"]
        done = subprocess.run(line + ["labels.vdb", "grains.blend", "voxels", "bonds"],
                              cwd=bench.folder, capture_output=True, text=True,
                              env=dict(os.environ, PATH="/usr/bin:" + os.environ["PATH"]))
        check(os.path.exists(bench.path("grains.blend")), done.stdout + done.stderr)
        for wrong in (["labels.vdb"], ["labels.vdb", "no/such/place.blend"]):
            done = subprocess.run(line + wrong, cwd=bench.folder, capture_output=True, text=True,
                                  env=dict(os.environ, PATH="/usr/bin:" + os.environ["PATH"]))
            check(done.returncode == 1 and "Traceback" not in done.stderr,
                  f"{done.returncode}: {done.stderr}")


def refused(**settings):
    try:
        bpy.ops.import_scene.vdb_madf(**settings)
    except RuntimeError as error:
        return str(error)
    sys.exit(f"FAILED: {settings} was taken")


def place_of(label):
    places = [place for place, other in LABELS.items() if other == label]
    return [EDGE * sum(place[axis] for place in places) / len(places) for axis in range(3)]


def check_grains(collection):
    grains = {thing.name: thing for thing in collection.objects if thing.type == "MESH"}
    check(set(grains) == {f"grain_{label:06d}" for label in VOXELS}, f"there are {sorted(grains)}")
    for label, count in VOXELS.items():
        grain = grains[f"grain_{label:06d}"]
        place = list(grain.matrix_world.translation)
        check(near(place, place_of(label)), f"the pivot of grain {label} lies at {place}")
        points = [grain.matrix_world @ vertex.co for vertex in grain.data.vertices]
        bounds = [which(point[axis] for point in points) for axis in range(3)
                  for which in (min, max)]
        check(near(bounds, box_of(label)), f"grain {label} lies at {bounds}")
        check(grain["grain_id"] == label and grain["voxels"] == count and
              abs(grain["volume"] - count * EDGE**3) < 1e-12, f"grain {label} has {dict(grain)}")
    return [grains[f"grain_{label:06d}"] for label in sorted(VOXELS)]


def inside(folder):
    bpy.ops.preferences.addon_install(filepath=ADDON)
    bpy.ops.preferences.addon_enable(module="blender_vdb_madf")
    preferences = bpy.context.preferences.addons["blender_vdb_madf"].preferences
    path = os.path.join(folder, "labels.vdb")
    preferences.command = "no_such_command"
    check("say in the preferences" in refused(filepath=path), refused(filepath=path))
    preferences.command = os.environ["VDB_MADF"]
    said = refused(filepath=os.path.join(folder, "missing.vdb"))
    check("missing.vdb" in said and "Traceback" not in said, said)
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    said = refused(filepath=path, measure="weight")
    check("weight" in said and "volume" in said, said)
    check(not bpy.data.objects and not bpy.data.collections.get("labels"), "something is left")

    bpy.ops.import_scene.vdb_madf(filepath=path, smoothing=0)
    grains = check_grains(bpy.data.collections[-1])
    colors = {tuple(grain.color) for grain in grains}
    check(len(colors) == len(VOXELS), f"{len(colors)} colors")
    for grain in grains:
        bpy.data.objects.remove(grain)

    bpy.ops.import_scene.vdb_madf(filepath=path, smoothing=0, measure="voxels", bonds=True)
    collection = bpy.data.collections[-1]
    grains = check_grains(collection)
    check(len({grain.data.materials[0] for grain in grains}) == 1, "more than one material")
    curve, = (thing for thing in collection.objects if thing.type == "CURVE")
    lines = curve.data.splines
    check(len(lines) == 1 and len(lines[0].points) == 2, f"{len(lines)} bonds")
    for point, label in zip(lines[0].points, (2, 3)):
        check(near(list(point.co[:3]), place_of(label)), f"a bond ends at {list(point.co)}")
        check(point.radius > EDGE / 2, f"a bond is {point.radius} thick")

    # The least is violet, the largest yellow; the colors are those of the measure, not of a place.
    bpy.data.objects.remove(curve)
    found = {}
    for grain in grains:
        for other in grains:
            other.hide_render = other is not grain
        picture = os.path.join(folder, "grain.png")
        bpy.context.view_layer.update()
        blender_picture.render_export(grain, picture, 32, 4)
        for thing in list(bpy.data.objects):
            if thing.type in ("CAMERA", "LIGHT"):
                bpy.data.objects.remove(thing)
        hues = [hue for hue in blender_picture.hues(picture, 12) if hue is not None]
        found[int(grain["voxels"])] = max(set(hues), key=hues.count)
    check(found[max(found)] in (1, 2) and found[min(found)] in (8, 9, 10) and
          found[2] not in (found[1], found[4]), f"hues by voxels: {found}")
    bpy.ops.preferences.addon_disable(module="blender_vdb_madf")
    print("DONE: Blender has an object a grain, with pivot, measures, material by a measure, bonds")


if __name__ == "__main__":
    if bpy:
        inside(sys.argv[sys.argv.index("--") + 1])
    else:
        start()
