"""The paper's tables, its figures beside ours."""
import json
import os
import statistics
import time

from evaluation import methods as m
from evaluation.samples import BALLS, CROPPED, sintered


def spread(values, digits):
    mean = f"{statistics.mean(values):.{digits}f}"
    if min(values) == max(values):
        return f"{values[0]:.{0 if isinstance(values[0], int) else digits}f}"
    ends = 0 if isinstance(values[0], int) else digits
    return f"{mean} ({min(values):.{ends}f} to {max(values):.{ends}f})"


def mean_sd(values, digits):
    values = [v for v in values if v is not None]
    if not values:
        return "none"
    return f"{statistics.mean(values):.{digits}f}, {statistics.pstdev(values):.{digits}f}"


def skipped(width):
    """Rows that say what is missing."""
    missing = [(name, m.NO_WATERSHED) for name in m.WATERSHEDS] + [("CDGS", m.NO_CDGS)]
    return [[name, why, *[""] * (width - 2)] for name, why in missing if why]


def cdgs_parameters():
    """What CDGS takes, in words."""
    if m.NO_CDGS:
        return m.NO_CDGS

    def words(its):
        return (f"windows of {', '.join(map(str, its['windows']))} voxels, tolerance "
                f"{its['tolerance']} degrees, grooves widened by {its['widen']}")
    c = m.cdgs
    styles = "; ".join(f"*{name}*, {words(its)}" for name, its in c.STYLES.items())
    return (f"*default*: {words(c.DEFAULT)}, curvature below {c.DEFAULT['threshold']} per voxel, "
            f"regions of {c.DEFAULT['least']} voxels or more. *Tuned*: to each sample the style "
            f"and threshold of the curvature whose regions on the surface match the true grains "
            f"best, of the styles {styles} and the thresholds {', '.join(map(str, c.THRESHOLDS))}. "
            f"No other method is told the true grains.")


def table1(report, done, seeds, sizes):
    report.say("## Table 1 (a): sets of balls",
               f"gamma 0, cubes of {sizes.balls}^3, radii in proportion to the paper's 300^3. "
               f"Seeds {', '.join(map(str, seeds))}: mean, and in brackets the least and the "
               f"largest. *found*: true "
               "grains that share more than half of the voxels of either with one grain. *% "
               "misclassified* as in the paper's section 6.1, which barely sees too many grains; "
               "*mirror*: the roles exchanged, which barely sees too few. The paper's rows are "
               "quoted: its sets are not public, and ours were made anew.")
    report.say("How the balls are placed matters, and the paper does not say it. Rows 1 to 4 are "
               "shown twice: balls that meet in pairs only (`generate spheres`), and balls that "
               "may pile up (`--max-cover 0`). Row 5 cannot be made by `generate spheres`, whose "
               "balls lie wholly inside the cube: of this number and these radii they would fill "
               "more than the cube. `cropped_balls.py` makes it: centers anywhere in the cube, "
               "balls cropped by it, piling up, |Bi| the part inside. Its percentages compare with "
               "the paper's only roughly.")
    for title, cover, sets in (("Balls that meet in pairs only", 2, BALLS[:CROPPED]),
                               ("Balls that may pile up", 0, BALLS)):
        rows = []
        for i, (count, low, high, overlap, quoted) in enumerate(sets):
            rows.append([f"{count}, {low}:{high}, {overlap}", "", "", "", "", ""])
            if (i, cover) not in done:
                rows[-1][1] = m.NO_NUMPY
                continue
            scores = done[i, cover]
            for name in scores[0]:
                own = [s[name] for s in scores]
                taken = sorted({s["tuned"] for s in own if "tuned" in s})
                rows.append(["", name + f" ({'; '.join(taken)})" * bool(taken),
                             *(spread([s[key] for s in own], digits) for key, digits in
                                         (("grains", 1), ("found", 1), ("percent", 2),
                                          ("mirror", 2)))])
            rows += [["", *cells] for cells in skipped(5)]
            for name, text in zip(("watershed", "CDGS", "MADF"), quoted):
                grains, percent = text.split(", ")
                rows.append(["", f"*the paper's {name}*", grains, "", percent, ""])
        report.say(f"### {title}")
        report.table(["N, radii, overlap", "method", "grains", "found", "% misclassified",
                      "mirror, %"], rows)


