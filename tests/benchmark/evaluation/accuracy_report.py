"""accuracy.md and accuracy.csv of tests/benchmark/accuracy."""
import csv
import statistics

from evaluation import finney, methods as m, watershed
from evaluation.accuracy_methods import (METHODS, OURS, RIVALS, SECTION_DUST, SECTION_LEAST, SLIVER,
                                         TRUTH)
from evaluation.report import Report

COLUMNS = {"found, %": ("found_percent", 1), "spurious, %": ("spurious_percent", 1),
           "missed, %": ("missed_percent", 1), "misclassified, %": ("misclassified_percent", 2),
           "ARI": ("adjusted_rand_index", 3), "VI, bits": ("variation_of_information_bits", 3),
           "crumbs": ("crumbs", 1), "slivers": ("slivers", 1), "large": ("large", 1),
           "in pieces": ("in_pieces", 1), "flatness, voxel^2": ("flatness_voxel2", 3)}
FOUND, VI = "found_percent", "variation_of_information_bits"


def average(runs, name, key):
    values = [run[name][key] for run in runs if name in run and run[name][key] is not None]
    return statistics.mean(values) if values else None


def mean(runs, name, key, digits):
    value = average(runs, name, key)
    return "" if value is None else f"{value:.{digits}f}"


def brief(runs, name):
    found, spurious, misclassified, information = (mean(runs, name, *COLUMNS[title]) for title in (
        "found, %", "spurious, %", "misclassified, %", "VI, bits"))
    return f"{found}, {spurious}; {misclassified}; {information}" if found else ""


def best(runs):
    """Of the rivals that ran in a group the one of least VI, and the one that finds most."""
    there = [name for name in RIVALS if average(runs, name, VI) is not None]
    if not there:
        return "", ""
    least = min(there, key=lambda name: average(runs, name, VI))
    most = max(there, key=lambda name: (average(runs, name, FOUND), name == least))
    return least, most


def rivals(runs):
    least, most = best(runs)
    return [f"{least}: {brief(runs, least)}" if least else "",
            f"{most}: {brief(runs, most)}" if most != least else ""]


def write(folder, done, seeds, quick, methods):
    """Of done: a list of sets, seeds and what judge() returned of the METHODS, or why it was
    skipped. Returns the table by group."""
    names = METHODS[methods]
    groups = {}
    skipped = {}
    for its, seed, result in done:
        if isinstance(result, str):
            skipped.setdefault(its.group, {})[its.name] = result
        else:
            groups.setdefault(its.group, []).append((its, seed, result))
    runs = {group: [result for _, _, result in those] for group, those in groups.items()}
    report = Report(folder, "accuracy.md")
    edge = 100 if quick else 140
    report.say(
        "# How right the grains are",
        f"Samples with known grains, of {edge}^3 voxels where no other size is said (packs: "
        f"{finney.EDGE:g} radii), seed "
        f"{' and '.join(map(str, seeds))}. Seed "
        f"1 is for choosing (our defaults; h = {watershed.H:g} voxels of the h-maxima), other "
        f"seeds are for showing. All other "
        "parameters of the watersheds are those published or common; nothing is tuned to a group. "
        "Figures are means over a group's sets and seeds.",
        "*found*: true grains that share more than half of the voxels of either with one grain; "
        f"*missed*: the others; *spurious*: grains of {m.DUST} voxels or more that match no true "
        "one; in % of the true grains. *ARI*: adjusted Rand index. *VI*: variation of information. "
        f"Grains in a sample: *crumbs* of fewer than {m.DUST} voxels that touch another grain; "
        f"*slivers* of {SLIVER} voxels or more that touch another grain and have no voxel whose 26 "
        f"neighbors are all of the grain; *large* ones of {m.DUST} voxels or more; grains *in "
        "pieces* (6-connected). In sections, which are one voxel thick, spurious and large grains "
        f"have {SECTION_DUST} pixels or more, crumbs fewer, and true grains count from "
        f"{SECTION_LEAST} on. *Flatness*: mean smallest eigenvalue of the "
        "interfaces, less is flatter; it should be the truth's. *Holes filled*: pieces of "
        f"background of fewer than {watershed.CAVITY} voxels were filled before.",
        "## By group", "*found, spurious; misclassified; VI*; of the watersheds and CDGS those "
        "with the least VI and, where it is another, with the most found:")
    start = len(report.lines)
    report.table(["group", *OURS, "least VI of the others", "most found of the others"],
                 [[group, *(brief(its, name) for name in OURS), *rivals(its)]
                  for group, its in runs.items()])
    by_group = "\n".join(report.lines[start:])
    report.say("## All methods", "*found, spurious; misclassified; VI*:")
    report.table(["method", *groups], [[name, *(brief(its, name) for its in runs.values())]
                                       for name in names])
    for group in dict.fromkeys([its.group for its, _, _ in done]):
        report.say(f"## {group[0].upper()}{group[1:]}")
        if group in groups:
            sets = dict.fromkeys(its.describe(quick) for its, _, _ in groups[group])
            true = mean(runs[group], TRUTH, "true", 1)
            report.say(f"{'; '.join(sets)}. True grains: {true} a sample.")
            report.table(["method", *COLUMNS],
                         [[name, *(mean(runs[group], name, *column)
                                   for column in COLUMNS.values())]
                          for name in (TRUTH, *names)])
        for name, reason in skipped.get(group, {}).items():
            report.say(f"{name}: {reason}.")
    report.write()
    write_runs(folder, done)
    return by_group


def cell(value):
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else value


def write_runs(folder, done):
    rows = [{"group": its.group, "set": its.name, "seed": seed, "method": name,
             **{key: cell(value) for key, value in figures.items()}}
            for its, seed, result in done if not isinstance(result, str)
            for name, figures in result.items()]
    with open(folder / "accuracy.csv.part", "w", newline="") as file:
        lines = csv.DictWriter(file, rows[0].keys() if rows else [], lineterminator="\n")
        lines.writeheader()
        lines.writerows(rows)
    (folder / "accuracy.csv.part").rename(folder / "accuracy.csv")
