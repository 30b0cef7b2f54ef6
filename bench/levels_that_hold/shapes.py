"""Thin solids for bench/levels_that_hold/run: closed meshes, masks and images. Lengths are in voxels of level 0.

A mesh is (points, triangles), counter-clockwise from outside. Most are *blocks*: the cells of a grid with its own planes
on each axis that a boolean array takes for solid, with a map of the grid's corners into space (round tubes, balls, wedges,
blades). An image is an array indexed [z, y, x], spacing 1.
"""
import numpy as np


# ---- blocks

def blocks(planes, solid, around=None, place=lambda p: p):
    """The border of the cells of `solid` (nx, ny, nz). `planes`: the grid's planes, one more than cells, on each axis; on
    axis `around` the last plane is the first. `place` maps corners (n, 3), without reversing orientation."""
    quads = []
    for axis in range(3):
        pad = [(0, 0)] * 3
        pad[axis] = (1, 1)
        s = np.pad(solid, pad, mode="wrap" if axis == around else "constant").astype(np.int8)
        step = np.diff(s, axis=axis)
        if axis == around:  # the last border is the first
            step = np.take(step, range(solid.shape[axis]), axis=axis)
        at = np.argwhere(step != 0)
        u, v = (axis + 1) % 3, (axis + 2) % 3
        ring = np.zeros((4, 3), int)
        ring[1:3, u] = 1
        ring[2:4, v] = 1
        quad = at[:, None, :] + ring[None]
        leaves = step[tuple(at.T)] < 0  # solid below: the normal points along the axis
        quads.append(np.where(leaves[:, None, None], quad, quad[:, ::-1]))
    corners = np.concatenate(quads)
    if around is not None:
        corners[..., around] %= solid.shape[around]
    shape = np.array([len(p) for p in planes])
    keys, ids = np.unique(np.ravel_multi_index(corners.reshape(-1, 3).T, shape), return_inverse=True)
    index = np.stack(np.unravel_index(keys, shape), 1)
    points = place(np.stack([np.asarray(planes[a])[index[:, a]] for a in range(3)], 1).astype(float))
    ids = ids.reshape(-1, 4)
    return points, np.concatenate([ids[:, [0, 1, 2]], ids[:, [0, 2, 3]]])


def axis(*breaks, step=None):
    """Planes at `breaks`, and between them at most `step` apart."""
    breaks = sorted(set(float(b) for b in breaks))
    if step is None:
        return np.array(breaks)
    pieces = [np.linspace(a, b, max(1, int(np.ceil((b - a) / step))) + 1)[:-1] for a, b in zip(breaks, breaks[1:])]
    return np.append(np.concatenate(pieces), breaks[-1])


def cells(planes, inside):
    """`inside(x, y, z)` at the middles of all cells."""
    middles = [(p[1:] + p[:-1]) / 2 for p in planes]
    return np.broadcast_to(inside(*np.meshgrid(*middles, indexing="ij")), [len(m) for m in middles]).copy()


def block_solid(planes, inside, **how):
    return blocks(planes, cells(planes, inside), **how)


def round_about_z(p):
    return np.stack([p[:, 0] * np.cos(p[:, 1]), p[:, 0] * np.sin(p[:, 1]), p[:, 2]], 1)


def ball_of_cube(p):
    return p * (np.abs(p).max(1) / np.maximum(np.linalg.norm(p, axis=1), 1e-9))[:, None]


def turned(mesh, tilt=17.0, about=(3, 1, 2), by=(0.137, -0.231, 0.342)):
    """Turned by `tilt` degrees about an axis, then moved, so that nothing lies on lattice planes."""
    n = np.array(about, float) / np.linalg.norm(about)
    k = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    a = np.radians(tilt)
    r = np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k
    return mesh[0] @ r.T + np.array(by), mesh[1]


# ---- meshes

def plate(t, side=40.0):
    return blocks([axis(-side / 2, side / 2), axis(-side / 2, side / 2), axis(-t / 2, t / 2)], np.ones((1, 1, 1), bool))


def two(mesh, above):
    """The mesh twice, the second `above` in z."""
    points, triangles = mesh
    return np.concatenate([points, points + [0, 0, above]]), np.concatenate([triangles, triangles + len(points)])


TURN = axis(0, 2 * np.pi, step=2 * np.pi / 128)