def fails(own):
    """In one word each, what a method does wrong on the mean of some samples; empty: nothing."""
    true = statistics.mean(s["true"] for s in own)
    wrong = []
    if statistics.mean(s["found"] for s in own) < 0.95 * true:
        wrong.append("misses")
    if statistics.mean(s["extra"] for s in own) > 0.05 * true:
        wrong.append("splits")
    if statistics.mean(s["percent"] for s in own) > 5:
        wrong.append("misplaces")
    return wrong


def table1b(report, done, sizes):
    true = statistics.mean(s["true"] for jobs in done.values() for scores, _ in jobs
                           for s in scores.values())
    report.say("## Like Table 1 (b): sintered grains with known truth",
               "The paper's MF (93 true grains: watershed 31 grains, 17.74 %; CDGS 80, 3.845 %; "
               "MADF 99, 1.834 %) is not "
               f"public. In its place `generate sintered --size {sizes.neck} --count "
               f"{sizes.neck_grains}`: necks from barely touching to "
               "deeply fused (`--neck`: the least distance of two centers over the sum of their "
               "radii; in brackets the mean ratio of bond radius to grain radius, of the true "
               "grains), rough to very rough (`--roughness`; 1: noise of 0.22 standard deviation "
               "on an indicator of 0 and 1). *To the letter, 160, -0.8*: the paper's merging with "
               "its gamma and theta for MF; *20, -0.5*: those for RG.",
               f"Each cell: true grains found of {true:g}; in brackets grains of {m.DUST} voxels "
               f"or more beyond these, and smaller "
               "ones, loose specks of the noise among them; % misclassified. Means of all seeds. "
               "**Bold**: the method breaks: it misses more than 5 % of the grains, or has more "
               "than 5 % too many of these, or more than 5 % of the voxels are misclassified.")
    names = list(next(iter(done.values()))[0][0])
    verdicts = {name: [] for name in names}
    for neck in sizes.necks:
        ratios = [ratio for _, ratio in done[neck, sizes.roughness[0]] if ratio is not None]
        ratio = f"bond to grain {statistics.mean(ratios):.2f}" if ratios else "no bonds"
        rows = []
        for name in names:
            cells = []
            for rough in sizes.roughness:
                own = [scores[name] for scores, _ in done[neck, rough]]
                mean = {key: statistics.mean(s[key] for s in own)
                        for key in ("found", "extra", "dust", "percent")}
                cell = (f"{mean['found']:.1f} ({mean['extra']:.1f}, {mean['dust']:.0f}) "
                        f"{mean['percent']:.2f} %")
                wrong = fails(own)
                cells.append(f"**{cell}**" if wrong else cell)
                if wrong:
                    verdicts[name].append(f"neck {neck}, roughness {rough} ({', '.join(wrong)})")
            rows.append([name, *cells])
        report.say(f"### Neck {neck} ({ratio})")
        report.table(["method", *(f"roughness {r}" for r in sizes.roughness)],
                     rows + skipped(1 + len(sizes.roughness)))
    report.say("### Where each breaks")
    for name in names:
        report.lines.append(
            f"- {name}: {'; '.join(verdicts[name]) if verdicts[name] else 'nowhere here'}")
    report.lines.append("")


def table2(report, done, scan):
    report.say("## Table 2: the interfaces between grains",
               "Absolute mean curvature (1/voxel), absolute Gaussian curvature (1/voxel^2) and "
               "flatness (smallest eigenvalue of the covariance of the interface's points, "
               "voxel^2) from `vdb_madf measure`: mean, standard deviation over the interfaces. "
               "Curvatures are means over an interface's points of a quadratic fit of radius 5; "
               "the paper's estimator is another, and its volumes MF and RG are not public: only "
               "the ratios between methods compare. Each interface counts once: specks have "
               "interfaces of a few voxels, flat by their size (a lower mean flatness) and without "
               "a curvature or with a poor one, so methods compare only where they have about as "
               "many. (The true interfaces of sintered balls are flat by construction.)")
    titles = ["sample", "method", "interfaces", "mean curvature", "Gaussian curvature", "flatness"]
    rows = []
    for head, result in [*((f"sintered, roughness {r}", done[r]) for r in (0, 0.3)),
                         *([(scan[0], scan[1])] if scan else [])]:
        for name, all_of in result.items():
            rows.append([head, name, len(all_of),
                         *(mean_sd([v[k] for v in all_of], digits)
                           for k, digits in enumerate((3, 5, 3)))])
            head = ""
        rows += [["", *cells] for cells in skipped(5)]
    quoted = {"MF": [("watershed", "0.055, 0.097", "0.042, 0.313", "2.861, 6.023"),
                     ("CDGS", "0.869, 0.221", "0.057, 0.757", "2.094, 4.452"),
                     ("MADF", "0.105, 0.291", "0.027, 0.171", "0.608, 1.815")],
              "RG": [("watershed", "0.102, 0.152", "0.025, 0.075", "0.368, 0.79"),
                     ("CDGS", "0.185, 1.420", "0.974, 29.834", "0.541, 1.134"),
                     ("MADF", "0.186, 0.494", "0.0845, 0.584", "0.356, 0.616")]}
    for sample, its in quoted.items():
        for head, (name, *cells) in zip((f"*the paper's {sample}*", "", ""), its):
            rows.append([head, f"*{name}*", "", *cells])
    report.table(titles, rows)


