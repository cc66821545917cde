# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""Grains at any strictness, the joins between them, and the most stable ones."""

import json
import os
import re
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest

import vdb_madf as madf


def test_merging_by_score():
    mask = madf.generate("snow", size=64, fraction=0.4, length=12)[0]
    seg = madf.segment(mask, strictness=12)
    assert seg.options["merge"] == "score" and seg.options["strictness"] == 12
    assert not {"theta", "delta", "adjacency"} & set(seg.options)
    joins = seg.hierarchy
    made_at = joins["strictness"]
    assert len(made_at) > 4
    for strictness in (made_at[0], made_at[len(made_at) // 2], made_at[-1]):
        fresh = madf.segment(mask, strictness=strictness)
        again = seg.cut(strictness)
        assert (np.asarray(fresh.labels) == np.asarray(again.labels)).all()
        assert again.options == fresh.options and again.labels.metadata == fresh.labels.metadata
        made = joins["strictness"] >= strictness
        assert joins["grains"][made][-1] == fresh.counts["grains"]
    assert (np.diff(joins["strictness"]) <= 0).all()
    assert (joins["strictness"] <= joins["score"]).all()
    both = seg.remerge(merge="both")
    assert both.options == madf.segment(mask, merge="both").options
    assert both.cut(12).options == seg.options
    assert list(seg.sweep(made_at[:3])["grains"]) == [
        joins["grains"][made_at >= at][-1] for at in made_at[:3]]
    rows = seg.sweep(merge=["score", "neck"], strictness=[9, 11], theta=[-0.9])
    assert rows["merge"] == ["score", "score", "neck"]
    assert rows["grains"][1] == seg.cut(11).counts["grains"]
    assert np.isnan(rows["theta"][:2]).all() and np.isnan(rows["strictness"][2])
    with pytest.raises(madf.InvalidInput, match="theta: belongs to merge='both'"):
        seg.remerge(theta=-0.5)
    with pytest.raises(madf.InvalidInput, match="theta: belongs to merge='both'"):
        seg.sweep(theta=[-0.5])
    with pytest.raises(madf.InvalidInput, match="strictness: belongs to merge='score'"):
        madf.segment(mask, merge="neck", strictness=9)
    with pytest.raises(madf.InvalidInput, match="strictness: belongs to merge='score'"):
        seg.sweep([9], merge="neck")


def test_cuts_at_forty_numbers():
    mask = madf.generate("snow", size=48, fraction=0.5, length=8)[0]
    seg = madf.segment(mask)
    numbers = np.linspace(0, 25, 40)
    grains = set()
    for number, swept in zip(numbers, seg.sweep(numbers)["grains"]):
        fresh = madf.segment(mask, strictness=number, keep=())
        again = seg.cut(number)
        assert np.array_equal(again.labels, fresh.labels), number
        assert again.counts["grains"] == fresh.counts["grains"] == swept
        grains.add(swept)
    assert len(grains) > 15


def trees_of(newick):
    """(names of the leaves, length of the branch above, names and lengths of the items) of each
    tree."""
    tokens = re.findall(r"[(),;]|[^(),;]+", newick.replace("\n", ""))
    position = 0

    def item():
        nonlocal position
        parts = []
        if tokens[position] == "(":
            while tokens[position] != ")":
                position += 1
                parts.append(item())
            position += 1
        name, _, length = tokens[position].partition(":")
        position += 1
        return name, float(length or 0), parts

    while position < len(tokens):
        yield item()
        assert tokens[position] == ";"
        position += 1


def test_the_hierarchy_as_trees(command, tmp_path):
    seg = madf.segment(madf.generate("snow", size=64, fraction=0.4, length=12)[0], strictness=30)
    joins = seg.hierarchy
    seg.save(tmp_path / "all.vdb")
    for ending in ("nwk", "graphml"):
        command("hierarchy", tmp_path / "all.vdb", tmp_path / f"joins.{ending}")

    command("hierarchy", tmp_path / "all.vdb", tmp_path / "parents.csv", "--levels", "12,11,9.5")
    header, *rows = (tmp_path / "parents.csv").read_text().split()
    assert header == "grain_at_12,grain_at_11,grain_at_9.5,voxels"
    rows = np.array([row.split(",") for row in rows], int)
    fine, *coarse = (np.asarray(seg.remerge(strictness=k, tidy=0).labels) for k in (12, 11, 9.5))
    assert (rows[:, 0] == np.arange(1, fine.max() + 1)).all() and len(np.unique(rows[:, 2])) > 1
    assert (rows[:, 3] == np.bincount(fine.ravel())[1:]).all()
    for column, labels in zip((1, 2), coarse):
        parents = np.concatenate([[0], rows[:, column]])
        assert np.array_equal(parents[fine], labels)

    command("sweep", tmp_path / "all.vdb", tmp_path / "sweep.csv", "--strictness", "9,11.5")
    header, *rows = (tmp_path / "sweep.csv").read_text().split()
    grains = [int(row.split(",")[header.split(",").index("grains")]) for row in rows]
    assert grains == list(seg.sweep([9, 11.5])["grains"])

    # Cut where the height above the leaves says so, the trees have the grains of that strictness.
    leaves, made = [], {}

    def walk(name, parts):
        heights = [walk(*child[::2]) + child[1] for child in parts]
        if not parts:
            leaves.append(name)
            return 0.0
        assert len(parts) == 2 and np.isclose(*heights)
        made[name] = (joins["strictness"][0] - heights[0], {child[0] for child in parts})
        return heights[0]

    trees = list(trees_of((tmp_path / "joins.nwk").read_text()))
    for name, length, parts in trees:
        assert length == 0
        walk(name, parts)
    count = len(joins["score"])
    assert set(made) == {f"j{i + 1}" for i in range(count)}
    assert len(trees) == len(leaves) - count
    assert np.allclose([made[f"j{i + 1}"][0] for i in range(count)], joins["strictness"], atol=1e-9)
    first = {name for _, parts in made.values() for name in parts if name[0] != "j"}
    assert first <= {str(i + 1) for i in np.concatenate([joins["first"], joins["second"]])}

    graph = ElementTree.parse(tmp_path / "joins.graphml").getroot()
    space = "{http://graphml.graphdrawing.org/xmlns}"
    keys = {key.get("id") for key in graph.iter(space + "key")}
    nodes = {node.get("id"): {data.get("key"): float(data.text) for data in node}
             for node in graph.iter(space + "node")}
    edges = [(edge.get("source"), edge.get("target")) for edge in graph.iter(space + "edge")]
    assert set(nodes) == set(leaves) | set(made) and len(nodes) == count + len(leaves)
    assert {key for data in nodes.values() for key in data} == keys
    assert sum(nodes[name]["voxels"] for name in leaves) == seg.counts["object_voxels"]
    for i in range(count):
        name = f"j{i + 1}"
        parts = [part for source, part in edges if source == name]
        assert set(parts) == made[name][1]
        assert nodes[name]["voxels"] == sum(nodes[part]["voxels"] for part in parts)
        assert nodes[name]["score"] == joins["score"][i]
        assert nodes[name]["grains"] == joins["grains"][i]
    for name in leaves:
        place = [nodes[name][axis] for axis in "zyx"]
        assert place == seg.graph["position"][int(name) - 1].tolist()


def test_the_most_stable_strictness(command, tmp_path):
    mask = madf.generate("particles", shape="rods", size=64, count=12, radius=(3, 6))[0]
    mask.save(tmp_path / "mask.vdb")
    seg = madf.segment(mask, tidy=0)
    stable = seg.stable_strictness
    best = stable["strictness"]
    assert best != 11
    levels = stable["levels"]
    assert np.allclose(levels, np.arange(80, 141) / 10)
    assert stable["stability"][levels == best] == stable["stability"].max()
    for level in (8, 10, best):
        measured = madf.measure(seg.cut(level), stability=True).grains
        weights = np.fmin(measured["stability"], 1)  # NaN: always there
        mean = (weights * measured["voxels"]).sum() / measured["voxels"].sum()
        at = np.flatnonzero(levels == level)
        assert np.isclose(stable["stability"][at], mean, atol=0.002)
        assert stable["grains"][at] == len(measured["id"])
    if stable["plateau"]:
        first, last = (stable["grains"][levels == end] for end in stable["plateau"])
        assert first <= last < 1.05 * first

    command("segment", tmp_path / "mask.vdb", tmp_path / "auto.vdb", "--strictness", "auto",
            "--json", tmp_path / "auto.json", "--keep", "manifold")
    said = json.loads((tmp_path / "auto.json").read_text())
    assert said["strictness"] == best and said["strictness_auto"]
    expected = seg.remerge(strictness=best, tidy=2).labels
    command("segment", tmp_path / "mask.vdb", tmp_path / "all.slabs", "--keep", "manifold",
            "--slab-height", "24")
    for source, result in (("auto.vdb", "again.vdb"), ("all.slabs", "again.slabs")):
        command("remerge", tmp_path / source, tmp_path / result, "--strictness", "auto")
        again = madf.Labels(tmp_path / result, grid="grain")
        assert np.array_equal(again, expected)
        assert again.metadata["madf_strictness"] == best
    labels = madf.Labels(tmp_path / "auto.vdb", grid="grain")
    assert np.array_equal(labels, expected) and labels.metadata == expected.metadata
    tool = os.environ["VDB_MADF_TOOL"]
    for options, says in ((["x.slabs"], "is not for slabs: segment with --keep manifold"),
                          (["x.vdb", "--merge", "both"], "belongs to --merge score")):
        refused = subprocess.run([tool, "segment", tmp_path / "mask.vdb", *options, "--strictness",
                                  "auto"], stderr=subprocess.PIPE, text=True, cwd=tmp_path)
        assert refused.returncode == 2 and says in refused.stderr