def tube(wall, radius=20.0, length=60.0):
    planes = [axis(radius - wall, radius), TURN, axis(0, length)]
    return block_solid(planes, lambda r, a, z: r > 0, around=1, place=round_about_z)


def square_tube(w, side=24.0, length=50.0):
    planes = [axis(0, w, side - w, side)] * 2 + [axis(0, length)]
    return block_solid(planes, lambda x, y, z: ~((w < x) & (x < side - w) & (w < y) & (y < side - w)))


def tray(w, side=36.0, height=18.0):
    planes = [axis(0, w, side - w, side)] * 2 + [axis(0, w, height)]
    return block_solid(planes, lambda x, y, z: ~((w < x) & (x < side - w) & (w < y) & (y < side - w) & (z > w)))


def hollow(w, side=32.0, **how):
    planes = [axis(-side / 2, w - side / 2, side / 2 - w, side / 2, **how)] * 3
    return planes, lambda x, y, z: np.maximum(np.maximum(abs(x), abs(y)), abs(z)) > side / 2 - w


def hollow_box(w):
    return block_solid(*hollow(w))


def hollow_ball(w):
    planes, inside = hollow(w, step=1.6)
    return block_solid(planes, inside, place=ball_of_cube)


def holed_ball(w, hole=5.0, side=36.0):
    half = axis(-side / 2, w - side / 2, -hole, hole, side / 2 - w, side / 2, step=1.6)

    def inside(x, y, z):
        far = sum((abs(a) > hole).astype(int) for a in (x, y, z))
        return (np.maximum(np.maximum(abs(x), abs(y)), abs(z)) > side / 2 - w) & (far > 1)
    return block_solid([half] * 3, inside, place=ball_of_cube)


def stripes(n, rib, slot, start=0.0):
    """Planes of n ribs, and a function that says which cells are in a rib."""
    ends = [start + i * (rib + slot) + e for i in range(n) for e in (0, rib)]
    return ends, lambda x: ((x - start) % (rib + slot) < rib) & (x > start) & (x < ends[-1])


def comb(rib, slot, n=12, length=24.0, depth=14.0, back=3.0):
    ends, ribs = stripes(n, rib, slot)
    return block_solid([axis(*ends), axis(-back, 0, length), axis(0, depth)], lambda x, y, z: ribs(x) | (y < 0))


def fins(rib, slot, n=14):
    return comb(rib, slot, n, 20.0, 40.0, 1.5)


def lattice(bar, pitch=8.0, n=5):
    ends, in_bar = stripes(n, bar, pitch - bar)
    return block_solid([axis(*ends)] * 3,
                       lambda x, y, z: in_bar(x).astype(int) + in_bar(y) + in_bar(z) > 1)


def wire_cube(bar, side=36.0):
    return lattice(bar, side - bar, 2)


def holed_plate(t, hole=3.0, n=7):
    ends, bars = stripes(n + 1, hole, hole)
    return block_solid([axis(*ends)] * 2 + [axis(0, t)], lambda x, y, z: bars(x) | bars(y))


def egg_crate(wall, pitch=7.0, n=7, height=18.0):
    ends, walls = stripes(n, wall, pitch - wall)
    return block_solid([axis(*ends)] * 2 + [axis(0, height)], lambda x, y, z: walls(x) | walls(y))


def holed_tube(wall, radius=18.0, n=12, rows=4):
    turn = axis(*(2 * np.pi * i / (2 * n) for i in range(2 * n + 1)), step=2 * np.pi / 96)
    planes = [axis(radius - wall, radius), turn, axis(*(6.0 * i for i in range(2 * rows + 2)))]
    return block_solid(planes, lambda r, a, z: (np.floor(a * n / np.pi) % 2 == 0) | (np.floor(z / 6) % 2 == 0),
                       around=1, place=round_about_z)


def wedge(thick, thin, length=48.0, width=30.0):
    planes = [axis(0, length), axis(0, width), axis(-0.5, 0.5)]
    return block_solid(planes, lambda x, y, z: x > 0, place=lambda p: np.stack(
        [p[:, 0], p[:, 1], p[:, 2] * (thick + (thin - thick) * p[:, 0] / length)], 1))


def crossed_plates(t, side=36.0):
    planes = [axis(-side / 2, -t / 2, t / 2, side / 2)] * 3
    return block_solid(planes, lambda x, y, z: np.minimum(np.minimum(abs(x), abs(y)), abs(z)) < t / 2)


