"""Rods and chains of balls with known grains, for tests/benchmark/accuracy: bodies of even width,
which nothing should cut, and as their counterweight bodies with necks, which have to be cut.

A body is a row of points, its axis, and what surrounds it. Bodies lie in any direction, in a cube,
which may cut off up to a fifth of each. They are GAP voxels or more apart; crossing rods touch, in
pairs. A rough sample is the union with its surface moved by noise: as `generate sintered
--roughness R` moves a flat surface, by 1.1 R voxels of standard deviation. Truth: the rod whose
surface is deepest over the voxel, the ball of least power. A body keeps what is face-connected to
its largest piece. Arrays are [z, y, x].
"""
import dataclasses

import numpy
from scipy import ndimage, spatial

GAP = 4  # voxels
STEP = 0.25  # voxels from point to point of an axis
TRIES = 400  # without a fit, in a row; then the cube is full
LEAST_INSIDE = 0.8  # of the points of an axis
# How the indicator that sintered cuts, blurred by 2 voxels, falls from voxel to voxel at a flat
# surface.
SLOPE = 1 / (2 * numpy.sqrt(2 * numpy.pi))


@dataclasses.dataclass
class Body:
    axis: numpy.ndarray  # points (n, 3)
    radius: float  # of all that surrounds it, for keeping apart
    # voxels (n, 3) -> signed distance to the surface, negative within
    distance: callable
    power: callable = None  # what decides on a voxel within several bodies; the distance if None


def direction(random):
    v = random.normal(size=3)
    return v / numpy.linalg.norm(v)


def across(u, random):
    """A direction at right angles to u."""
    v = numpy.cross(u, direction(random))
    return v / numpy.linalg.norm(v)


def rod(axis, radius):
    tree = spatial.cKDTree(axis)
    return Body(axis, radius, lambda p: tree.query(p)[0] - radius)


def line(start, u, length):
    return start + numpy.arange(0, length + STEP, STEP)[:, None] * u


def draw_length(random, radius, edge):
    """4 to 15 times as long as thick, but no longer than fits."""
    return 2 * radius * random.uniform(4, max(4, min(15, 1.1 * edge / (2 * radius))))


def straight(random, radius, edge, _=None):
    length = draw_length(random, radius, edge) - 2 * radius
    return [rod(line(random.uniform(0, edge, 3), direction(random), length), radius)]


def bent(random, radius, edge, _=None):
    """Arcs of 60 to 150 degrees; waves of one to one and a half periods, half to 1.2 radii high."""
    length = draw_length(random, radius, edge) - 2 * radius
    s = numpy.arange(0, length + STEP, STEP)
    u = direction(random)
    v = across(u, random)
    if random.random() < 0.5:
        bend = length / numpy.radians(random.uniform(60, 150))
        along, beside = bend * numpy.sin(s / bend), bend * (1 - numpy.cos(s / bend))
    else:
        period = length / random.uniform(1, 1.5)
        along = s
        beside = random.uniform(0.5, 1.2) * radius * numpy.sin(2 * numpy.pi * s / period)
    return [rod(random.uniform(0, edge, 3) + along[:, None] * u + beside[:, None] * v, radius)]


def column(random, radius, edge, _=None):
    """Hexagonal, 2 radius from side to side, with flat ends."""
    length = draw_length(random, radius, edge)
    u = direction(random)
    axis = line(random.uniform(0, edge, 3), u, length)
    v = across(u, random)
    w = numpy.cross(u, v)
    sides = [numpy.cos(a) * v + numpy.sin(a) * w for a in numpy.radians(range(0, 360, 60))]
    middle = (axis[0] + axis[-1]) / 2

    def distance(p):
        p = p - middle
        return numpy.max([*(p @ n - radius for n in sides), abs(p @ u) - length / 2], axis=0)
    return [Body(axis, 2 / numpy.sqrt(3) * radius, distance)]


