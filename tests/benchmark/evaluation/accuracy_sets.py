"""The samples of tests/benchmark/accuracy, in groups; a further one is one more line of SETS."""
import dataclasses
import functools
import subprocess
import sys

import numpy
from scipy import ndimage

from evaluation import finney, methods as m, rods


@dataclasses.dataclass
class Set:
    group: str
    name: str
    generate: str = None  # a kind of `vdb_madf generate` and its options
    # grains: at the full size, and with --quick; None: the kind has no such option
    count: tuple = (90, 33)
    # voxels, an edge: full, and with --quick; None: `make` has its own
    size: tuple = (140, 100)
    make: callable = None  # instead of `generate`: edge, seed -> what sample() returns
    balls: callable = None  # of `generate balls`: seed -> their list
    section: bool = False  # the slice in the middle of z alone

    def describe(self, quick):
        if self.balls or not self.generate:
            return f"{self.name}, {self.size[quick]}^3" if self.size else self.name
        size = f" --size {self.size[quick]}" if self.size != Set.size else ""
        count = f" --count {self.count[quick]}" if self.count else ""
        return f"`generate {self.generate}{size}{count}`"


def own(group, name, make, *its, size=(120, 90)):
    return Set(group, name, make=functools.partial(make, *its), size=size)


def pack(name, radius, inflated=1.0, options=""):
    return Set("packs", f"radius {radius}, {name}", f"balls --radius {radius} {options}", None,
               None, balls=functools.partial(finney.some, radius, inflated))


def scaled(group, size, *lines):
    """Sets of one size, of lines: name, generate, count. (What a bed sinters goes by the square of
    its size: 20 rounds at double size are 5, and 1 at half size.)"""
    return [Set(group, *line, size=size) for line in lines]


class Skipped(Exception):
    pass


SETS = [
    Set("balls", "in pairs", "spheres --radius 12:16 --overlap 0.15", (80, 29)),
    Set("balls", "piling up", "spheres --radius 12:16 --overlap 0.15 --max-cover 0", (80, 29)),
    Set("deep necks", "0.65", "sintered --neck 0.65 --radius 6:20", (100, 36)),
    Set("deep necks", "0.55", "sintered --neck 0.55 --radius 6:20", (100, 36)),
    Set("sintered", "0.82", "sintered --neck 0.82 --radius 12:18"),
    Set("sintered", "0.95", "sintered --neck 0.95 --radius 12:18", (70, 25)),
    Set("beds", "5 rounds", "bed --radius 16:25 --rounds 5", None),
    Set("beds", "10 rounds", "bed --radius 16:25 --rounds 10", None),
    Set("shapes", "ellipsoids", "particles --shape ellipsoids --radius 10:16", (70, 25)),
    Set("shapes", "plates", "particles --shape plates --radius 10:16", (70, 25)),
    Set("shapes", "prisms", "particles --shape prisms --radius 10:16", (70, 25)),
    Set("shapes", "polyhedra", "particles --shape polyhedra --radius 10:16", (70, 25)),
    Set("rough surfaces", "0.3", "sintered --roughness 0.3 --radius 12:18"),
    Set("rough surfaces", "0.6", "sintered --roughness 0.6 --radius 12:18"),
    Set("rough surfaces", "surface 1.5:8", "sintered --surface 1.5:8 --radius 12:18"),
    Set("noise", "roughness 1", "sintered --roughness 1 --radius 12:18"),
    Set("noise", "scan, 0.1", "sintered --radius 12:18 --scan-noise 1:0.1"),
    Set("noise", "scan, 0.2", "sintered --radius 12:18 --scan-noise 1:0.2"),
    Set("noise", "scan, 0.3", "sintered --radius 12:18 --scan-noise 1:0.3"),
    own("rods", "straight, 3 to 4.5", rods.sample, rods.straight, (3, 4.5), 20, 0),
    own("rods", "straight, 4.5 to 9", rods.sample, rods.straight, (4.5, 9), 20, 0),
    own("rods", "straight, rough, 7 to 12", rods.sample, rods.straight, (7, 12), 20, 0.3),
    own("rods", "bent, rough, 3 to 5", rods.sample, rods.bent, (3, 5), 20, 0.3),
    own("rods", "bent, rough, 5 to 9", rods.sample, rods.bent, (5, 9), 20, 0.3),
    own("rods", "columns, 4 to 9", rods.sample, rods.column, (4, 9), 20, 0),
    own("rods", "crossing, 3.5 to 8", rods.sample, rods.crossing, (3.5, 8), 20, 0),
    own("rods", "crossing, rough, 5 to 11", rods.sample, rods.crossing, (5, 11), 20, 0.3),
    own("chains", "4 to 7", rods.sample, rods.chain, (4, 7), 80, 0),
    own("chains", "rough, 7 to 12", rods.sample, rods.chain, (7, 12), 80, 0.3),
    *scaled("half size", (80, 60),
            ("balls", "spheres --radius 6:8 --overlap 0.15", (120, 50)),
            ("deep necks", "sintered --neck 0.65 --radius 3:10", (150, 63)),
            ("sintered", "sintered --neck 0.82 --radius 6:9", (130, 55)),
            ("plates", "particles --shape plates --radius 5:8", (100, 42)),
            ("prisms", "particles --shape prisms --radius 5:8", (100, 42)),
            ("polyhedra", "particles --shape polyhedra --radius 5:8", (100, 42)),
            ("rough", "sintered --roughness 0.3 --radius 6:9", (130, 55)),
            ("noise", "sintered --radius 6:9 --scan-noise 1:0.2", (130, 55)),
            ("bed", "bed --radius 8:12 --rounds 1", None)),
    *scaled("small grains", (60, 45),
            ("balls", "spheres --radius 3:6 --overlap 0.15", (70, 30)),
            ("in touch", "sintered --neck 0.75 --radius 3:6", (100, 42)),
            ("ellipsoids", "particles --shape ellipsoids --radius 3:6", (150, 63)),
            ("polyhedra", "particles --shape polyhedra --radius 3:6", (150, 63))),
    *scaled("double size", (200, 150),
            ("balls", "spheres --radius 24:32 --overlap 0.15", (29, 12)),
            ("deep necks", "sintered --neck 0.65 --radius 12:40", (36, 15)),
            ("sintered", "sintered --neck 0.82 --radius 24:36", (33, 14)),
            ("plates", "particles --shape plates --radius 20:32", (25, 10)),
            ("prisms", "particles --shape prisms --radius 20:32", (25, 10)),
            ("noise", "sintered --radius 24:36 --scan-noise 1:0.2", (33, 14)),
            ("bed", "bed --radius 32:50 --rounds 20", None)),
    *(its for radius in (5, 8, 12)
      for its in (pack("clean", radius), pack("inflated by 3 %", radius, 1.03),
                  pack("blur 1, noise 0.1", radius, options="--scan-noise 1:0.1"))),
]
# One set of each kind is cut in the middle, too.
SECTIONS = [("balls", "in pairs"), ("deep necks", "0.65"), ("sintered", "0.82"),
            ("beds", "5 rounds"), ("shapes", "ellipsoids"), ("shapes", "polyhedra"),
            ("rough surfaces", "0.3"), ("noise", "scan, 0.2"),
            ("rods", "crossing, rough, 5 to 11"), ("packs", "radius 12, inflated by 3 %")]
