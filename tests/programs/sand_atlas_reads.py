# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What the Sand Atlas takes of a folder of ours: its voxels, meshes, table and page.

    sand_atlas_reads.py COMMAND

Voxels are read by OpenVDB's Python as its scripts do, and are those that its pipeline would cut
out of the same labels, with their numbers; columns are computed again by its definitions in NumPy,
SciPy and scikit-image. VDB_MADF_SAND_ATLAS names a folder with checkouts of
github.com/scigem/sand-atlas-python and github.com/scigem/sand-atlas, neither of which is part of
the project: then the script of the first, vdb_to_npy.py, and functions of its vdb.py run
themselves, and Jekyll makes the page with the second.
"""

import ast
import csv
import html.parser
import json
import os
import shutil
import subprocess
import sys

from proof import Bench, check, skip

try:
    import numpy as np
    import pyopenvdb as openvdb
    from scipy import ndimage, spatial
except ImportError as error:
    skip(f"what the Sand Atlas reads: {error} (tools/setup --tests --programs)")

HEADER = ["Particle ID", "Volume (µm³)", "Equivalent Diameter (µm)", "Major Axis Length (µm)",
          "Middle Axis Length (µm)", "Minor Axis Length (µm)", "True Sphericity (-)",
          "Convexity (-)", "Flatness (-)", "Elongation (-)", "Compactness (-)"]
QUALITIES = ("ORIGINAL", "100", "30", "10", "3")
MICRONS = 10
CHECKOUTS = os.environ.get("VDB_MADF_SAND_ATLAS", "")


def away_from_faces(labels):
    """Voxels of each grain that its pipeline keeps, in its order, cut out with one voxel around."""
    bodies = []
    for label, box in enumerate(ndimage.find_objects(labels), 1):
        if box is None or any(part.start == 0 or part.stop == side
                              for part, side in zip(box, labels.shape)):
            continue
        bodies.append(np.pad(labels[box] == label, 1))
    return bodies


def half_axes(body):
    """Of the ellipsoid of the same moments, by those of the centers of voxels, longest first."""
    places = np.argwhere(body)
    moments = np.cov(places.T, bias=True)
    return np.sqrt(5 * np.sort(np.linalg.eigvalsh(moments))[::-1])


def convex_voxels(body):
    """Voxels whose centers lie in the hull of those of the body."""
    places = np.argwhere(body)
    hull = spatial.ConvexHull(places)
    inside = spatial.Delaunay(places[hull.vertices]).find_simplex(np.argwhere(body | True))
    return np.count_nonzero(inside >= 0)


def read_stl(path):
    with open(path, "rb") as file:
        data = file.read()
    check(not data.startswith(b"solid"), f"{path}: text")
    rows = np.frombuffer(data, offset=84, dtype=np.dtype([("normal", "<f4", 3),
                                                          ("corners", "<f4", (3, 3)), ("", "<u2")]))
    check(len(rows) == int.from_bytes(data[80:84], "little"), f"{path}: number of triangles")
    return rows["corners"].astype(float)


def check_mesh(corners, voxels, what):
    """Closed, of the volume of the voxels, its center of volume at the origin; lengths in mm."""
    _, points = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    faces = points.reshape(-1, 3)
    edges = np.concatenate([faces[:, [i, (i + 1) % 3]] for i in range(3)])
    edges = edges[edges[:, 0] != edges[:, 1]]
    ways = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, number = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    check(not np.bincount(number.ravel(), weights=ways).any(), f"{what}: not closed")
    parts = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    volume = voxels * (MICRONS / 1000) ** 3
    check(abs(parts.sum() / volume - 1) < 1e-3, f"{what}: volume {parts.sum()}, not {volume}")
    center = (parts[:, None] * corners.sum(axis=1)).sum(axis=0) / 4 / parts.sum()
    check(np.abs(center).max() < 1e-4 * np.cbrt(volume), f"{what}: center {center}")


def check_facets(folder, name, body):
    """Sides of facets are what so many across the smallest axis take."""
    across = 2 * half_axes(body)[2] * MICRONS / 1000
    last = np.inf
    for quality in QUALITIES[1:]:
        corners = read_stl(f"{folder}/stl_{quality}/{name}.stl")
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0],
                                        corners[:, 2] - corners[:, 0]), axis=1) / 2
        found = across / np.sqrt(areas.sum() / (len(areas) / 2))
        wanted = min(int(quality), across / (MICRONS / 1000) / 0.25)
        check(0.8 * wanted < found < 1.5 * wanted, f"{name}: {found} facets across, not {wanted}")
        check(len(corners) < last, f"{name}: {quality} is no coarser")
        last = len(corners)


def read_table(path):
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    check(rows[0] == HEADER, f"columns {rows[0]}")
    return np.array([[float(cell) if cell else np.nan for cell in row] for row in rows[1:]])


def check_columns(row, body):
    """The pipeline's definitions. Its areas are those of another surface, its hull that of the
    centers of voxels, and its axes are of these, too: near, not equal."""
    voxels = np.count_nonzero(body)
    check(abs(row[1] / (voxels * MICRONS ** 3) - 1) < 1e-8, f"volume {row[1]}")
    check(abs(row[2] / (MICRONS * np.cbrt(6 * voxels / np.pi)) - 1) < 1e-8, f"diameter {row[2]}")
    axes = 2 * half_axes(body)
    cubes = np.sqrt(axes ** 2 + 5 / 3)  # of moments of voxels, not of their centers
    check(np.allclose(row[3:6], MICRONS * cubes, rtol=1e-7), f"axes {row[3:6]}")
    check(np.allclose(row[8:10], [cubes[2] / cubes[1], cubes[1] / cubes[0]], rtol=1e-7),
          f"flatness and elongation {row[8:10]}")
    differences = [abs(row[3 + i] / MICRONS / axes[i] - 1) for i in range(3)]
    differences.append(row[7] / (voxels / convex_voxels(body)) - 1)
    try:
        from skimage import measure
    except ImportError:
        return differences, None
    smooth = ndimage.gaussian_filter(np.pad(body, 2).astype("<f4"), sigma=0.75)
    points, faces = measure.marching_cubes(smooth, level=0.5)[:2]
    area = measure.mesh_surface_area(points, faces)
    sphericity = np.cbrt(36 * np.pi * voxels ** 2) / area
    compactness = 36 * np.pi * voxels ** 2 / area ** 3
    return differences, (row[6] / sphericity - 1, row[10] / compactness - 1)


def check_voxels(path, body):
    grid = openvdb.read(path, "density")
    check(grid.gridClass == "fog volume" and grid.background == 0, f"{path}: {grid.gridClass}")
    check(grid.transform.voxelSize() == (1, 1, 1), f"{path}: voxel size")
    low, high = grid.evalActiveVoxelBoundingBox()
    check(low == (1, 1, 1) and high == tuple(side - 2 for side in body.shape), f"{path}: box")
    array = np.zeros(body.shape)
    grid.copyToArray(array)
    check(np.array_equal(array, body), f"{path}: voxels")


def run_vdb_to_npy(bench, path, body):
    """Its script takes the array from the origin on, and as much of it as the active box is long,
    less one: the last two layers along each axis are not in it, of its own files either."""
    script = os.path.join(CHECKOUTS, "sand-atlas-python/sand_atlas/blender_scripts/vdb_to_npy.py")
    program = ("import sys, types, pyopenvdb\n"
               "sys.modules['openvdb'] = pyopenvdb  # as Blender calls it\n"
               "sys.modules['bpy'] = types.ModuleType('bpy')  # is imported, and not used\n"
               f"exec(open({script!r}).read())\n")
    subprocess.run([sys.executable, "-c", program, "", "", "", "", path], check=True,
                   cwd=bench.folder)
    array = np.load(bench.path(os.path.basename(path)[:-4] + ".npy"))
    check(np.array_equal(array, body[:-3, :-3, :-3]), f"vdb_to_npy.py: {path}")


def run_vdb_functions(body, row):
    """The function that Blender's script of the pipeline takes the smallest axis from."""
    path = os.path.join(CHECKOUTS, "sand-atlas-python/sand_atlas/blender_scripts/vdb.py")
    with open(path) as file:
        tree = ast.parse(file.read())
    tree.body = [part for part in tree.body if isinstance(part, ast.FunctionDef)]
    names = {"numpy": np}
    exec(compile(tree, path, "exec"), names)
    smallest = 2 * min(names["ellipse_axes"](body))
    check(abs(MICRONS * smallest / row[5] - 1) < 0.02, f"smallest axis {smallest}, {row[5]}")


