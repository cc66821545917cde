# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The page of a report at other strictnesses than that of its labels."""

import json
import os

import numpy
from command import command, demand, table
from saved import SAVED


def check_lives(page, strictness, grains, bonds):
    """How sure grains and bonds are, as 'measure --stability' says, as far as the slider goes."""
    column = ("const [kind, name] = arguments; return Array.from(window.report.sample[kind]"
              ".column(name), (value) => Number.isNaN(value) ? null : value)")

    def within(text, known):
        return float(text) if text and known(float(text)) else None

    lives = [(within(row["born"], lambda at: at < 14), within(row["dies"], lambda at: at >= 8))
             for row in grains]
    expected = {
        ("grains", "born"): [born for born, _ in lives],
        ("grains", "dies"): [dies for _, dies in lives],
        ("grains", "stability"): [min(6 if born is None else born - strictness,
                                      6 if dies is None else strictness - dies)
                                  for born, dies in lives],
        ("bonds", "vanishes"): [within(row["vanishes"], lambda at: at >= 8) for row in bonds],
    }
    for place, values in expected.items():
        mine = page.run(column, *place)
        demand(len(mine) == len(values) and all(
            (a is None) == (b is None) and (a is None or abs(a - b) < 1e-6)
            for a, b in zip(mine, values)), f"{place} at {strictness}: {mine}, not {values}")


AREAS = {"grains": ("area_mm2", "free_area_mm2", "shared_area_mm2", "sphericity"),
         "bonds": ("area_mm2", "radius_mm", "normal_x", "normal_z")}


def check_areas(page, kind, name, rows, strictness):
    """Areas and what is made of them are those of measure, though they are no sums."""
    mine = page.run("const [kind, name] = arguments; return Array.from(window.report.sample[kind]"
                    ".column(name), (value) => Number.isNaN(value) ? null : value)",
                    kind, name.replace("_mm2", "").replace("_mm", ""))
    worst = 0
    for value, row in zip(mine, rows):
        demand((value is None) == (row[name] == ""), f"{name} of {kind} at {strictness} is {value}")
        if value is not None:
            expected = float(row[name])
            worst = max(worst, abs(value - expected) / max(abs(expected), 1e-4))
    demand(worst < 1e-6, f"{name} of {kind} at {strictness} is off by {worst}")


def check_numbers(page, strictness):
    """The numbers at the top are those of the sample as measure has it."""
    with open("cut/sample.json", encoding="utf-8") as file:
        sample = json.load(file)
    mine = page.run("const {sample, selection} = window.report;"
                    "return sample.summary(selection.visible, selection.visibleBonds)")
    for name, expected in (("surface", sample["specific_surface_per_mm"]),
                           ("coordination", sample["mean_coordination"]),
                           ("ratio", sample["bond_to_grain_ratio"]),
                           ("solidFraction", sample["solid_fraction"])):
        demand(abs(mine[name] - expected) < 1e-5 * expected,
               f"{name} at {strictness} is {mine[name]}, not {expected}")


def check_edits(page, strictness):
    """Clicks at a strictness make a list that 'edit' replays on the labels of that one."""
    page.run("const {selection} = window.report; selection.edits = [];"
             "selection.setStrictness(arguments[0]);"
             "const bond = selection.sample.bondEnds;"
             "selection.select([bond.first[0], bond.second[0]])", strictness)
    page.button("Merge the selected").click()
    merged = page.selected()
    # The largest one beside these that has two parts; parts of it by body, in voxels of the slices.
    split = page.run(
        "const {selection, sample} = window.report, skip = new Set(arguments[0]);"
        "const sizes = sample.grains.column('voxels');"
        "for (const row of Array.from(sizes.keys()).sort((a, b) => sizes[b] - sizes[a])) {"
        "  if (skip.has(sample.ids[row])) continue;"
        "  selection.select([row]); if (selection.parts) return sample.ids[row];"
        "} return 0", merged)
    demand(split > 0, f"no grain at {strictness} has two parts")
    page.run("document.getElementById('grain').scrollIntoView({block: 'center'})")
    page.find("#parts").click()
    second = set(page.run("return [...window.report.selection.secondPart]"))
    page.button("Split it so").click()
    page.run("window.report.selection.setStrictness(null)")
    demand(not page.button("Drop the selected").is_enabled() and page.find(
        "#edits .warning").is_displayed(), "the list takes edits of two strictnesses")
    page.run(SAVED)
    page.run("[...document.querySelectorAll('#edits button')].find((button) => "
             "button.textContent === 'Save edits.txt').click()")
    text = page.wait("return window.saved")
    demand(text == f"strictness {strictness}\nmerge {merged[0]} {merged[1]}\nsplit {split}\n",
           f"the list is {text!r}")
    with open("clicked.txt", "w") as file:
        file.write(text)
    refusal = command("edit", "k.vdb", "no.vdb", "--edits", "clicked.txt", refused=True)
    demand(f"remerge --strictness {strictness}" in refusal, f"edit says {refusal!r}")
    command("remerge", "k.vdb", "cut.vdb", "--strictness", str(strictness), "--tidy", "0", "-q")
    command("edit", "cut.vdb", "clicked.vdb", "--edits", "clicked.txt", "-q")
    for name in ("cut", "clicked"):
        command("convert", f"{name}.vdb", f"{name}.npy", "--grid", "grain", "-q")
    cut, clicked = numpy.load("cut.npy"), numpy.load("clicked.npy")
    bodies = numpy.array(page.run(
        "const {sample} = window.report, {size} = sample.about.slices, bodies = [];"
        "for (let k = 0; k < size[2]; ++k) for (let j = 0; j < size[1]; ++j)"
        "for (let i = 0; i < size[0]; ++i) bodies.push(sample.bodyAt(i, j, k) - 1); return bodies"
    )).reshape(cut.shape)
    expected = numpy.where(cut == merged[1], merged[0], cut)
    beyond = numpy.isin(bodies, list(second)) & (cut == split)
    sides = [set(numpy.unique(clicked[side])) for side in (beyond, (cut == split) & ~beyond)]
    demand(beyond.any() and len(sides[0]) == len(sides[1]) == 1 and sides[0] != sides[1],
           f"edit splits grain {split} elsewhere than the page: {sides}")
    rest = cut != split
    demand((clicked[rest] == expected[rest]).all(), "edit merges others than the page")


