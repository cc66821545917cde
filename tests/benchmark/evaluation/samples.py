"""The samples of tests/benchmark/paper."""
from evaluation import methods as m

# N, radii, overlap, and of the paper: grains and % by watershed, CDGS, MADF.
BALLS = [(100, 20, 30, 0.08408, ("216, 0.7286", "100, 0.7075", "100, 0.3023")),
         (80, 25, 35, 0.14911, ("252, 1.2033", "80, 0.7653", "80, 0.5657")),
         (60, 30, 40, 0.19667, ("251, 1.8891", "59, 1.5180", "59, 0.8645")),
         (40, 35, 45, 0.19068, ("251, 1.8194", "39, 1.5136", "40, 0.7755")),
         (50, 20, 80, 0.24879, ("252, 4.6434", "49, 6.1126", "50, 3.3694"))]
CROPPED = 4  # the row of BALLS that `generate spheres` cannot make


class Sizes:
    """The samples: edges in voxels, numbers of grains, necks and roughness."""

    def __init__(self, quick):
        self.balls = 120 if quick else 300
        self.necks = [0.95, 0.55] if quick else [0.95, 0.82, 0.7, 0.55]
        self.roughness = [0, 0.6] if quick else [0, 0.3, 0.6, 1]
        self.neck, self.neck_grains = (100, 15) if quick else (140, 40)
        self.interfaces, self.interface_grains = (110, 20) if quick else (180, 90)
        self.times = (110, 110) if quick else (270, 256)
        self.picture = 90 if quick else 110


def sintered(path, size, count, neck=0.82, roughness=0, seed=1, threads=1):
    m.madf("generate", "sintered", path, "--size", size, "--count", count, "--neck", neck,
           "--roughness", roughness, "--seed", seed, threads=threads)
    return path


def balls(work, row, cover, seed, size):
    """A sample of Table 1 (a) and its truth, in one file; lengths in proportion to the edge of
    300."""
    count, low, high, target, _ = BALLS[row]
    scale = size / 300
    if row == CROPPED:
        from evaluation import cropped_balls
        m.numpy.save(work / "set.npy", cropped_balls.labels(size, count, low * scale, high * scale,
                                                            target, seed)[0])
        return work / "set.npy"
    m.madf("generate", "spheres", work / "set.vdb", "--size", size, "--count", count, "--radius",
           f"{low * scale}:{high * scale}", "--overlap", target, "--max-cover", cover, "--seed",
           seed)
    return work / "set.vdb"