def crossing(random, radius, edge, radii):
    """A straight rod, and one that crosses it or ends at its side, at 45 degrees or more; the
    surfaces overlap by 0.08 to 0.35 of the thinner radius."""
    first = straight(random, radius, edge)[0]
    other = random.uniform(*radii)
    length = draw_length(random, other, edge) - 2 * other
    u = first.axis[-1] - first.axis[0]
    u /= numpy.linalg.norm(u)
    normal = across(u, random)
    apart = radius + other - random.uniform(0.08, 0.35) * min(radius, other)
    place = first.axis[int(random.uniform(0.1, 0.9) * len(first.axis))] + apart * normal
    if random.random() < 0.5:
        angle = numpy.radians(random.uniform(45, 135))
        v = numpy.cos(angle) * u + numpy.sin(angle) * numpy.cross(normal, u)
        place = place - random.uniform(0.2, 0.8) * length * v
    else:
        angle = numpy.radians(random.uniform(45, 135))
        v = numpy.cos(angle) * u + numpy.sin(angle) * normal
    return [first, rod(line(place, v, length), other)]


def chain(random, radius, edge, radii):
    """4 to 8 balls; a neck has 0.4 to 0.8 of the smaller radius, a turn is 50 degrees at most."""
    center, u, bodies = random.uniform(0, edge, 3), direction(random), []
    for i in range(random.integers(4, 9)):
        if i > 0:
            last, radius = radius, random.uniform(*radii)
            neck = random.uniform(0.4, 0.8) * min(last, radius)
            turn = numpy.radians(random.uniform(0, 50))
            u = numpy.cos(turn) * u + numpy.sin(turn) * across(u, random)
            center = center + (numpy.sqrt(last**2 - neck**2) + numpy.sqrt(radius**2 - neck**2)) * u
        bodies.append(ball(center, radius))
    return bodies


def ball(center, radius):
    def square(p):
        return ((p - center) ** 2).sum(axis=1)
    return Body(center[None], radius, lambda p: numpy.sqrt(square(p)) - radius,
                lambda p: square(p) - radius**2)


def fits(group, others, edge):
    for body in group:
        inside = ((body.axis > -0.5) & (body.axis < edge - 0.5)).all(axis=1)
        if inside.mean() < LEAST_INSIDE:
            return False
        for other, tree in others:
            # an axis is far longer than its points are apart: every 8th is enough
            near = tree.query(body.axis[::8])[0].min()
            if near < body.radius + other.radius + GAP + 1:
                return False
    return True


def place(make, radii, edge, count, random):
    """Groups of bodies that touch, the groups apart."""
    placed, failed = [], 0
    while len(placed) < count and failed < TRIES:
        radius = random.uniform(*radii)
        group = make(random, radius, edge, radii)
        if fits(group, placed, edge):
            placed += [(body, spatial.cKDTree(body.axis)) for body in group]
            failed = 0
        else:
            failed += 1
    return [body for body, _ in placed]


def sample(make, radii, count, roughness, edge, seed):
    """The object (bool) and its true grains (int32); `make` is one of the functions above."""
    random = numpy.random.default_rng([seed, *make.__name__.encode(), int(10 * radii[0])])
    bodies = place(make, radii, edge, count, random)
    shift = numpy.zeros((edge,) * 3)
    if roughness:
        noise = ndimage.gaussian_filter(random.normal(size=shift.shape), 1)
        shift = roughness * 1.5 * noise / SLOPE
    owner, least = numpy.zeros(shift.shape, numpy.int32), numpy.full(shift.shape, numpy.inf)
    for number, body in enumerate(bodies, 1):
        reach = body.radius + 3
        low = numpy.maximum(numpy.floor(body.axis.min(axis=0) - reach), 0).astype(int)
        high = numpy.minimum(numpy.ceil(body.axis.max(axis=0) + reach) + 1, edge).astype(int)
        box = tuple(map(slice, low, high))
        points = numpy.stack(numpy.meshgrid(*map(numpy.arange, low, high), indexing="ij"), axis=-1)
        points = points.reshape(-1, 3).astype(float)
        distance = body.distance(points).reshape(owner[box].shape)
        power = body.power(points).reshape(distance.shape) if body.power else distance
        takes = (distance + shift[box] < 0) & (power < least[box])
        owner[box][takes], least[box][takes] = number, power[takes]
    return connected(owner)


def connected(labels):
    """Without what is not face-connected to the largest piece of its label."""
    truth = numpy.zeros_like(labels)
    for number, box in enumerate(ndimage.find_objects(labels), 1):
        if box is None:
            continue
        pieces, _ = ndimage.label(labels[box] == number)
        sizes = numpy.bincount(pieces.ravel())
        sizes[0] = 0
        truth[box][pieces == sizes.argmax()] = truth.max() + 1
    return truth > 0, truth