SETS += [dataclasses.replace(its, group="sections", name=f"{its.group}: {its.name}", section=True)
         for its in SETS if (its.group, its.name) in SECTIONS]
GROUPS = list(dict.fromkeys(s.group for s in SETS))


def sample(its, quick, seed, work):
    """The object (bool) and its true grains (int32) as arrays [z, y, x]."""
    size = its.size and its.size[quick]
    solid, truth = its.make(size, seed) if its.make else generated(its, size, quick, seed, work)
    if not its.section:
        return solid, truth
    truth = pieces(truth[len(truth) // 2])
    return solid[len(solid) // 2][None], truth[None]


def pieces(labels):
    """The face-connected pieces of each label, numbered anew."""
    apart = numpy.zeros_like(labels)
    for number in numpy.unique(labels[labels > 0]):
        own, _ = ndimage.label(labels == number)
        apart[own > 0] = own[own > 0] + apart.max()
    return apart


def generated(its, size, quick, seed, work):
    if its.balls and not finney.FILE.exists():
        raise Skipped(f"skipped: there is no {finney.FILE}; VDB_MADF_DATA names the folder that "
                      "holds it")
    kind, *options = its.generate.split()
    options += ["--seed", str(seed)]
    if size:
        options += ["--size", str(size)]
    if its.count:
        options += ["--count", str(its.count[quick])]
    if its.balls:
        (work / "balls.txt").write_text(its.balls(seed))
        options.append(work / "balls.txt")
    done = subprocess.run([m.MADF, "generate", kind, *options, work / "set.vdb", "--threads", "1",
                           "-q"],
                          stderr=subprocess.PIPE, text=True)
    if done.returncode == 2:  # a kind or an option that this command does not have
        raise Skipped("skipped: this vdb_madf has no generate " + its.generate)
    if done.returncode:
        print(done.stderr, end="", file=sys.stderr)
        done.check_returncode()
    solid, truth = (m.dense(work / "set.vdb", work, "--grid", grid) for grid in ("object", "truth"))
    return solid > 0, truth
