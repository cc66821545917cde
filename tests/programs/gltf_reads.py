# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The validator of glTF by Khronos (npm install -g gltf-validator) finds no fault in our files.

Blender, in blender_reads.py, finds the grains in them at their places.
"""

import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from proof import SIZE, Bench, check, skip  # noqa: E402

VALIDATE = """
const validator = require('gltf-validator'), fs = require('fs');
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))
  .then(report => console.log(JSON.stringify(report)));
"""


def environment():
    """One in which node finds the validator, here or among what npm has installed for all."""
    if not shutil.which("node"):
        skip("what the validator of glTF says: node is not installed")
    paths = [os.environ.get("NODE_PATH", "")]
    if shutil.which("npm"):
        paths.append(subprocess.run(["npm", "root", "-g"], capture_output=True,
                                    text=True).stdout.strip())
    result = dict(os.environ, NODE_PATH=os.pathsep.join(path for path in paths if path))
    if subprocess.run(["node", "-e", "require('gltf-validator')"], env=result,
                      capture_output=True).returncode:
        skip("what the validator of glTF says: node does not find it (npm install -g "
             "gltf-validator)")
    return result


def main():
    node = environment()
    with Bench() as bench:
        with open(bench.path("none.raw"), "wb") as file:
            file.write(bytes(4 * SIZE[0] * SIZE[1] * SIZE[2]))
        bench.segment_sintered(60, 10)
        files = [bench.run("export", "exact.glb", "--smooth", "0"),
                 bench.run("export", "smooth.glb"),
                 bench.run("export", "none.glb", source="none.raw"),
                 bench.run("export", "grains.glb", source="grains.vdb")]
        meshes = 0
        for path in files:
            answer = subprocess.run(["node", "-e", VALIDATE, path], env=node, check=True,
                                    capture_output=True, text=True)
            report = json.loads(answer.stdout)
            issues = report["issues"]
            faults = issues["numErrors"] + issues["numWarnings"] + issues["numInfos"]
            check(faults == 0, f"{os.path.basename(path)}: {issues['messages'][:5]}")
            meshes += report["info"]["drawCallCount"]
    check(meshes > 10, f"the validator saw {meshes} meshes")
    print(f"the validator of glTF finds no fault in {len(files)} files of {meshes} grains")


if __name__ == "__main__":
    main()
