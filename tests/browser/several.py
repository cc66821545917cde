# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Pages of several samples: side by side, and scans of one in a series."""

import os

from command import command, demand, table


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
             "selection.setFilter('grains', 'voxels', [100, 1e6]); selection.setOnly(true)", gone)
    page.run("window.isOld = true")
    page.button("Later").click()
    page.wait("return !window.isOld && document.documentElement.dataset.ready === 'yes'")
    demand(page.run("return window.report.sample.count") == len(rows) - 1, "it is the same scan")
    demand(page.run("return window.report.selection.filterCount") == 2, "a filter is gone")
    demand(page.find("#shown").text.startswith("0 of "), "others than the selected are shown")
    demand(f"Grain {gone} is not in this scan" in page.find("#levels").text, "nothing is missed")
    demand(page.run(curves) == [1] * 4, "the grain that is gone has lost its curves")
    demand(page.run(colors, stays) == first, "a grain has another color in the next scan")
    with open("given.csv", "w", encoding="utf-8") as file:
        file.write(f"grain,heat,constructor\n{stays},7.5,2\n")
    command("report", "all.vdb", "given.html", "--with", "given.csv", "-q")
    demand(not page.button("Later").is_enabled() and page.button("Earlier").is_enabled(),
           "there is no way back")
    page.open(os.path.join(folder, "given.html"), "color=heat")
    given = page.run(
        "const {sample, selection} = window.report, row = sample.rowOf.get(Number(arguments[0]));"
        "return selection.colorBy === 'heat' && sample.grains.column('heat')[row]", stays)
    demand(given == 7.5, "a given column is not in the page")
    page.open(os.path.join(folder, "given.html"), "color=constructor")
    title = page.run("return window.report.sample.titleWithUnit('grains', 'constructor')")
    demand(title == "constructor", f"a column is called {title!r}")
