# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The report in a browser: it asks for nothing, and what it shows, selects and filters are the
labels and tables of the command. Chromium draws without a graphics card, so this takes longer than
other tests."""

import json
import math
import os
import random
import tempfile

from browser import Page
from command import command, demand, table
from proof import skip

try:
    import numpy
except ImportError as error:
    skip(f"reports in a browser: python3-numpy is not installed ({error})")

from strictness import check_strictness  # noqa: E402

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


def check_biases(page):
    """The page says which numbers the grains are too small for, as the tables do."""
    with open("tables/sample.json") as file:
        biases = json.load(file)["expected_bias_percent"]
    told = page.find("#warnings").text.replace("\u2212", "-")
    for name, bias in biases.items():
        said = f"{name.replace('_', ' ')} {bias:+d} %"
        demand(said in told, f"the page does not say {said}: {told}")


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


def check_tiles(page, grains):
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


def check_looks(page, path):
    """Light, dark and paper; view and controls on one screen; one unit, and another."""
    ground = "return getComputedStyle(document.body).backgroundColor"
    light, dark = "rgb(255, 255, 255)", page.run(
        "document.documentElement.dataset.theme = 'dark';" + ground)
    demand(dark != light, "dark is light")
    page.screen(1400, 900, color_scheme="dark")
    page.open(path)
    demand(page.run(ground) == dark, "a reader who wishes it dark gets it light")
    bottoms = page.run("return ['stage', 'controls', 'strictness', 'numbers'].map((id) => "
                       "document.getElementById(id)).filter(Boolean)"
                       ".map((node) => node.getBoundingClientRect().bottom)")
    demand(max(bottoms) <= 900, f"view and controls end at {bottoms}, below 900 pixels")
    page.screen(1400, 900, color_scheme="dark", media="print")
    demand(page.run(ground) == light, "paper is dark")
    page.screen(390, 844, color_scheme="dark")
    demand(page.run("return document.documentElement.scrollWidth") <= 390,
           "a phone has to scroll to the right")
    page.screen(1400, 900)
    demand(page.run(ground) == light, "the page does not follow the system")
    page.button("Dark").click()
    page.wait("return location.hash.includes('theme=dark')")
    page.open(path, page.run("return location.hash.slice(1)"))
    demand(page.run(ground) == dark, "the theme of an address is passed over")
    page.button("Light").click()

    column = "return Array.from(window.report.sample.grains.column('volume'))"
    before = page.run(column)
    page.run("window.report.selection.setFilter('grains', 'equivalent_diameter', [0.15, 0.2])")
    told = page.find("#shown").text
    page.run("const unit = document.getElementById('unit'); unit.value = 'um';"
             "unit.dispatchEvent(new Event('change'))")
    page.wait("return window.report && window.report.sample.shownUnit === 'um'")
    demand(numpy.allclose(page.run(column), numpy.array(before) * 1e9, rtol=1e-12),
           "volumes in cubic micrometers")
    demand(page.find("#shown").text == told, "another unit filters other grains")
    texts = page.run("return ['numbers', 'origin', 'charts', 'tables', 'grain', 'controls', "
                     "'overlay'].map((id) => document.getElementById(id).textContent).join(' ')")
    demand("\u00b5m\u00b3" in texts and " mm" not in texts and "(mm" not in texts,
           "there are two units in the page")
    page.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def check_frame(page, folder):
    """In a frame of another page a report begins at its view, and that page stays where it is."""
    with open("frame.html", "w", encoding="utf-8") as file:
        file.write('<p style="height: 400px">Above</p>'
                   '<iframe src="r.html" width="800" height="500"></iframe><p>Below</p>')
    page.driver.get(f"file://{folder}/frame.html")
    page.driver.switch_to.frame(0)
    page.wait("return document.documentElement.dataset.ready")
    top = page.run("return document.getElementById('view').getBoundingClientRect().top")
    page.driver.switch_to.default_content()
    demand(abs(top) < 2, f"in a frame the view is {top} pixels off its upper edge")
    demand(page.run("return window.scrollY") == 0, "a report moves the page around it")


def check_odd_samples(page, folder):
    """Pages of samples that lack something, or have something large."""
    raw = os.path.join(folder, "odd.raw")
    samples = {
        "no grain": {}, "one grain": {(3, 3, 3): 1, (4, 3, 3): 1},
        "no bond": {(1, 1, 1): 1, (5, 5, 5): 2},
        "large numbers": {(1, 1, 1): 70000, (2, 1, 1): 70000, (3, 1, 1): 2147483647},
    }
    for name, voxels in samples.items():
        values = numpy.zeros((8, 7, 6), numpy.int32)
        for (x, y, z), label in voxels.items():
            values[z, y, x] = label
        values.tofile(raw)
        out = os.path.join(folder, "odd.html")
        command("report", raw, out, "--dims", "6x7x8", "--type", "int32", "-q",
                "--title", f"{name} </script><script>boom()</script> & <b>", "--domain",
                "0,0,0:5,6,7")
        complaints = page.open(out)
        demand(not complaints, f"the page of {name}: {complaints}")
        demand(page.run("return document.documentElement.dataset.ready") == "yes",
               f"the page of {name} is not shown")
        demand(page.find("h1").text.startswith(f"{name} </script>"),
               f"the title of the page of {name}")
        shown = page.find("#shown").text
        demand(f"of {len(set(voxels.values()))} grains" in shown, f"the page of {name} has {shown}")
        if name == "large numbers":
            page.button("Largest").click()
            demand(page.selected() == [70000], "numbers beyond 16 bits")


def check_crossings(page, folder):
    """Bonds have the colors of what flows through them."""
    out = os.path.join(folder, "crossing.html")
    command("report", "l.vdb", out, "--crossing", "-q")
    command("measure", "l.vdb", "crossed", "--crossing", "-q")
    expected = table("crossed/bonds.csv")
    complaints = page.open(out, "bonds=discs&bondcolor=current_z")
    demand(not complaints, f"the page of crossings: {complaints}")
    for name in ("current_z", "cut_z"):
        shown = page.run(f"return Array.from(window.report.sample.bonds.column('{name}'))")
        demand(numpy.allclose(shown, [float(row[name]) for row in expected]), name)
    demand(max(float(row["current_z"]) for row in expected) > 0.01, "nothing flows")
    page.wait("return document.getElementById('overlay').textContent.includes('current, z')")
    with open(os.path.join(folder, "crossed", "sample.json"), encoding="utf-8") as file:
        numbers = json.load(file)
    shown = [float(f"{100 * numbers[f'bond_conductivity_{axis}']:.3g}") for axis in "xyz"]
    found = [tile for tile in page.find("#numbers").text.split("\n") if tile.count(", ") == 2]
    demand([float(n) for n in found[0].split(", ")] == shown, f"conductivity: {found}, not {shown}")
    curves = page.find("#charts").find_elements("css selector", "figure .rose path.steps")
    demand(len(curves) == 3, f"{len(curves)} curves of the tensor")


def check_comparison(page, folder, labels, grains):
    """Two samples side by side, the second one larger grains alone."""
    command("edit", labels, "large.vdb", "--min-voxels", "800", "-q")
    out = os.path.join(folder, "both.html")
    command("report", labels, "large.vdb", out, "-q")
    complaints = page.open(out)
    demand(not complaints, f"the page of two samples: {complaints}")
    cells = [cell.text for cell in page.find("#numbers tbody tr").find_elements("css selector",
                                                                                "td")]
    large = sum(int(row["voxels"]) >= 800 for row in grains)
    demand(cells == [str(len(grains)), str(large)], f"two samples have {cells} grains")
    lines = page.find("#charts").find_elements("css selector", ".steps")
    demand(len(lines) == 12, f"there are {len(lines)} lines in the distributions of two samples")


def check_series(page, folder):
    """Two scans of a sample, the first of which has a grain that is not in the second."""
    command("generate", "particles", "p.vdb", "--size", "56", "--count", "30", "--radius", "6:8",
            "--voxel-size", "10um", "-q")
    command("edit", "p.vdb", "all.vdb", "--grid", "truth", "--drop-at-faces", "-q")
    command("measure", "all.vdb", "before", "--grid", "truth", "-q")
    rows = table("before/grains.csv")
    gone, stays = rows[0]["id"], rows[1]["id"]
    command("edit", "all.vdb", "later.vdb", "--grid", "truth", "--drop", gone, "-q")
    out = os.path.join(folder, "series.html")
    refusal = command("report", "all.vdb", out, "--series", refused=True)
    demand("two scans" in refusal, f"a series of one scan: {refusal}")
    command("report", "all.vdb", "later.vdb", out, "--series", "-q")
    complaints = page.open(out)
    demand(not complaints, f"the page of a series: {complaints}")
    colors = ("const {sample} = window.report, row = sample.rowOf.get(Number(arguments[0]));"
              "return Array.from(sample.colors.slice(3 * row, 3 * row + 3))")
    first = page.run(colors, stays)
    curves = ("return [...document.querySelectorAll('#history figure path.points')].map("
              "(path) => path.getAttribute('d').split('M').length - 1)")
    demand(page.run(curves) == [2, 2, 2, 2], "the sample has no curves of two scans")
    for wanted, count in ((gone, 1), (stays, 2)):
        page.run("const {selection, sample} = window.report;"
                 "selection.select([sample.rowOf.get(Number(arguments[0]))])", wanted)
        demand(page.run(curves) == [count] * 4, f"grain {wanted}: {page.run(curves)}")
    page.run("const {selection, sample} = window.report;"
             "selection.select([sample.rowOf.get(Number(arguments[0]))]);"
             "selection.setFilter('grains', 'voxels', [100, 1e6])", gone)
    page.run("window.isOld = true")
    page.button("Later").click()
    page.wait("return !window.isOld && document.documentElement.dataset.ready === 'yes'")
    demand(page.run("return window.report.sample.count") == len(rows) - 1, "it is the same scan")
    demand(page.run("return window.report.selection.filterCount") == 1, "the filter is gone")
    demand(f"Grain {gone} is not in this scan" in page.find("#levels").text, "nothing is missed")
    demand(page.run(curves) == [1] * 4, "the grain that is gone has lost its curves")
    demand(page.run(colors, stays) == first, "a grain has another color in the next scan")
    with open("given.csv", "w", encoding="utf-8") as file:
        file.write(f"grain,heat\n{stays},7.5\n")
    command("report", "all.vdb", "given.html", "--with", "given.csv", "-q")
    demand(not page.button("Later").is_enabled() and page.button("Earlier").is_enabled(),
           "there is no way back")
    page.open(os.path.join(folder, "given.html"), "color=heat")
    given = page.run(
        "const {sample, selection} = window.report, row = sample.rowOf.get(Number(arguments[0]));"
        "return selection.colorBy === 'heat' && sample.grains.column('heat')[row]", stays)
    demand(given == 7.5, "a given column is not in the page")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    command("generate", "sintered", "s.vdb", "--size", "64", "--count", "30", "--radius", "7:11",
            "--voxel-size", "10um", "-q")
    command("segment", "s.vdb", "l.vdb", "-q")
    command("sweep", "s.vdb", "sweep.csv", "--merge", "score,both", "--strictness", "9:11:1",
            "--theta", "-0.9,-0.7", "-q")
    refusal = command("report", "l.vdb", "r.html", "--sweep", "sweep.csv", refused=True)
    if "cannot be written by this program" in refusal:
        skip("reports in a browser: built without esbuild, libjs-three and libjs-jquery-datatables")
    command("measure", "l.vdb", "tables", "-q")
    command("convert", "l.vdb", "l.npy", "--grid", "grain", "-q")
    labels, grains, bonds = numpy.load("l.npy"), table("tables/grains.csv"), table(
        "tables/bonds.csv")
    path = os.path.join(folder, "r.html")
    with Page() as page:
        complaints = page.open(path)
        demand(not complaints, f"the page complains: {complaints}")
        demand(len(page.find("#charts").find_elements("css selector", ".steps")) >= 3,
               "the sweep is not plotted")
        check_biases(page)
        check_clicks(page, labels)
        check_filters(page, grains)
        check_links(page, grains, bonds)
        check_tiles(page, grains)
        check_doubts(page, grains, bonds)
        check_looks(page, path)
        check_state(page, path, "l.vdb", folder)
        check_comparison(page, folder, "l.vdb", grains)
        check_series(page, folder)
        check_crossings(page, folder)
        check_frame(page, folder)
        check_clicks(page, check_strictness(page, folder))
        check_odd_samples(page, folder)
    with Page("--disable-3d-apis") as page:
        complaints = [text for text in page.open(path) if "WebGL" not in text]
        demand(not complaints, f"the page without WebGL complains: {complaints}")
        demand(page.run("const p = document.getElementById('picture');"
                        "return p.complete && p.naturalWidth > 100 && p.offsetWidth > 100"),
                        "no picture without WebGL")
        page.button("Largest").click()
        demand(len(page.selected()) == 1, "nothing is selected without WebGL")
print(f"{len(grains)} grains were clicked, filtered and linked")
