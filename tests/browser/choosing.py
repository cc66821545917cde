# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""What is clicked, filtered and linked in the page of a report, and what its address keeps."""

import math
import os
import random

import numpy
from command import command, demand
from saved import SAVED

random.seed(17)


class View:
    """Where rays through the pixels of the view meet the labels: the voxels are walked along in
    short steps."""

    def __init__(self, page, labels):
        self.labels = labels  # [z, y, x]
        size = page.run("const s = document.getElementById('stage'); return [s.clientWidth, "
                        "s.clientHeight]")
        self.width, self.height = size
        self.shape = numpy.array(labels.shape[::-1])
        azimuth, elevation, zoom = page.run(
            "const c = window.report.camera; return [c.azimuth, c.elevation, c.zoom]")
        a, e = math.radians(azimuth), math.radians(elevation)
        self.right = numpy.array([math.cos(a), math.sin(a), 0])
        self.along = numpy.array([-math.sin(a) * math.cos(e), math.cos(a) * math.cos(e),
                                  -math.sin(e)])
        self.up = numpy.cross(self.right, self.along)
        self.diagonal = math.sqrt((self.shape ** 2).sum())
        self.scale = zoom * min(size) / self.diagonal

    def pixel(self, voxel):
        """The pixel of a voxel x, y, z."""
        place = numpy.array(voxel) - (self.shape - 1) / 2
        return (self.width / 2 + place @ self.right * self.scale,
                self.height / 2 - place @ self.up * self.scale)

    def label(self, x, y):
        """What the ray through a place sees; 0: nothing."""
        start = ((x - self.width / 2) * self.right - (y - self.height / 2) * self.up) / self.scale
        steps = numpy.arange(-self.diagonal / 2, self.diagonal / 2, 0.05)
        places = numpy.rint(start + steps[:, None] * self.along + (self.shape - 1) / 2).astype(int)
        inside = ((places >= 0) & (places < self.shape)).all(axis=1)
        seen = self.labels[places[inside][:, 2], places[inside][:, 1], places[inside][:, 0]]
        return int(seen[seen > 0][0]) if (seen > 0).any() else 0

    def clear_label(self, x, y):
        """The same, where all rays a voxel or so around see it; none otherwise."""
        reach = 1.3 * self.scale
        around = {self.label(x + dx * reach, y + dy * reach) for dx, dy in
                  ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (0.7, 0.7), (0.7, -0.7), (-0.7, 0.7),
                   (-0.7, -0.7))}
        return around.pop() if len(around) == 1 else None