def stairs(t, n=6, going=6.0):
    flat = axis(*(going * i + e for i in range(n + 1) for e in (0, t)))

    def inside(x, y, z):
        i = np.floor(z / going)
        tread = (z - going * i < t) & (x > going * i) & (x < going * (i + 1) + t)
        riser = (x > going * (i + 1)) & (x < going * (i + 1) + t) & (i < n - 1)
        return tread & (x < going * n) | riser & (z < going * (n - 1) + t)
    return block_solid([flat, axis(0, 24), flat], inside)


def blade(t, turn=1.2, length=50.0, width=24.0):
    planes = [axis(-width / 2, width / 2, step=2), axis(-t / 2, t / 2), axis(0, length, step=1)]

    def twist(p):
        a = turn * p[:, 2] / length
        c, s = np.cos(a), np.sin(a)
        return np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1], p[:, 2]], 1)
    return block_solid(planes, lambda x, y, z: z > 0, place=twist)


def gutter(t, radius=20.0, angle=2.5):
    planes = [axis(radius - t, radius), axis(0, angle, step=0.05), axis(0, 40)]
    return block_solid(planes, lambda r, a, z: r > 0, place=round_about_z)


def ring(t, radius=30.0):
    return tube(t, radius, t)


def hollow_torus(wall, small=7.0, large=22.0):
    planes = [axis(small - wall, small), axis(0, 2 * np.pi, step=2 * np.pi / 48), TURN]

    def bend(p):
        r = large + p[:, 0] * np.cos(p[:, 1])
        return np.stack([r * np.cos(p[:, 2]), r * np.sin(p[:, 2]), -p[:, 0] * np.sin(p[:, 1])], 1)
    points, triangles = blocks_of_torus(planes)
    return bend(points), triangles[:, ::-1] if volume((bend(points), triangles)) < 0 else triangles


def blocks_of_torus(planes):
    """Inner and outer sheet of a tube bent to a ring: two tori."""
    nu, nv = len(planes[1]) - 1, len(planes[2]) - 1
    u, v = np.meshgrid(np.arange(nu), np.arange(nv), indexing="ij")
    id_of = lambda a, b: (a % nu) * nv + b % nv
    quad = np.stack([id_of(u, v), id_of(u + 1, v), id_of(u + 1, v + 1), id_of(u, v + 1)], -1).reshape(-1, 4)
    sheet = np.concatenate([quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]])
    turn = np.stack([planes[1][:-1][u], planes[2][:-1][v]], -1).reshape(-1, 2)
    layers = [np.concatenate([np.full((len(turn), 1), r), turn], 1) for r in planes[0]]
    return np.concatenate(layers), np.concatenate([sheet[:, ::-1], sheet + len(turn)])


def cup(wall, radius=16.0, height=30.0, bore=2.0):
    """With a hole of radius `bore` in its bottom."""
    planes = [axis(bore, radius - wall, radius), TURN, axis(0, wall, height)]
    return block_solid(planes, lambda r, a, z: (r > radius - wall) | (z < wall), around=1, place=round_about_z)


def nested(wall, gap, side=30.0):
    c = side / 2
    marks = np.cumsum([0, wall, gap, wall])
    planes = [axis(*(c - m for m in marks), *(m - c for m in marks))] * 3

    def inside(x, y, z):
        d = c - np.maximum(np.maximum(abs(x), abs(y)), abs(z))
        return (d < wall) | ((d > wall + gap) & (d < 2 * wall + gap))
    return block_solid(planes, inside)


def beam(w, side=24.0, length=50.0):
    planes = [axis(-side / 2, -w / 2, w / 2, side / 2), axis(0, w, side - w, side), axis(0, length)]
    return block_solid(planes, lambda x, y, z: (abs(x) < w / 2) | (y < w) | (y > side - w))


def pillars(t, gap, n=5, pitch=8.0, side=2.0):
    """Two plates with a gap, n x n pillars between them."""
    ends, posts = stripes(n, side, pitch - side)
    planes = [axis(-4, *ends, ends[-1] + 4)] * 2 + [axis(0, t, t + gap, 2 * t + gap)]
    return block_solid(planes, lambda x, y, z: (z < t) | (z > t + gap) | (posts(x) & posts(y)))


