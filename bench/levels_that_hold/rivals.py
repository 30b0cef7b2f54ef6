"""What else makes a coarser level, for bench/levels_that_hold/run: both from the solid's values on the lattice of level 0, for
voxels n = 2, 4, 8 times as large, drawn by marching tetrahedra, so that they are closed. Arrays are indexed [z, y, x]; inside
is > 0.
"""
import itertools

import numpy as np


def blocks_of(array, n, beyond):
    """As (blocks..., n, n, n), padded by `beyond` to whole blocks and one more on each side."""
    pad = [(n, n + (-size) % n) for size in array.shape]
    a = np.pad(array, pad, constant_values=beyond)
    shape = [m for size in a.shape for m in (size // n, n)]
    return a.reshape(shape).transpose(0, 2, 4, 1, 3, 5)


def mean_pool(values, n):
    """The mean of each block; cut at 0 as the values are. `values` should be clamped as a narrow band is."""
    return blocks_of(values, n, values.min()).mean((3, 4, 5))


def dilated(inside, radius):
    """By a ball: squared distances by three passes of least f(i + k) + k^2, exact up to `radius`."""
    reach = int(np.floor(radius))
    far = np.where(inside, 0.0, 1e9).astype(np.float32)
    for axis in range(3):
        least = far.copy()
        for k in range(1, reach + 1):
            ahead = np.swapaxes(far, 0, axis)
            into = np.swapaxes(least, 0, axis)
            np.minimum(into[:-k], ahead[k:] + k * k, out=into[:-k])
            np.minimum(into[k:], ahead[:-k] + k * k, out=into[k:])
        far = least
    return far <= radius * radius


def closing(values, n):
    """Dilated and eroded by a ball of radius n/2, a voxel of the level across, as +-1/2 on level 0's lattice: it tears nothing,
    and coarsens nothing but slots and holes narrower than n."""
    inside = np.pad(values > 0, n)
    return (~dilated(~dilated(inside, n / 2), n / 2)).astype(np.float32) - 0.5


# Freudenthal's six tetrahedra of a cube: paths from corner 000 to 111. Neighbouring cubes cut their faces alike.
TETRAHEDRA = [np.cumsum([np.zeros(3, int)] + [np.eye(3, dtype=int)[a] for a in order], 0)
              for order in itertools.permutations(range(3))]


def marching_tetrahedra(values, spacing=1.0):
    """The surface values = 0 as (points, triangles), outward from values > 0. Nothing may be inside at the array's border."""
    low = [slice(0, s - 1) for s in values.shape]
    any_in = np.zeros([s - 1 for s in values.shape], bool)
    all_in = np.ones_like(any_in)
    for corner in itertools.product((0, 1), repeat=3):
        part = values[tuple(slice(c, s.stop + c) for c, s in zip(corner, low))] > 0
        any_in |= part
        all_in &= part
    cells = np.argwhere(any_in & ~all_in)
    if not len(cells):
        return np.zeros((0, 3)), np.zeros((0, 3), int)
    edges = [triangles_in(values, cells[:, None, :] + path[None]) for path in TETRAHEDRA]
    return joined(values, np.concatenate(edges), spacing)


def triangles_in(values, corners):
    """Triangles (n, 3, 2): each vertex an edge (inside, outside) of lattice points' flat ids, of tetrahedra (m, 4, 3)."""
    ids = np.ravel_multi_index(corners.reshape(-1, 3).T, values.shape).reshape(-1, 4)
    inside = values.reshape(-1)[ids] > 0
    made = []
    for case in range(1, 15):
        bits = np.array([(case >> i) & 1 for i in range(4)], bool)
        which = ids[(inside == bits).all(1)]
        ins, outs = np.flatnonzero(bits), np.flatnonzero(~bits)
        ring = [(i, o) for i in ins for o in outs]
        if len(ring) == 4:  # a quadrilateral: neighbours on it share an end
            ring = [ring[0], ring[1], ring[3], ring[2]]
        for second in range(1, len(ring) - 1):
            made.append(np.stack([which[:, ring[k]] for k in (0, second, second + 1)], 1))
    return oriented(np.concatenate(made), values.shape)


def oriented(edges, shape):
    places = np.stack(np.unravel_index(edges, shape), -1).astype(float)
    middle = places.mean(2)
    normal = np.cross(middle[:, 1] - middle[:, 0], middle[:, 2] - middle[:, 0])
    outward = (places[:, :, 1] - places[:, :, 0]).sum(1)
    wrong = (normal * outward).sum(1) < 0
    edges[wrong] = edges[wrong][:, ::-1]
    return edges


def joined(values, edges, spacing):
    flat = edges.reshape(-1, 2)
    keys, first, ids = np.unique(flat[:, 0] * values.size + flat[:, 1], return_index=True, return_inverse=True)
    ends = flat[first]
    v = values.reshape(-1)[ends]
    t = np.clip(v[:, 0] / (v[:, 0] - v[:, 1]), 0.01, 0.99)[:, None]  # no two vertices at one lattice point
    a, b = (np.stack(np.unravel_index(ends[:, i], values.shape), 1).astype(float) for i in (0, 1))
    points = (a + t * (b - a)) * spacing
    return points[:, ::-1], ids.reshape(-1, 3)[:, ::-1]  # [z, y, x] to x, y, z turns orientation round
