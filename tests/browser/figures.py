# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The numbers of the page of a report, and how sure they are."""

import json
import math

import numpy
from command import demand


def check_biases(page):
    """The page says which numbers the grains are too small for, as the tables do."""
    with open("tables/sample.json") as file:
        biases = json.load(file)["expected_bias_percent"]
    told = page.find("#warnings").text.replace("\u2212", "-")
    for name, bias in biases.items():
        said = f"{name.replace('_', ' ')} {bias:+d} %"
        demand(said in told, f"the page does not say {said}: {told}")


def check_tiles(page, grains, bonds):
    """Numbers at the top are those of what passes the filters."""
    voxels = sorted(int(row["voxels"]) for row in grains)
    least = voxels[len(voxels) // 2]
    page.run("window.report.selection.setFilter('grains', 'voxels', [arguments[0], Infinity])",
             least)
    kept = [row for row in grains if int(row["voxels"]) >= least]
    shown = [node.text.replace("\n", " ") for node in page.find("#numbers").find_elements(
        "css selector", ".tile")]
    demand(shown[0].startswith(f"{len(kept)} of all {len(grains)} "), f"a tile says {shown[0]}")
    mean = sum(int(row["coordination"]) for row in kept) / len(kept)
    demand(abs(float(shown[2].split()[0]) - mean) < 0.006 * mean, f"bonds a grain: {shown[2]}")
    surface = sum(float(row["free_area_mm2"]) for row in kept) / sum(
        float(row["volume_mm3"]) for row in kept)
    demand(abs(float(shown[6].split()[0]) - surface) < 0.006 * surface,
           f"specific surface: {shown[6]}, not {surface}")
    # Bonds that do not pass count for no grain.
    faces = sorted(int(row["faces"]) for row in bonds)
    least = faces[len(faces) // 2]
    page.run("window.report.selection.clearFilters();"
             "window.report.selection.setFilter('bonds', 'faces', [arguments[0], Infinity])", least)
    mean = 2 * sum(count >= least for count in faces) / len(grains)
    shown = page.find("#numbers").find_elements("css selector", ".tile")[2].text
    demand(abs(float(shown.split()[0]) - mean) < 0.006 * mean,
           f"bonds a grain: {shown}, not {mean}")
    page.run("window.report.selection.clearFilters()")
    demand("of all" not in page.find("#numbers").text, "without filters numbers are those of all")


def check_doubts(page, grains, bonds):
    """Whiskers are two standard errors: of counts, and in roses as drawing bonds again says."""
    bars, whiskers = page.run(
        "const plot = document.querySelector('#charts svg'), of = (node, name) => "
        "Number(node.getAttribute(name));"
        "return [[...plot.querySelectorAll('rect.shown')].map((bar) => of(bar, 'height')),"
        "[...plot.querySelectorAll('.whisker')].map((line) => of(line, 'y1') - of(line, 'y2'))]")
    one = sum(bars) / len(grains)
    expected = [(2 * math.sqrt(n) + min(n, 2 * math.sqrt(n))) * one for n in
                (height / one for height in bars)]
    demand(len(whiskers) == len(bars) > 4 and numpy.allclose(whiskers, expected, atol=0.01),
           f"whiskers of counts are {whiskers}, not {expected}")

    # The sectors between 0 and 90 degrees from z come first.
    radii, ends = page.run(
        "const rose = document.querySelectorAll('#charts svg.rose')[1];"
        "const places = [...rose.querySelectorAll('.whisker')].map((path) => "
        "path.getAttribute('d').match(/[0-9.-]+/g).map(Number));"
        "return [[...rose.querySelectorAll('path.shown')].map((path) => "
        "Number(path.getAttribute('d').match(/A([0-9.]+)/)[1])),"
        "places.map(([, , x, y]) => Math.hypot(x - 105, y - 105))]")
    heights = numpy.array([abs(float(row["normal_z"])) for row in bonds])
    areas = numpy.array([float(row["area_mm2"]) for row in bonds])
    sectors = numpy.minimum(8, (numpy.degrees(numpy.arccos(numpy.minimum(1, heights))) / 10)
                            .astype(int))
    draws = numpy.random.default_rng(3).integers(0, len(bonds), (4000, len(bonds)))
    filled = [i for i in range(9) if (sectors == i).any()]
    many = [i for i in filled if (sectors == i).sum() >= 6]
    demand(len(radii) == 4 * len(filled) and many, f"the rose has {len(radii)} sectors")
    for i in many:
        share = (areas * (sectors == i))[draws].sum(axis=1) / areas[draws].sum(axis=1)
        expected = 1 + 2 * share.std() / ((areas * (sectors == i)).sum() / areas.sum())
        place = filled.index(i)
        demand(abs(ends[place] / radii[place] - expected) < 0.15 * (expected - 1),
               f"the whisker of sector {i} ends at {ends[place] / radii[place]}, not {expected}")