class Words(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.words = []
        self.feed(text)

    def handle_data(self, data):
        self.words += data.split()


def make_page(bench, name, particles):
    """The site, with our sand alone among its data."""
    site = bench.path("site")
    shutil.copytree(os.path.join(CHECKOUTS, "sand-atlas"), site,
                    ignore=shutil.ignore_patterns(".git", "sands", "json", "*.jpg", "*.png"))
    os.makedirs(f"{site}/_data/json")
    os.makedirs(f"{site}/assets/sands")
    shutil.copy(bench.path(f"{name}/{name}.json"), f"{site}/_data/json")
    shutil.copy(bench.path(f"{name}/{name}.csv"), f"{site}/assets/sands")
    os.remove(f"{site}/Gemfile")  # Jekyll and its plugins are those of the system
    result = subprocess.run(["jekyll", "build", "-s", site, "-d", bench.path("made")],
                            capture_output=True, text=True, env={**os.environ, "LANG": "C.UTF-8"})
    check(result.returncode == 0, f"Jekyll: {result.stdout}{result.stderr}")
    with open(bench.path(f"made/sands/{name}/index.html"), encoding="utf-8") as file:
        page = file.read()
    text = " ".join(Words(page).words)
    check(f"surfaces of {particles} individual sand grains with a voxel size of 10.0 microns"
          in text, "the page of the sand")
    check(f"/assets/sands/{name}.csv" in page, "the page's link to the table")
    check(os.path.isfile(bench.path(f"made/assets/sands/{name}.csv")), "the table on the site")
    for blank in ("publication", "original data here", "Source data is licensed", "Contributor:"):
        check(blank not in text, f"a blank of the JSON is shown: {blank}")


with Bench() as bench:
    subprocess.run([bench.tool, "generate", "sintered", bench.path("sample.vdb"), "--size", "110",
                    "--count", "50", "--voxel-size", "10um", "-q"], check=True)
    bench.run("segment", "grains.vdb", source="sample.vdb")
    bench.run("convert", "grains.npy", source="grains.vdb")
    folder = bench.run("export", "sand-0000001", "--as", "sandatlas", source="grains.vdb")
    bodies = away_from_faces(np.load(bench.path("grains.npy")).transpose())  # [x, y, z]
    table = read_table(f"{folder}/sand-0000001.csv")
    check(len(bodies) == len(table) > 4, f"{len(table)} particles, not {len(bodies)}")
    check(np.array_equal(table[:, 0], np.arange(1, len(table) + 1)), "numbers")
    with open(f"{folder}/sand-0000001.json", encoding="utf-8") as file:
        about = json.load(file)
    check(about["number_of_particles"] == len(bodies), "number in the JSON")
    check(float(about["microns_per_pixel"]) == MICRONS, "voxel size in the JSON")
    check(sorted(os.listdir(folder)) == sorted(
        ["vdb", "sand-0000001.csv", "sand-0000001.json"] + [f"stl_{q}" for q in QUALITIES]),
        f"{os.listdir(folder)}")
    axes, areas = [], []
    for number, body in enumerate(bodies, 1):
        name = f"particle_{number:05}"
        check_voxels(f"{folder}/vdb/{name}.vdb", body)
        for quality in QUALITIES:
            check_mesh(read_stl(f"{folder}/stl_{quality}/{name}.stl"), np.count_nonzero(body),
                       f"{quality}/{name}")
        check_facets(folder, name, body)
        near, areal = check_columns(table[number - 1], body)
        axes.append(near)
        areas.append(areal)
    axes = np.array(axes)
    print(f"{len(bodies)} particles: axes differ from the pipeline's by at most "
          f"{100 * axes[:, :3].max():.2f} %, convexities by {100 * axes[:, 3].min():.1f} to "
          f"{100 * axes[:, 3].max():.1f} %")
    if areas[0] is None:
        print("SKIPPED: sphericity and compactness by the pipeline's definition: scikit-image is "
              "not installed")
    else:
        areas = 100 * np.array(areas)
        print(f"sphericities differ by {areas[:, 0].min():.1f} to {areas[:, 0].max():.1f} %, "
              f"compactnesses by {areas[:, 1].min():.1f} to {areas[:, 1].max():.1f} %")
        check(np.abs(areas[:, 0]).max() < 5, "sphericities")
    if os.path.isdir(os.path.join(CHECKOUTS, "sand-atlas-python", "sand_atlas")):
        run_vdb_to_npy(bench, f"{folder}/vdb/particle_00002.vdb", bodies[1])
        run_vdb_functions(bodies[1], table[1])
        print("vdb_to_npy.py and the functions of vdb.py take our particles")
    else:
        print("SKIPPED: the pipeline's own scripts: VDB_MADF_SAND_ATLAS names no folder with "
              "sand-atlas-python")
    site = os.path.join(CHECKOUTS, "sand-atlas", "_data")
    if not shutil.which("jekyll") or not os.path.isdir(site):
        print("SKIPPED: the page of the Sand Atlas: VDB_MADF_SAND_ATLAS names no folder with "
              "sand-atlas, or jekyll is not installed")
    else:
        make_page(bench, "sand-0000001", len(bodies))
        print("Jekyll makes the page of the sand")
