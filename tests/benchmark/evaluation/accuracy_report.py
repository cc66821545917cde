"""accuracy.md and accuracy.csv of tests/benchmark/accuracy."""
import csv
import statistics

from evaluation import watershed
from evaluation.accuracy_methods import TRUTH
from evaluation.report import Report

COLUMNS = {"found, %": ("found_percent", 1), "spurious, %": ("spurious_percent", 1),
           "missed, %": ("missed_percent", 1), "misclassified, %": ("misclassified_percent", 2),
           "ARI": ("adjusted_rand_index", 3), "VI, bits": ("variation_of_information_bits", 3),
           "crumbs": ("crumbs", 1), "slivers": ("slivers", 1), "in pieces": ("in_pieces", 1),
           "flatness, voxel^2": ("flatness_voxel2", 3)}


def mean(runs, key, digits):
    values = [run[key] for run in runs if run[key] is not None]
    return f"{statistics.mean(values):.{digits}f}" if values else ""


def brief(runs):
    found, spurious, misclassified, information = (mean(runs, *COLUMNS[title]) for title in (
        "found, %", "spurious, %", "misclassified, %", "VI, bits"))
    return f"{found}, {spurious}; {misclassified}; {information}"


def write(folder, done, seeds, quick, methods):
    """Of done: a list of sets, seeds and what judge() returned of the methods, or why it was
    skipped."""
    groups = {}
    skipped = {}
    for its, seed, result in done:
        if isinstance(result, str):
            skipped.setdefault(its.group, {})[its.name] = result
        else:
            groups.setdefault(its.group, []).append((its, seed, result))
    report = Report(folder, "accuracy.md")
    edge = 100 if quick else 140
    report.say(
        "# How right the grains are",
        f"Samples of {edge}^3 voxels with known grains, seed {' and '.join(map(str, seeds))}. Seed "
        f"1 is for choosing (our defaults; h = {watershed.H:g} voxels of the h-maxima), other "
        f"seeds are for showing. All other "
        "parameters of the watersheds are those published or common; nothing is tuned to a group. "
        "Figures are means over a group's sets and seeds.",
        "*found*: true grains that share more than half of the voxels of either with one grain; "
        "*missed*: the others; *spurious*: grains of 100 voxels or more that match no true one; in "
        "% of the true grains. *ARI*: adjusted Rand index. *VI*: variation of information. Grains "
        "in a sample: *crumbs* of fewer than 100 voxels that touch another grain; *slivers* of 20 "
        "voxels or more that touch another grain and have no voxel whose 26 neighbors are all of "
        "the grain; grains *in pieces* (6-connected). *Flatness*: mean smallest eigenvalue of the "
        "interfaces, less is flatter; it should be the truth's. *Holes filled*: cavities of fewer "
        "than "
        f"{watershed.CAVITY} voxels were filled before.",
        "## Summary", "*found, spurious; misclassified; VI*:")
    report.table(["method", *groups], [[name,
                                        *(brief([r[name] for _, _, r in runs])
                                          for runs in groups.values())]
                                       for name in methods])
    for group in dict.fromkeys([its.group for its, _, _ in done]):
        report.say(f"## {group[0].upper()}{group[1:]}")
        if group in groups:
            write_group(report, groups[group], quick, methods)
        for name, reason in skipped.get(group, {}).items():
            report.say(f"{name}: {reason}.")
    report.write()
    write_runs(folder, done)


def write_group(report, runs, quick, methods):
    sets = dict.fromkeys(describe(its, quick) for its, _, _ in runs)
    true = mean([r[TRUTH] for _, _, r in runs], "true", 1)
    report.say(f"{'; '.join(sets)}. True grains: {true} a sample.")
    report.table(["method", *COLUMNS],
                 [[name, *(mean([r[name] for _, _, r in runs], *column)
                           for column in COLUMNS.values())]
                  for name in (TRUTH, *methods)])


def describe(its, quick):
    count = f" --count {its.count[quick]}" if its.count else ""
    return f"`generate {its.generate}{count}`"


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
