# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The gray scan under the slices of the page of a report."""

import os

import numpy
from command import command, demand

# The pixels of the slice x-y: red, green, blue and how much they cover.
PIXELS = """
const canvas = document.querySelector('#slices canvas');
return Array.from(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data);
"""


def expected_grays(scan, factor, levels):
    """Means of blocks, half a percent of them black, half a percent white, from 0 to levels - 1."""
    shape = [-(-side // factor) for side in scan.shape]
    sums, counts = numpy.zeros(shape), numpy.zeros(shape)
    for dz, dy, dx in numpy.ndindex(factor, factor, factor):
        part = scan[dz::factor, dy::factor, dx::factor]
        place = tuple(slice(0, side) for side in part.shape)
        sums[place] += part
        counts[place] += 1
    means = sums / counts
    ordered = numpy.sort(means.ravel())
    clipped = len(ordered) // 200
    low, high = ordered[clipped], ordered[-1 - clipped]
    share = numpy.clip((means - low) / (high - low), 0, 1)
    return numpy.floor(255 * share + 0.5).astype(int) * levels // 256


def check_scan(page, folder):
    """Slices show the scan, outlines at the rims of grains, or the grains."""
    command("convert", "s.vdb", "o.npy", "--grid", "object", "-q")
    solid = numpy.load("o.npy") != 0
    noise = numpy.random.default_rng(5).integers(0, 8000, solid.shape)
    scan = (20000 + 30000 * solid + noise).astype(numpy.uint16)
    numpy.save("scan.npy", scan)
    out = os.path.join(folder, "scan.html")
    for factor, side in ((3, 30), (1, 256)):
        command("report", "l.vdb", out, "--overlay", "scan.npy", "--max-dim", str(side), "-q")
        complaints = page.open(out, "show=scan")
        demand(not complaints, f"the page with a scan: {complaints}")
        told = page.run("return window.report.sample.about.gray")
        demand(told == {"scan": "scan.npy", "levels": 32}, f"the page has {told}")
        grays = expected_grays(scan, factor, told["levels"])
        demand(numpy.abs(numpy.array(page.run("return Array.from(window.report.sample.gray)"))
                         - grays.ravel()).max() <= (0 if factor == 1 else 1), "other grays")
        layer = page.run("return window.report.selection.slices[2]")
        shown = numpy.array(page.run(PIXELS)).reshape(*grays.shape[1:], 4)
        demand((numpy.abs(shown[..., :3] - grays[layer][..., None] * 255 / 31) < 10).all()
               and (shown[..., 3] == 255).all(), "slices show something else than the scan")
    rows = numpy.array(page.run(
        "const {sample, selection} = window.report, {size} = sample.about.slices, rows = [];"
        "for (let j = 0; j < size[1]; ++j) for (let i = 0; i < size[0]; ++i)"
        "rows.push(sample.rowAt(i, j, selection.slices[2])); return rows")).reshape(shown.shape[:2])
    padded = numpy.pad(rows, 1, mode="edge")
    rims = (rows >= 0) & ((padded[:-2, 1:-1] != rows) | (padded[2:, 1:-1] != rows) |
                          (padded[1:-1, :-2] != rows) | (padded[1:-1, 2:] != rows))
    colors = numpy.array(page.run("return Array.from(window.report.sample.colors)")).reshape(-1, 3)
    page.run("const shown = document.getElementById('slices-as'); shown.value = 'outlines';"
             "shown.dispatchEvent(new Event('input'))")
    lined = numpy.array(page.run(PIXELS)).reshape(shown.shape)[..., :3]
    demand(rims.any() and (lined[rims] == colors[rows[rims]]).all(), "rims have other colors")
    demand((lined[~rims] == shown[~rims][:, :3]).all(), "outlines hide the scan")
    page.wait("return !location.hash.includes('show=')")
    page.open(out, "show=grains")
    filled = numpy.array(page.run(PIXELS)).reshape(shown.shape)
    demand((filled[rows >= 0][:, :3] == colors[rows[rows >= 0]]).all() and
           (filled[rows < 0] == 0).all(), "grains are not shown as without a scan")
