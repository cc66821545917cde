"""The paper's figures, of our samples."""
from evaluation import methods as m
from evaluation.samples import CROPPED, balls, sintered


def side_by_side(report, pictures):
    """A table of pictures: title -> picture."""
    report.table(list(pictures), [list(pictures.values())])


def figures(report, work, sizes, scan):
    n = sizes.picture
    shape = sintered(work / "shape.vdb", n, 14, 0.6)
    m.madf("segment", shape, work / "all.vdb", "--theta", -1, "--merge", "angle",
           *m.LETTER_SEGMENT, "--keep", "manifold,balls")
    report.say("## Figure 5: medial balls and their power map",
               "The centers of the medial balls (`--keep balls`; colors: squared radii), a slice "
               "of their power map (a color per ball; drawn by this script, the program keeps only "
               "the least power), and what flows to one critical point (`--keep manifold`).")
    pictures = {"medial balls": report.picture(work / "all.vdb", "figure5-balls", "--grid", "balls",
                                               "--only", "view", "--size", 400)}
    if m.NO_NUMPY:
        pictures["power map"] = m.NO_NUMPY
    else:
        cells = m.power_cells(m.dense(work / "all.vdb", work, "--grid", "balls", "--type", "int32"),
                              n // 2)
        # thick, so that its top is shaded evenly
        m.numpy.save(work / "cells.npy", m.numpy.repeat(cells[None], 12, 0))
        pictures["power map, x-y"] = report.picture(work / "cells.npy", "figure5-power", "--only",
                                                    "view", "--size", 400, "--azimuth", 0,
                                                    "--elevation", 90)
    pictures["manifolds"] = report.picture(work / "all.vdb", "figure5-manifolds", "--grid",
                                           "manifold", "--only", "view", "--size", 400)
    side_by_side(report, pictures)

    report.say("## Figure 7: growing theta",
               "The same shape, gamma 0, merged by the angle; in brackets the number of grains. To "
               "the letter (`--adjacency cell`) only balls whose power cells touch are tested: a "
               "neck's small balls keep its two sides apart at any theta. With `--adjacency "
               "manifold` large thetas merge across true necks.")
    for adjacency in ("cell", "manifold"):
        pictures = {}
        for theta in (-1, -0.8, -0.5, 0, 0.5, 1):
            m.madf("remerge", work / "all.vdb", work / "merged.vdb", "--merge", "angle",
                   "--adjacency", adjacency, "--theta", theta, "--tidy", 0)
            grains = m.score(shape, work / "merged.vdb", work)["grains"]
            pictures[f"{adjacency}, theta {theta} ({grains})"] = report.picture(
                work / "merged.vdb", f"figure7-{adjacency}{theta}", "--only", "view", "--size", 320)
        side_by_side(report, pictures)

    report.say("## Figure 8: sets of balls",
               "Seed 1; rows 1, 4 and 5 of Table 1 (a) (rows 1 and 4: balls that meet in pairs).")
    for row in (0, 3, CROPPED):
        if row == CROPPED and m.NO_NUMPY:
            report.say(m.NO_NUMPY)
            continue
        volume = balls(work, row, 2, 1, sizes.balls)
        files = m.cut(volume, work, {k: m.BALL_METHODS[k] for k in list(m.BALL_METHODS)[::2]},
                      tune=True)
        side_by_side(report, {name: report.picture(file, f"figure8-row{row + 1}-{i}", "--size", 240)
                              for i, (name, file) in enumerate({"true grains": volume,
                                                                **files}.items())})

    report.say("## Figure 10: the methods side by side, and the interfaces alone")
    volume = sintered(work / "ten.vdb", sizes.interfaces, sizes.interface_grains, 0.7, 0.3)
    samples = [("Sintered, neck 0.7, roughness 0.3",
                {"true grains": volume, **m.cut(volume, work, m.SNOW_METHODS, tune=True)})]
    if scan:
        samples.append((scan[0], None))
    for s, (title, files) in enumerate(samples):
        report.say(f"### {title}")
        if files is None:
            files = m.cut(scan[2], work, m.SNOW_METHODS)
        whole, alone = {}, {}
        for i, (name, file) in enumerate(files.items()):
            whole[name] = report.picture(file, f"figure10-{s}-{i}", "--size", 240)
            if m.NO_NUMPY:
                continue
            grid = () if file.suffix == ".npy" else ("--grid",
                                                     "truth" if name == "true grains" else "grain",
                                                     "--type", "int32")
            m.numpy.save(work / "interfaces.npy", m.interface_voxels(m.dense(file, work, *grid)))
            alone[name] = report.picture(work / "interfaces.npy", f"figure10-{s}-{i}-interfaces",
                                         "--only", "view", "--size", 320)
        side_by_side(report, whole)
        if alone:
            side_by_side(report, alone)
        else:
            report.say(m.NO_NUMPY)