PRE = ["leaf_index", "cavities", "squared_distance", "power_map", "medial_balls", "gamma_filter",
       "flow", "manifold_graph"]


def seconds(work, volume, gamma, theta, threads, runs):
    """Medians: up to the manifold graph, merging and labels, whole segment, whole remerge."""
    results = []
    for _ in range(runs):
        m.madf("segment", volume, work / "timed.vdb", "--gamma", gamma, "--paper", "--theta", theta,
               "--keep", "manifold", "--json", work / "timed.json", threads=threads)
        r = json.loads((work / "timed.json").read_text())
        start = time.perf_counter()
        m.madf("remerge", work / "timed.vdb", work / "again.vdb", *m.LETTER, "--theta", theta,
               threads=threads)
        again = time.perf_counter() - start
        results.append([sum(r.get(f"seconds_{s}", 0) for s in PRE),
                        r["seconds_merge"] + r["seconds_tidy"] + r["seconds_labels"],
                        r["seconds_total"], again])
    return [statistics.median(column) for column in zip(*results)]


def table3(report, work, sizes, scan, runs):
    report.say("## Table 3: times",
               f"Seconds, on {os.cpu_count()} processors, median of {runs} runs (watershed and "
               f"CDGS: one), in this run, nothing beside. *Pre-process*: "
               "all up to the graph of manifolds, which another theta does not need again; "
               "*merge*: merging and labels. *Whole*: `segment` with reading and writing; *another "
               "theta*: the whole `remerge`. Watershed and CDGS (default): with the distance map, "
               "without reading and writing, one thread. The samples have the paper's sizes, gamma "
               "and theta, but not its snow.")
    rows = []
    first, second = sizes.times
    samples = [(f"sintered, {n}^3", sintered(work / f"time{i}.vdb", n, max(3, n**3 // 65000),
                                             threads=os.cpu_count()), g, t)
               for i, (n, g, t) in enumerate(((first, 160, -0.8), (second, 20, -0.5)))]
    if scan:
        samples.append((scan[0], scan[2], 20, -0.5))
    for name, volume, gamma, theta in samples:
        head = f"{name}, gamma {gamma}, theta {theta}"
        for threads in sorted({1, os.cpu_count()}):
            figures = seconds(work, volume, gamma, theta, threads, runs)
            rows.append([head, f"MADF to the letter, {threads} thread{'s' * (threads > 1)}",
                         *(f"{f:.3f}" for f in figures)])
            head = ""
        rows += [["", *cells] for cells in skipped(5)]
        solid = None if m.NO_NUMPY else m.dense(volume, work) > 0
        if not m.NO_WATERSHED:
            for kind, its in m.WATERSHEDS.items():
                rows.append(["", kind, "", "", f"{m.watershed.grains(solid, [its])[its][1]:.2f}",
                             ""])
        if not m.NO_CDGS:
            start = time.perf_counter()
            m.cdgs.grains(solid)
            rows.append(["", m.CDGS, "", "", f"{time.perf_counter() - start:.2f}", ""])
    for sample, its in {"MF, 270^3": ("416.74", "915.44", "44", "10.69"),
                        "RG, 256^3": ("330.73", "635.41", "40.16", "7.4")}.items():
        rows += [[f"*the paper's {sample} (4 processors, 2014)*", "*watershed*", "", "", its[0],
                  ""],
                 ["", "*CDGS*", "", "", its[1], ""], ["", "*MADF*", its[2], its[3], "", ""]]
    report.table(["sample", "method", "pre-process", "merge", "whole", "another theta"], rows)
