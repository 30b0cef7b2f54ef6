#!/usr/bin/python3
"""Slow reference of the bounded-domain cubic B-spline wavelet transform, to check the C++ against.

Needs Debian's python3-numpy and python3-scipy. Dense linear algebra, one Python loop per line: use it
on fields of up to ~100^3. What it fixes is the mathematics of Esteve, Brunet and Vinacua (section 4), not an interface.

Index conventions (one line along one axis):
  * control point i sits at lattice position i; a node is the unit interval (i, i+1) and needs control
    points i-1 .. i+2.
  * a bounded domain of 2n intervals [2p, 2q] has 2n+3 control points at positions 2p-1 .. 2q+1
    (both odd). Its coarse domain of n intervals has n+3 control points at EVEN fine positions
    2p-2 .. 2q+2; coarse control point j sits at fine position 2j. So world positions never shift.

  oracle.py matrices N          prints P, Q and the two Gram matrices for n = N as JSON
  oracle.py interval FILE       FILE: JSON {"position": first fine position, "control_points": [...],
                                "known": [bool...], "left_sign": +-1, "right_sign": +-1, "K": 1}
                                prints coarse control points, details and the round-trip error
  oracle.py golden FOLDER       writes the golden files that the C++ tests compare with (tests/data/oracle)
  oracle.py demo                round trip and level table of a small 2D and a small 3D solid
"""
import json
import sys
from fractions import Fraction as F
from functools import lru_cache

import numpy as np
import scipy.ndimage as ndi

# --- the uniform cubic B-spline on a bounded domain -------------------------------------------------

# Polynomial pieces of the B-spline centred at 0 on [-2,-1], [-1,0], [0,1], [1,2], in local t in [0,1].
PIECES = [[F(0), F(0), F(0), F(1, 6)], [F(1, 6), F(1, 2), F(1, 2), F(-1, 2)],
          [F(2, 3), F(0), F(-1), F(1, 2)], [F(1, 6), F(-1, 2), F(1, 2), F(-1, 6)]]


def _integral(a, b):
    return sum(x * y / F(i + j + 1) for i, x in enumerate(a) for j, y in enumerate(b))


SEGMENT_GRAM = [[float(_integral(PIECES[3 - a], PIECES[3 - b])) for b in range(4)] for a in range(4)]


@lru_cache(None)
def gram(m):
    """(m+3)x(m+3) inner products of the B-splines truncated to m unit intervals; interior rows are
    (1, 120, 1191, 2416, 1191, 120, 1)/5040."""
    g = np.zeros((m + 3, m + 3))
    for c in range(m):
        g[c:c + 4, c:c + 4] += SEGMENT_GRAM
    return g


@lru_cache(None)
def refinement(n):
    """P: (2n+3)x(n+3), columns (1/8, 1/2, 3/4, 1/2, 1/8) cut off at the two ends."""
    p = np.zeros((2 * n + 3, n + 3))
    for j in range(n + 3):
        for k, v in zip(range(-2, 3), (1 / 8, 1 / 2, 3 / 4, 1 / 2, 1 / 8)):
            i = 2 * (j - 1) + k + 1
            if 0 <= i < 2 * n + 3:
                p[i, j] = v
    return p