def flange(disc=3.0, wall=1.5, bore=14.0, outer=52.0, height=30.0, bolts=12):
    """A disc with a round bore, `bolts` windows, and a collar of `wall`."""
    turn = axis(*(np.pi / bolts * (i + e) for i in range(2 * bolts) for e in (0, 0.5, 1)), step=2 * np.pi / 144)
    planes = [axis(bore, bore + wall, 36, 44, outer), turn, axis(0, disc, height)]

    def inside(r, a, z):
        window = (r > 36) & (r < 44) & ((a * bolts / np.pi) % 2 < 1)
        return (r < bore + wall) | ((z < disc) & ~window)
    return block_solid(planes, inside, around=1, place=round_about_z)


def thin_meshes():
    """Name -> mesh: forty with walls, bars, slots or gaps of 0.6 to 2 voxels (but those that images make)."""
    made = {}
    for w in (0.6, 0.8, 1.2, 2.0):
        made[f"tube, wall {w}"] = tube(w)
    for w in (0.6, 1.0):
        made[f"square tube, wall {w}"] = square_tube(w)
        made[f"wire cube, bars {w}"] = wire_cube(w)
    for w in (0.6, 1.0, 1.5):
        made[f"tray, wall {w}"] = tray(w)
    for w in (0.7, 1.2):
        made[f"hollow box, wall {w}"] = hollow_box(w)
        made[f"hollow ball, wall {w}"] = hollow_ball(w)
        made[f"lattice, bars {w}"] = lattice(w)
        made[f"plate {w} with 49 holes"] = holed_plate(w)
        made[f"tube with 48 holes, wall {w}"] = holed_tube(w)
        made[f"egg crate, walls {w}"] = egg_crate(w)
    for rib, slot in ((1.2, 1.2), (0.8, 1.6), (2.0, 0.8)):
        made[f"comb, ribs {rib}, slots {slot}"] = comb(rib, slot)
    for thick, thin in ((3.0, 0.3), (2.0, 0.6)):
        made[f"wedge, {thick} to {thin}"] = wedge(thick, thin)
    made["fins 0.8, slots 2"] = fins(0.8, 2.0)
    made["crossed plates 1"] = crossed_plates(1.0)
    made["stairs 1"] = stairs(1.0)
    made["blade 1"] = blade(1.0)
    made["gutter 0.7"] = gutter(0.7)
    made["ring 0.8"] = ring(0.8)
    made["hollow torus, wall 1"] = hollow_torus(1.0)
    made["cup, wall 0.8"] = cup(0.8)
    made["ball with 6 holes, wall 1.2"] = holed_ball(1.2)
    made["box in a box, walls 1, gap 0.8"] = nested(1.0, 0.8)
    made["beam 0.8"] = beam(0.8)
    made["two plates 1, gap 0.8, 25 pillars"] = pillars(1.0, 0.8)
    return {name: turned(mesh) for name, mesh in made.items()}


# ---- masks and images

def lattice_of(half):
    r = np.arange(-half, half + 1, dtype=float)
    z, y, x = np.meshgrid(r, r, r, indexing="ij")
    return x, y, z


def masks():
    """Name -> (mask, volume error that is allowed, %)."""
    ox, oy, oz = 0.137, -0.231, 0.342
    made = {}
    for r, allowed in ((3, 2.5), (5, 1.0), (10, 0.5)):
        x, y, z = lattice_of(r + 3)
        made[f"ball {r}"] = ((x - ox) ** 2 + (y - oy) ** 2 + (z - oz) ** 2 < r * r, allowed)
    x, y, z = lattice_of(21)
    made["rod 1.5 along an axis"] = ((x * x + y * y < 2.25) & (abs(z) < 15), 5.0)
    n = np.array([1, 2, 5]) / np.sqrt(30)
    px, py, pz = x - ox, y - oy, z - oz
    along = px * n[0] + py * n[1] + pz * n[2]
    made["rod 1.5 along (1,2,5)"] = ((px**2 + py**2 + pz**2 - along**2 < 2.25) & (abs(along) < 15), 5.0)
    made["sheet of 1"] = ((z == 0) & (abs(x) < 12) & (abs(y) < 12), 6.0)
    for name, far in (("shell of 1", np.sqrt(x**2 + y**2 + z**2)), ("shell of 1, off centre", np.sqrt(px**2 + py**2 + pz**2))):
        made[name] = (abs(far - 10) < 0.5, 6.0)
    return made


