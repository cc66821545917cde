# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""The report in a browser: it asks for nothing, and what it shows, selects and filters are the
labels and tables of the command. Chromium draws without a graphics card, so this takes longer than
other tests."""

import json
import os
import tempfile

from browser import Page
from command import command, demand, table
from proof import skip

try:
    import numpy
except ImportError as error:
    skip(f"reports in a browser: python3-numpy is not installed ({error})")

from choosing import check_clicks, check_filters, check_links, check_only, check_state  # noqa: E402
from figures import check_biases, check_doubts, check_tiles  # noqa: E402
from saved import check_pictures, check_still  # noqa: E402
from scan import check_scan  # noqa: E402
from several import check_comparison, check_series  # noqa: E402
from strictness import check_strictness  # noqa: E402


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
        check_only(page, path)
        check_tiles(page, grains, bonds)
        check_doubts(page, grains, bonds)
        check_pictures(page)
        check_looks(page, path)
        check_state(page, path, "l.vdb", folder)
        check_scan(page, folder)
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
        check_still(page)
        page.button("Largest").click()
        demand(len(page.selected()) == 1, "nothing is selected without WebGL")
print(f"{len(grains)} grains were clicked, filtered and linked")
