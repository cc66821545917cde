# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The specification's own JSON schemas find no fault in our OME-Zarr 0.6: images and scenes.

    ome_schemas.py COMMAND

VDB_MADF_OME_SCHEMAS names their folder, `schemas` of github.com/ome/ngff-spec at version 0.6, which
is not part of the project. Those of a release candidate (0.6rc0) are taken for those of 0.6, and it
is said.
"""

import copy
import glob
import json
import math
import os
import random
import subprocess

from proof import Bench, check, skip

try:
    import jsonschema
except ImportError:
    skip("the schemas of OME-Zarr: python3-jsonschema is not installed")
FOLDER = os.environ.get("VDB_MADF_OME_SCHEMAS", "")
if not os.path.isfile(os.path.join(FOLDER, "strict_image.schema")):
    skip("the schemas of OME-Zarr: VDB_MADF_OME_SCHEMAS names no folder with them "
         "(schemas of github.com/ome/ngff-spec)")


def read_schemas():
    """By their addresses."""
    with open(os.path.join(FOLDER, "_version.schema")) as file:
        version = json.load(file)["enum"][-1]
    check(version.split("rc")[0] == "0.6", f"the schemas are of OME-Zarr {version}, not 0.6")
    if version != "0.6":
        print(f"the schemas of {version} are taken for those of 0.6")
    schemas = {}
    for path in glob.glob(os.path.join(FOLDER, "*.schema")):
        with open(path) as file:
            schema = json.loads(file.read().replace(version, "0.6"))
        schemas[schema["$id"]] = schema
    return schemas


SCHEMAS = read_schemas()


def faults(attributes, name):
    schema = SCHEMAS[f"https://ngff.openmicroscopy.org/0.6/schemas/{name}.schema"]
    resolver = jsonschema.RefResolver.from_schema(schema, store=SCHEMAS)
    return [error.message for error in
            jsonschema.Draft202012Validator(schema, resolver=resolver).iter_errors(attributes)]


def attributes_of(group):
    with open(os.path.join(group, "zarr.json")) as file:
        return json.load(file)["attributes"]


def expect_no_faults(group, *names):
    for name in names:
        found = faults(attributes_of(group), name)
        check(not found, f"{group}: {name}.schema: {found[:3]}")


def systems_of(group):
    image = attributes_of(group)["ome"]["multiscales"][0]
    return {system["name"] for system in image["coordinateSystems"]}


def expect_known(group, transformations):
    """What transformations lead from and to is there."""
    for one in transformations:
        for end in (one["input"], one["output"]):
            check(end["name"] in systems_of(os.path.join(group, end.get("path", ""))), f"{end}")


with Bench() as bench:
    image = bench.run("export", "image.ome.zarr", "--ome", "0.6")
    expect_no_faults(image, "strict_image", "strict_ome_zarr")
    expect_no_faults(os.path.join(image, "labels", "grain"), "strict_image", "strict_label")
    multiscale = attributes_of(image)["ome"]["multiscales"][0]
    expect_known(image, multiscale["coordinateTransformations"])
    check({one["coordinateTransformations"][0]["output"]["name"] for one in multiscale["datasets"]}
          <= systems_of(image), "where the levels lead to")

    # Balls at random places, and the same turned: each motion has a transformation of its own.
    rng, centers = random.Random(3), []
    while len(centers) < 60:
        place = [rng.uniform(0, 60) for _ in range(3)]
        if all(math.dist(place, other) > 10.5 for other in centers):
            centers.append(place)
    turned = [(0.98 * x - 0.199 * y, 0.199 * x + 0.98 * y, z) for x, y, z in centers]
    for name, places in (("before", centers), ("after", turned)):
        with open(bench.path(f"{name}.txt"), "w") as file:
            file.writelines(f"{x} {y} {z} 5\n" for x, y, z in places)
        subprocess.run([bench.tool, "generate", "balls", bench.path(f"{name}.txt"),
                        bench.path(f"{name}.vdb"), "--radius", "1", "-q"], check=True)
    for motion, kind in ((None, "translation"), ("rigid", "sequence"), ("affine", "affine")):
        scene = bench.path(f"{kind}.zarr")
        subprocess.run([bench.tool, "track", bench.path("before.vdb"), bench.path("after.vdb"),
                        scene, "--before-grid", "truth", "--after-grid", "truth", "-q",
                        *(["--motion", motion] if motion else [])], check=True)
        expect_no_faults(scene, "scene")
        transformations = attributes_of(scene)["ome"]["scene"]["coordinateTransformations"]
        expect_known(scene, transformations)
        check([one["type"] for one in transformations] == [kind], f"{motion}: {transformations}")
        for side in ("before", "after"):
            expect_no_faults(os.path.join(scene, side), "strict_image")
            expect_no_faults(os.path.join(scene, side, "labels", "grain"), "strict_image",
                             "strict_label")

    # The schemas see what is broken.
    def break_version(ome):
        ome["version"] = "0.5"

    def break_systems(ome):
        del ome["multiscales"][0]["coordinateSystems"]

    def break_steps(ome):
        del ome["multiscales"][0]["datasets"][0]["coordinateTransformations"][0]["output"]

    for fault in (break_version, break_systems, break_steps):
        broken = copy.deepcopy(attributes_of(image))
        fault(broken["ome"])
        check(faults(broken, "strict_image"), f"{fault.__name__}: nothing was seen")
    print("the schemas of OME-Zarr 0.6 find no fault in images, labels and scenes")
