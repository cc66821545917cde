# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Our network table keeps the rules of OpenPNM's network_from_csv, and OpenPNM reads it.

The rules, from OpenPNM's documentation of its data and the docstrings of openpnm.io: a column per
property, `pore.` or `throat.` before its name; columns of an array end in [0], [1] ...;
`pore.coords` has three, `throat.conns` two, which count pores from 0; the shorter of the two lists
ends where the first column of `pore.coords` or `throat.conns` is empty; a cell without a value is
empty. Debian has no OpenPNM: where `pip install openpnm` put one, it is asked too.
"""

import csv
import re

from proof import EDGE, Bench, LABELS, VOXELS, check, near, skip

PLACES = {label: [EDGE * sum(p[axis] for p in LABELS if LABELS[p] == label) / count
                  for axis in range(3)] for label, count in VOXELS.items()}
BOND = sorted(VOXELS).index(2), sorted(VOXELS).index(3)


# What OpenPNM and PoreSpy call our columns, or multiples of them.
OTHER_NAMES = {"pore.region_label": ("pore.grain_id", 1), "pore.region_volume": ("pore.volume", 1),
               "pore.diameter": ("pore.equivalent_diameter", 1),
               "pore.inscribed_diameter": ("pore.inscribed_radius", 2),
               "pore.surface_area": ("pore.area", 1), "throat.diameter": ("throat.radius", 2),
               "throat.equivalent_diameter": ("throat.radius", 2),
               "throat.inscribed_diameter": ("throat.inscribed_radius", 2),
               "throat.cross_sectional_area": ("throat.area", 1),
               "throat.direct_length": ("throat.length", 1)}


def check_rules(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    names, cells = rows[0], rows[1:]
    check(len(set(names)) == len(names), "a name comes twice")
    for name in names:
        check(re.fullmatch(r"(pore|throat)\.[a-z0-9_]+(\[\d\])?", name), f"name {name}")
    for array, size in (("pore.coords", 3), ("throat.conns", 2)):
        # OpenPNM merges whatever begins like an array's name.
        check([name for name in names if name.startswith(array)] ==
              [f"{array}[{i}]" for i in range(size)], f"columns of {array}")
    columns = {name: [row[names.index(name)] for row in cells] for name in names}
    for kind, count in (("pore", len(VOXELS)), ("throat", 1)):
        filled = {"pore": columns["pore.coords[0]"], "throat": columns["throat.conns[0]"]}[kind]
        check([bool(cell) for cell in filled] == [i < count for i in range(len(cells))],
              f"{count} of {kind}s: {filled}")
        for name in names:
            if name.startswith(kind):
                check(not any(columns[name][count:]), f"{name} goes on after the last {kind}")
                for cell in columns[name][:count]:
                    check(not cell or float(cell) == float(cell), f"{name}: {cell}")
    check([int(cell) for cell in columns["pore.grain_id"][:len(VOXELS)]] == sorted(VOXELS), "ids")
    for row, label in enumerate(sorted(VOXELS)):
        place = [float(columns[f"pore.coords[{axis}]"][row]) for axis in range(3)]
        check(near(place, PLACES[label]), f"grain {label} at {place}")
    for theirs, (ours, factor) in OTHER_NAMES.items():
        check([cell and float(cell) for cell in columns[theirs]] ==
              [cell and factor * float(cell) for cell in columns[ours]], theirs)
    ends = int(columns["throat.conns[0]"][0]), int(columns["throat.conns[1]"][0])
    check(ends == BOND, f"the bond connects {ends}")


def check_openpnm(openpnm, path):
    network = openpnm.io.network_from_csv(path)
    check((network.Np, network.Nt) == (len(VOXELS), 1), f"{network.Np} pores, {network.Nt} throats")
    for label, place in zip(sorted(VOXELS), network["pore.coords"]):
        check(near(place, PLACES[label]), f"OpenPNM: grain {label} at {place}")
    check([int(label) for label in network["pore.grain_id"]] == sorted(VOXELS), "OpenPNM: ids")
    check(tuple(int(end) for end in network["throat.conns"][0]) == BOND,
          f"OpenPNM: the bond connects {network['throat.conns']}")
    check(network["throat.faces"][0] == 2, "OpenPNM: faces of the bond")
    for name in OTHER_NAMES:
        check(name in network, f"OpenPNM: no {name}")


with Bench() as bench:
    table = bench.run("export", "network.csv", "--as", "network")
    check_rules(table)
    print("the network table keeps OpenPNM's rules")
    try:
        import openpnm
    except ImportError as error:
        skip(f"what OpenPNM reads: openpnm is not installed (pip install openpnm; {error})")
    check_openpnm(openpnm, table)
print("OpenPNM reads the network")