def check_strictness(page, folder):
    """At each strictness the slices, tables and numbers have the grains of remerge. Leaves the page
    at the last one, whose labels it returns."""
    command("generate", "snow", "n.vdb", "--size", "72", "--voxel-size", "10um", "-q")
    command("segment", "n.vdb", "k.vdb", "--keep", "manifold", "-q")
    out = os.path.join(folder, "slider.html")
    command("report", "k.vdb", out, "--min-faces", "4", "-q")
    complaints = page.open(out, "unit=mm")
    demand(not complaints, f"the page with a slider: {complaints}")
    command("measure", "k.vdb", "own", "--min-faces", "4", "--stability", "-q")
    check_lives(page, 11, table("own/grains.csv"), table("own/bonds.csv"))
    own = [int(row["voxels"]) for row in table("own/grains.csv")]
    voxels = "return Array.from(window.report.sample.grains.column('voxels'))"
    demand(page.run(voxels) == own, "the page has not the grains of the labels")
    slider = page.find("#strictness")
    page.button("Largest").click()
    selected = page.selected()
    counts = set()
    for strictness in [8, *(round(8.2 + 0.3 * step, 1) for step in range(18)), 14]:
        command("remerge", "k.vdb", "m.vdb", "--strictness", str(strictness), "--tidy", "0", "-q")
        command("measure", "m.vdb", "cut", "--min-faces", "4", "--stability", "-q")
        command("convert", "m.vdb", "m.npy", "--grid", "grain", "-q")
        grains, bonds = table("cut/grains.csv"), table("cut/bonds.csv")
        page.run("const [slider, value] = arguments; slider.value = value;"
                 "slider.dispatchEvent(new Event('input'))", slider, round(10 * strictness))
        counts.add(len(grains))
        demand(page.run(voxels) == [int(row["voxels"]) for row in grains],
               f"grains at {strictness} are not those of remerge")
        names = ["first", "second", "faces"]
        pairs = page.run("const {bonds} = window.report.sample;"
                         "return arguments[0].map((name) => Array.from(bonds.column(name)))", names)
        demand(pairs == [[int(row[name]) for row in bonds] for name in names],
               f"bonds at {strictness} are not those of remerge")
        for name in ("equivalent_diameter", "centroid_y", "inscribed_radius", "axis2_length",
                     "axis1_z", "aspect_3_to_2", "box_min_x", "at_domain_face", "coordination"):
            unit = "_mm" if name + "_mm" in grains[0] else ""
            mine = page.run("return Array.from(window.report.sample.grains.column(arguments[0]))",
                            name)
            worst = max(abs(a - float(row[name + unit])) for a, row in zip(mine, grains))
            demand(worst < 1e-6, f"{name} at {strictness} is off by {worst}")
        for kind, rows in (("grains", grains), ("bonds", bonds)):
            for name in AREAS[kind]:
                check_areas(page, kind, name, rows, strictness)
        check_lives(page, strictness, grains, bonds)
        check_numbers(page, strictness)
        labels = numpy.load("m.npy")
        shown = page.run(
            "const {sample} = window.report, {size} = sample.about.slices, rows = [];"
            "for (let k = 0; k < size[2]; ++k) for (let j = 0; j < size[1]; ++j)"
            "for (let i = 0; i < size[0]; ++i) rows.push(sample.rowAt(i, j, k) + 1); return rows")
        demand(shown == labels.ravel().tolist(), f"slices at {strictness} are not those of remerge")
        page.wait(f"return document.querySelector('#table-grains_info').textContent.trim()."
                  f"endsWith('of {len(grains)}')")
        demand(page.find("#shown").text.startswith(f"{len(grains)} of {len(grains)} grains"),
               f"at {strictness} the page says: {page.find('#shown').text}")
        demand(len(page.selected()) == 1, f"at {strictness} {page.selected()} are selected")
    demand(len(counts) > 2, f"the slider changes nothing: {counts}")
    page.run("window.report.selection.setOnly(true)")
    shown = ("const {sample, selection} = window.report; return Array.from(sample.ids)"
             ".filter((_, row) => selection.visible[row])")
    for strictness in (14, 8):
        page.run("window.report.selection.setStrictness(arguments[0])", strictness)
        demand(page.run(shown) == page.selected() and len(page.selected()) == 1,
               f"at {strictness} {page.run(shown)} pass, not {page.selected()}")
    page.run("window.report.selection.setOnly(false)")
    back = page.button("As in the labels")
    back.click()
    demand(page.run(voxels) == own and page.selected() == selected,
           "the grains of the labels do not come again")
    check_edits(page, 9.3)
    page.run("window.report.selection.setStrictness(14); window.report.selection.select([])")
    return labels