def gyroid_value(x, y, z, k):
    x, y, z = k * x, k * y, k * z
    value = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    g = (np.cos(x) * np.cos(y) - np.sin(z) * np.sin(x), np.cos(y) * np.cos(z) - np.sin(x) * np.sin(y),
         np.cos(z) * np.cos(x) - np.sin(y) * np.sin(z))
    return value / np.maximum(np.sqrt(sum(c * c for c in g)), 0.35) / k


def schwarz_value(x, y, z, k):
    value = np.cos(k * x) + np.cos(k * y) + np.cos(k * z)
    slope = np.sqrt(np.sin(k * x) ** 2 + np.sin(k * y) ** 2 + np.sin(k * z) ** 2)
    return value / np.maximum(slope, 0.35) / k


def shell_in_ball(value, period, wall, radius, half):
    """Of `wall` voxels along value = 0, in a ball; negative inside."""
    x, y, z = lattice_of(half)
    c, s = np.cos(0.64), np.sin(0.64)
    d = abs(value(c * x + s * y, c * y - s * x, z, 2 * np.pi / period)) - wall / 2
    return np.maximum(d, np.sqrt(x * x + y * y + z * z) - radius)


def plate_with_wall(n=4, pitch=32.0):
    """bench/analytic.h's plate, n x n holes of radius 1.2 to 8, a wall of 2 voxels, balls of radius 1 to 4."""
    half, top = int(16 * n) + 12, 52
    r = np.arange(-half, half + 1, dtype=float)
    z, y, x = np.meshgrid(np.arange(-14, top + 1, dtype=float), r, r, indexing="ij")
    c, s = np.cos(0.2), np.sin(0.2)
    x, y = c * x + s * y, c * y - s * x
    box = lambda x, y, z, h: np.maximum(np.maximum(abs(x) - h[0], abs(y) - h[1]), abs(z) - h[2])
    d = box(x, y, z - 0.13, (16 * n + 4.3 - 14, 16 * n + 4.4 - 14, 6.2))
    for i in range(n * n):
        at = (pitch - 6) * (np.array([i % n, i // n]) - (n - 1) / 2)
        d = np.maximum(d, 1.2 + 6.8 * i / (n * n - 1) - np.hypot(x - at[0], y - at[1]))
    d = np.minimum(d, box(x, y, z - 26.3, (11.7 * n, 1.0, 20.0)))
    for i in range(2 * n):
        ball = np.sqrt((x + 8 * (2 * n - 1) - 16 * i) ** 2 + (y - 30.3) ** 2 + (z - 20.4) ** 2)
        d = np.minimum(d, ball - (1 + 3.0 * i / (2 * n - 1)))
    return d


def trabecular(wave=24.0, radius=54.0, seed=20040707):
    """A third of a ball, where a sum of 40 waves of random directions is large."""
    random = np.random.RandomState(seed)
    x, y, z = (a.ravel() for a in lattice_of(int(radius) + 4))
    total = np.zeros(len(x))
    for _ in range(40):
        k = random.normal(size=3)
        k *= 2 * np.pi / (wave * random.uniform(0.9, 1.1)) / np.linalg.norm(k)
        total += np.cos(k[0] * x + k[1] * y + k[2] * z + random.uniform(0, 2 * np.pi))
    d = (0.43 * np.sqrt(20) - total) * wave / (2 * np.pi) / np.sqrt(20)
    side = 2 * int(radius + 4) + 1
    return np.maximum(d, np.sqrt(x * x + y * y + z * z) - radius).reshape(side, side, side)


# ---- measures and files

def volume(mesh):
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def write_ply(path, mesh):
    points, triangles = mesh
    face = np.zeros(len(triangles), dtype=[("n", "u1"), ("v", "<i4", 3)])
    face["n"], face["v"] = 3, triangles
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\n"
                    f"element vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
                    f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n").encode())
        file.write(points.astype("<f8").tobytes())
        file.write(face.tobytes())


def write_nrrd(path, image):
    kind = "uint8" if image.dtype == bool else "float"
    data = image.astype("u1" if kind == "uint8" else "<f4")
    sizes = " ".join(str(n) for n in image.shape[::-1])
    with open(path, "wb") as file:
        file.write((f"NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {sizes}\nspacings: 1 1 1\n"
                    "encoding: raw\nendian: little\n\n").encode())
        file.write(data.tobytes())