@lru_cache(None)
def wavelets(n):
    """Q: (2n+3)xn, minimal-support basis of the orthogonal complement of the coarse space, n >= 5.

    Fine rows of column k: 0..7, 1..9, 2..11 for k = 0, 1, 2; 2k-3..2k+7 (the Chui-Wang wavelet, 11
    coefficients) in the interior; mirrored at the right. n = 5 has one middle column: the symmetric
    vector on rows 2..10 (on rows 1..11 the symmetric null space has dimension 2, so an SVD returns
    one of its vectors by accident). Each column is scaled so that its largest entry is 1.
    """
    m = refinement(n).T @ gram(2 * n)
    rows = 2 * n + 3
    q = np.zeros((rows, n))
    for k in range(n):
        lo, hi = 2 * k - 3, 2 * k + 7
        if k <= 2:
            lo, hi = k, (7, 9, 11)[k]
        if n - 1 - k <= 2:
            j = n - 1 - k
            lo, hi = rows - 1 - (7, 9, 11)[j], rows - 1 - j
        if n == 5 and k == 2:
            lo, hi = 2, rows - 3
            w = hi - lo + 1
            mirror = np.zeros((w, (w + 1) // 2))
            for i in range((w + 1) // 2):
                mirror[i, i] = mirror[w - 1 - i, i] = 1
            v = mirror @ np.linalg.svd(m[:, lo:hi + 1] @ mirror)[2][-1]
        else:
            v = np.linalg.svd(m[:, lo:hi + 1])[2][-1]
        q[lo:hi + 1, k] = v / v[np.argmax(np.abs(v))]
    return q


@lru_cache(None)
def synthesis(n):
    return np.hstack([refinement(n), wavelets(n)])


@lru_cache(None)
def analysis(n):
    return np.linalg.inv(synthesis(n))


# --- one line: intervals, accessory control points, rejection, recovery -----------------------------

def joined_intervals(mask, offset):
    """Maximal runs of known control points, made odd-ended, joined where the gap is <= 4."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    out = []
    for a, b in zip(np.flatnonzero(edges == 1) + offset, np.flatnonzero(edges == -1) - 1 + offset):
        a -= a % 2 == 0
        b += b % 2 == 0
        if out and a - out[-1][1] <= 4:
            out[-1] = (out[-1][0], b)
        else:
            out.append((a, b))
    return out


def analyse_interval(x, left, right):
    """x: the 2n+3 control points of an odd-ended interval (accessory ones filled in already); left,
    right: the value (+-K) of the four accessory points beyond each end. Returns (coarse n+3, detail n):
    the extended system has n+7 and n+4; two of each are rejected at either end."""
    if len(x) < 5:
        raise ValueError('an interval has at least 4 known control points: I must be a union of 4^d blocks')
    ne = (len(x) - 3) // 2 + 4
    y = analysis(ne) @ np.concatenate([[left] * 4, x, [right] * 4])
    return y[2:ne + 1], y[ne + 5:-2]


def synthesise_interval(coarse, detail, left, right):
    """Inverse of analyse_interval. The rejected 4+4 coefficients are recovered from the 4+4 accessory
    values, which are known: an 8x8 system (two 4x4 ones when the interval is long), condition 12.9."""
    ne = len(detail) + 4
    t = synthesis(ne)
    rows = [0, 1, 2, 3] + list(range(2 * ne - 1, 2 * ne + 3))
    lost = [0, 1, ne + 1, ne + 2, ne + 3, ne + 4, 2 * ne + 1, 2 * ne + 2]
    y = np.zeros(2 * ne + 3)
    y[2:ne + 1] = coarse
    y[ne + 5:-2] = detail
    y[lost] = np.linalg.solve(t[np.ix_(rows, lost)], np.array([left] * 4 + [right] * 4) - t[rows] @ y)
    return (t @ y)[4:-4]


# --- one direction of a 2D or 3D field --------------------------------------------------------------

class Field:
    """c: control points; known: the index set I; sign: +-1 everywhere (+ outside); origin: lattice
    position of array index 0 on each axis."""

    def __init__(self, c, known, sign, origin, K=1.0):
        self.c, self.known, self.sign, self.origin, self.K = c, known, sign, list(origin), K


def analyse_axis(f, axis):
    """Returns (coarse field, details, memo needed for the synthesis)."""
    pad = 8 + (f.origin[axis] % 2)
    c, known, sign = (np.moveaxis(np.pad(a, [(pad, 9) if b == axis else (0, 0) for b in range(a.ndim)],
                                         mode=mode), axis, 0)
                      for a, mode in ((f.c, 'constant'), (f.known, 'constant'), (f.sign, 'edge')))
    first = f.origin[axis] - pad
    full = np.where(known, c, f.K * sign)
    count = (c.shape[0] + 1) // 2
    cc = np.zeros((count,) + c.shape[1:])
    ck = np.zeros(cc.shape, bool)
    details = {}
    for line in np.ndindex(*c.shape[1:]):
        at = (slice(None),) + line
        for a, b in joined_intervals(known[at], first):
            left, right = (f.K * sign[(p - first,) + line] for p in (a - 1, b + 1))
            coarse, detail = analyse_interval(full[at][a - first:b - first + 1], left, right)
            j = (a - 1) // 2 - first // 2
            cc[(slice(j, j + len(coarse)),) + line] = coarse
            ck[(slice(j, j + len(coarse)),) + line] = True
            details[line + (a,)] = detail
    origin = list(f.origin)
    origin[axis] = first // 2
    coarse = Field(*(np.moveaxis(a, 0, axis) for a in (cc, ck, sign[0::2])), origin, f.K)
    return coarse, details, (axis, known, sign, first, pad)


def synthesise_axis(coarse, details, memo, fine_origin):
    axis, known, sign, first, pad = memo
    cc = np.moveaxis(coarse.c, axis, 0)
    out = coarse.K * sign
    for line in np.ndindex(*known.shape[1:]):
        at = (slice(None),) + line
        for a, b in joined_intervals(known[at], first):
            left, right = (coarse.K * sign[(p - first,) + line] for p in (a - 1, b + 1))
            detail = details[line + (a,)]
            j = (a - 1) // 2 - first // 2
            out[(slice(a - first, b - first + 1),) + line] = synthesise_interval(
                cc[at][j:j + len(detail) + 3], detail, left, right)
    cut = slice(pad, out.shape[0] - 9)
    c = np.where(known, out, 0.0)
    return Field(*(np.moveaxis(a[cut], 0, axis) for a in (c, known, sign)), fine_origin, coarse.K)


# --- the fit of Esteve, Brunet and Vinacua, section 2, and helpers ----------------------------------------------------

def fit(inside, passes=3, K=1.0):
    """inside: bool lattice, False on the border (>= 3 deep). +-K weights, `passes` of the discrete
    Laplacian filter, then the repair that keeps every corner's sign, so every node stays stabbed."""
    sign = np.where(inside, -1.0, 1.0)
    lo = hi = sign
    for ax in range(inside.ndim):
        n = lo.shape[ax] - 1
        lo = np.minimum(lo.take(range(n), ax), lo.take(range(1, n + 1), ax))
        hi = np.maximum(hi.take(range(n), ax), hi.take(range(1, n + 1), ax))
    nodes = np.pad(lo != hi, [(0, 1)] * inside.ndim)
    known = np.zeros_like(inside)
    for shift in np.ndindex(*(4,) * inside.ndim):
        known |= np.roll(nodes, [s - 1 for s in shift], range(inside.ndim))
    c = K * sign
    for _ in range(passes):
        mean = sum(np.roll(c, s, a) for a in range(c.ndim) for s in (-1, 1)) / (2 * c.ndim)
        c = np.where(known, 0.5 * (c + mean), c)
    while True:
        values = at_lattice(c)
        wrong = (sign * values < 0.05 * K) & known
        if not wrong.any():
            break
        c = np.where(wrong, c + 0.1 * K * sign - values, c)
    return Field(np.where(known, c, 0), known, sign, [0] * c.ndim, K)


def at_lattice(c):
    """Spline values at the lattice points: (1, 4, 1)/6 along each axis."""
    for a in range(c.ndim):
        c = (np.roll(c, 1, a) + 4 * c + np.roll(c, -1, a)) / 6
    return c


def in_turn(ndim, steps):
    return [s % ndim for s in range(steps)]


def pyramid(field, axes):
    """axes: which one each step halves."""
    stack, fields = [], [field]
    for axis in axes:
        coarse, details, memo = analyse_axis(fields[-1], axis)
        stack.append((details, memo))
        fields.append(coarse)
    return fields, stack


def demo():
    y, x = np.mgrid[:120, :120] - 59.5
    disc = (np.hypot(x, y) < 50) & ~(np.hypot(x - 15, y + 10) < 9) & ~(np.hypot(x + 20, y) < 4)
    z, y, x = np.mgrid[:48, :48, :48] - 23.5
    part = (np.hypot(x, y) < 20) & (np.abs(z) < 15) & ~(np.hypot(x, y) < 7) & ~(np.hypot(x, z) < 4)
    for solid, steps in ((disc, 10), (part, 12)):
        f0 = fit(np.pad(solid, 6))
        fields, stack = pyramid(f0, in_turn(solid.ndim, steps))
        print('step  known points  defined size  inside components / outside components')
        stored = 0
        for s, f in enumerate(fields):
            v = at_lattice(np.where(f.known, f.c, f.K * f.sign)) < 0
            print(f'{s:4d}  {f.known.sum():12d}  {"x".join(map(str, f.c.shape)):12s}'
                  f'  {ndi.label(v)[1]} / {ndi.label(~v)[1]}')
        stored = sum(len(d) for det, _ in stack for d in det.values()) + fields[-1].known.sum()
        back = fields[-1]
        for s in range(steps - 1, -1, -1):
            back = synthesise_axis(back, *stack[s], fields[s].origin)
        print('coefficients stored / control points: %.4f' % (stored / f0.known.sum()))
        print('largest reconstruction error: %.2e' % np.abs(back.c - f0.c).max())


def golden_intervals():
    """Random intervals of every kind of length: dense short ones, banded long ones."""
    rng, cases = np.random.default_rng(7), []
    for n in list(range(1, 24)) + [40, 59, 60, 61, 90]:
        x = np.round(rng.uniform(-1, 1, 2 * n + 3), 6)
        left, right = rng.choice([-1.0, 1.0], 2)
        coarse, detail = analyse_interval(x, left, right)
        cases.append({'left': left, 'right': right, 'fine': x.tolist(), 'coarse': coarse.tolist(),
                      'detail': detail.tolist()})
    return cases


def golden_field(inside, axes):
    """One field and its steps, sparse: known points with value and sign, details by coarse position."""
    def points(f):
        at = np.argwhere(f.known)
        return {'at': (at + f.origin).tolist(), 'value': [float('%.9g' % v) for v in f.c[f.known]],
                'inside': (f.sign[f.known] < 0).astype(int).tolist()}

    f0 = fit(np.pad(inside, 6))
    f0.c = np.round(f0.c, 6)
    fields, stack = pyramid(f0, axes)
    out = {'K': 1.0, 'fields': [points(f) for f in fields], 'details': []}
    for s, (details, memo) in enumerate(stack):
        axis, at, value = memo[0], [], []
        for key, d in sorted(details.items()):
            line, a = list(int(v) for v in key[:-1]), int(key[-1])
            other = [b for b in range(inside.ndim) if b != axis]
            for k, v in enumerate(d):
                p = [0] * inside.ndim
                p[axis] = (a - 1) // 2 + 1 + k
                for o, i in zip(other, line):
                    p[o] = i + fields[s].origin[o]
                at.append(p)
                value.append(float('%.9g' % v))
        out['details'].append({'axis': axis, 'at': at, 'value': value})
    back = fields[-1]
    for s in range(len(axes) - 1, -1, -1):
        back = synthesise_axis(back, *stack[s], fields[s].origin)
    assert np.abs(back.c - f0.c).max() < 1e-12
    return out


def golden(folder):
    rng = np.random.default_rng(3)
    z, y, x = np.mgrid[:12, :12, :12] - 5.5
    part = (np.hypot(x, y) < 5.7) & (np.abs(z) < 4) & ~(np.hypot(x - .4, y) < 2.3)
    sheet = np.zeros((12, 9, 5), bool)
    sheet[1:11, 1:8, 2] = True
    sheet[4:6, 3:5, 2] = False
    noise = rng.random((6, 6, 6)) < 0.5
    y, x = np.mgrid[:40, :34] - 16.5
    disc = (np.hypot(x, y) < 15) & ~(np.hypot(x - 5, y + 3) < 4.2) & ~(np.hypot(x + 7, y) < 1.5)
    plane_noise = rng.random((24, 17)) < 0.5
    plane, space = in_turn(2, 8), in_turn(3, 7)
    files = {'plane': golden_field(disc, plane), 'plane_noise': golden_field(plane_noise, plane),
             'intervals': golden_intervals(), 'part': golden_field(part, space), 'sheet': golden_field(sheet, space),
             'noise': golden_field(noise, space), 'sheet_any_order': golden_field(sheet, [2, 0, 0, 1, 2, 2, 1])}
    for name, content in files.items():
        with open('%s/%s.json' % (folder, name), 'w') as out:
            json.dump(content, out, separators=(',', ':'))


def main():
    if sys.argv[1:2] == ['matrices']:
        n = int(sys.argv[2])
        print(json.dumps({'P': refinement(n).tolist(), 'Q': wavelets(n).tolist(),
                          'gram_fine': gram(2 * n).tolist(), 'gram_coarse': gram(n).tolist()}))
    elif sys.argv[1:2] == ['interval']:
        d = json.load(open(sys.argv[2]))
        K = d.get('K', 1.0)
        f = Field(np.array(d['control_points'], float), np.array(d['known'], bool),
                  np.full(len(d['known']), 1.0), [d['position']], K)
        half = len(f.sign) // 2
        f.sign[:half], f.sign[half:] = d['left_sign'], d['right_sign']
        coarse, details, memo = analyse_axis(f, 0)
        back = synthesise_axis(coarse, details, memo, f.origin)
        at = np.flatnonzero(coarse.known)
        print(json.dumps({'coarse_position': (at + coarse.origin[0]).tolist(), 'coarse': coarse.c[at].tolist(),
                          'details': {str(int(k[-1])): v.tolist() for k, v in details.items()},
                          'round_trip_error': float(np.abs(np.where(f.known, back.c - f.c, 0)).max())}))
    elif sys.argv[1:2] == ['golden']:
        golden(sys.argv[2])
    elif sys.argv[1:2] == ['demo']:
        demo()
    else:
        sys.exit(__doc__)


if __name__ == '__main__':
    main()
