"""The samples of tests/benchmark/accuracy, in groups; a further one is one more line of SETS."""
import dataclasses
import subprocess
import sys

from evaluation import methods as m


@dataclasses.dataclass
class Set:
    group: str
    name: str
    generate: str  # a kind of `vdb_madf generate` and its options
    # grains: at 140^3, and at 100^3 (--quick); None: the kind has no such option
    count: tuple = (90, 33)


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
]
GROUPS = list(dict.fromkeys(s.group for s in SETS))


class Skipped(Exception):
    pass


def sample(its, quick, seed, work):
    """The object (bool) and its true grains (int32) as arrays [z, y, x]."""
    size = 100 if quick else 140
    options = [*its.generate.split(), "--size", size, "--seed", seed]
    if its.count:
        options += ["--count", its.count[quick]]
    kind, *options = map(str, options)
    done = subprocess.run([m.MADF, "generate", kind, work / "set.vdb", *options, "--threads", "1",
                           "-q"],
                          stderr=subprocess.PIPE, text=True)
    if done.returncode == 2:  # a kind or an option that this command does not have
        raise Skipped("skipped: this vdb_madf has no generate " + its.generate)
    if done.returncode:
        print(done.stderr, end="", file=sys.stderr)
        done.check_returncode()
    solid, truth = (m.dense(work / "set.vdb", work, "--grid", grid) for grid in ("object", "truth"))
    return solid > 0, truth