def check_clicks(page, labels):
    """Twenty random pixels; then each grain by itself."""
    view = View(page, labels)
    done = set()
    while len(done) < 20:
        x, y = random.randrange(view.width // 5,
                                4 * view.width // 5), random.randrange(view.height // 5,
                                                                       4 * view.height // 5)
        expected = view.clear_label(x + 0.5, y + 0.5)
        if not expected or (x, y) in done:
            continue
        done.add((x, y))
        page.run("window.report.selection.select([])")
        page.click_at("#stage", x, y)
        demand(page.selected() == [expected],
               f"a click at {x}, {y} selects {page.selected()}, not {expected}")
    for label in numpy.unique(labels[labels > 0]):
        page.run("const {selection} = window.report; selection.select([]);"
                 "selection.setFilter('grains', 'id', [arguments[0], arguments[0]])", int(label))
        voxels = numpy.argwhere(labels == label)[:, ::-1]
        middle = voxels[((voxels - voxels.mean(axis=0)) ** 2).sum(axis=1).argmin()]
        page.click_at("#stage", *view.pixel(middle))
        demand(page.selected() == [int(label)],
               f"grain {label} cannot be clicked alone: {page.selected()}")
    page.run("window.report.selection.clearFilters(); window.report.selection.select([])")


def check_filters(page, grains):
    """What is typed in a table, dragged in a chart and ticked is what the CSV says."""
    diameters = [float(row["equivalent_diameter_mm"]) for row in grains]
    low = sorted(diameters)[len(diameters) // 3]
    field = page.find("input[aria-label='Range of diameter (mm)']")
    page.run("arguments[0].scrollIntoView({block: 'center'})", field)
    field.send_keys(f"{low!r}:\n")
    expected = sum(value >= low for value in diameters)
    told = page.find("#shown").text
    demand(told.startswith(f"{expected} of {len(grains)} grains"),
           f"{expected} grains pass, the page says: {told}")
    demand(
        page.run(
            "return Array.from(window.report.selection.states).filter(Boolean).length") == expected,
           "the view shows other grains than the table")
    page.button("Clear filters").click()
    demand("goes from" not in page.find("#shown").text, "a range is told without a filter")
    field = page.find("input[aria-label='Range of diameter (mm)']")
    field.send_keys("12:\n")  # micrometers are meant
    told = page.find("#shown").text
    demand(told.startswith("0 of ") and "; diameter (mm) goes from 0." in told,
           f"no grain has 12 mm, the page says: {told}")
    page.button("Clear filters").click()

    page.drag(page.find("#charts svg.drag"), (0.5, 0.5), (0.95, 0.4))
    [[name, [low, high]]] = page.run("return [...window.report.selection.filters.grains]")
    expected = sum(low <= value <= high for value in diameters)
    demand(name == "equivalent_diameter" and 0 < expected < len(grains),
           f"a drag in a chart filters {name}, {low}, {high}")
    demand(page.find("#shown").text.startswith(f"{expected} of "),
           "a drag in a chart filters other grains")
    page.button("Clear filters").click()

    page.find("#inside").click()
    expected = sum(row["at_domain_face"] == "0" for row in grains)
    demand(page.find("#shown").text.startswith(f"{expected} of "),
           "'inside only' shows other grains")
    page.button("Clear filters").click()


def check_links(page, grains, bonds):
    """Largest grain: its card has its bonds; its row is marked; slices go through it."""
    page.button("Largest").click()
    largest = max(grains, key=lambda row: float(row["equivalent_diameter_mm"]))["id"]
    demand(page.selected() == [int(largest)], "'Largest' selects another grain")
    partners = sorted(int(row["second"] if row["first"] == largest else row["first"])
                      for row in bonds if largest in (row["first"], row["second"]))
    shown = sorted(int(node.text) for node in page.find("#grain").find_elements("css selector",
                                                                                "td .link"))
    demand(shown == partners, f"the card of grain {largest} has bonds with {shown}, not {partners}")
    chosen = [row.text.split(
        )[0] for row in page.find("#table-grains").find_elements("css selector", "tr.chosen")]
    demand(chosen == [largest], f"the rows {chosen} are marked")
    row = page.find("#table-grains tbody tr:nth-child(3)")
    page.run("arguments[0].focus()", row)
    row.send_keys("\n")
    demand(page.selected() == [int(row.text.split()[0])], "Enter does not select a row")
    page.find("body").send_keys("\ue00c")
    demand(page.selected() == [], "Escape does not clear the selection")


def check_only(page, path):
    """What is selected is a filter: numbers and lines are those of its grains and of the bonds
    between them, whatever is selected later, until it is taken back; a link keeps it."""
    with open("tables/grains.csv") as file:
        lines = file.read().split("\n")
    with open("tables/bonds.csv") as file:
        bonds = file.read().split("\n")[1:-1]
    pairs = [line.split(",")[:2] for line in bonds]
    chosen = {*pairs[0], *pairs[1]}
    demand(not page.find("#tables .only input").is_enabled(), "what is not selected can be shown")
    page.run("const {selection, sample} = window.report; selection.select("
             "arguments[0].map((id) => sample.rowOf.get(id)))", [int(id) for id in chosen])
    page.run("document.getElementById('grain').scrollIntoView({block: 'center'})")
    page.find("#grain .only input").click()
    page.find("body").send_keys("\ue00c")
    between = sum(chosen.issuperset(pair) for pair in pairs)
    told = (f"{len(chosen)} of {len(lines) - 2} grains, {between} of {len(pairs)} bonds")
    demand(page.find("#shown").text == told, f"{told}: the page says {page.find('#shown').text}")
    demand(page.find("#numbers .tile").text.startswith(f"{len(chosen)}\nof all"),
           "the numbers are not those of the selected")
    page.wait("return location.hash.includes('only=')")
    complaints = page.open(path, page.run("return location.hash.slice(1)"))
    demand(not complaints and page.find("#shown").text == told, f"a link says {complaints}, "
           f"{page.find('#shown').text}")
    page.run(SAVED)
    page.button("Save as CSV").click()
    expected = [lines[0]] + [line for line in lines[1:] if line.split(",")[0] in chosen] + [""]
    demand(page.wait("return window.saved") == "\n".join(expected), "other lines are saved")
    page.find("#tables .only input").click()
    demand(page.find("#shown").text.startswith(f"{len(lines) - 2} of "), "all do not come back")


def check_state(page, path, labels_path, folder):
    """Keys turn; the address keeps the state; corrections are such that 'edit' takes."""
    page.find("#stage").send_keys("\ue014")  # to the right
    page.run("const {selection} = window.report; selection.select([0, 1]); selection.cuts = [1, "
             "0.5, 1];selection.changed('cuts')")
    page.button("Merge the selected").click()
    page.wait("return location.hash.includes('edit=') && location.hash.includes('grains=')")
    state = page.run("const {selection, camera} = window.report; return [camera.azimuth, "
                     "selection.cuts, [...selection.selected], selection.edits]")
    complaints = page.open(path, page.run("return location.hash.slice(1)"))
    demand(not complaints, f"the page with a state: {complaints}")
    again = page.run("const {selection, camera} = window.report; return [camera.azimuth, "
                     "selection.cuts, [...selection.selected], selection.edits]")
    demand(again == state and state[0] == 30, f"the state {state} became {again}")
    edits = os.path.join(folder, "edits.txt")
    with open(edits, "w") as file:
        file.write("\n".join(state[3]) + "\n")
    command("edit", labels_path, os.path.join(folder, "edited.vdb"), "--edits", edits, "-q")
