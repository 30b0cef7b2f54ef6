#!/usr/bin/python3
"""Meshes there and back: subdivide, reverse, rebuild, by every scheme and variant.

    there_and_back.py ISOWAVE MESH_OR_FOLDER...

Every OBJ, OFF and PLY is subdivided once, taken apart and put together again. What is rebuilt must be the subdivided mesh, and
for loop and butterfly the base the mesh itself (A P = I), both to 1e-9 of the largest coordinate. (Catmull-Clark's P
forgets a vertex of valence 3 among others of valence 3, so its base may differ there, losslessly.) A mesh that a scheme
refuses (no triangles, not manifold) is passed over, and said. Exit code 1 where a program fails or a mesh differs.
Real meshes are in Debian's libcgal-demo.
"""
import pathlib
import subprocess
import sys
import tempfile

VARIANTS = {
    "catmull-clark": ["refined", "trial", "unscaled", "tensor", "wide"],
    "loop": ["refined", "trial", "wide"],
    "butterfly": ["refined", "trial", "wide"],
}
TOLERANCE = 1e-9
REFUSED = 3


def points_of(off):
    """The points of an OFF file that isowave wrote: OFF, counts, one point a line."""
    lines = [line for line in off.read_text().splitlines() if line and not line.startswith("#")]
    count = int(lines[1].split()[0])
    return [[float(word) for word in line.split()] for line in lines[2:2 + count]]


def difference(a, b):
    """The largest of all coordinates' differences, in the largest coordinate; infinite where counts differ."""
    if len(a) != len(b):
        return float("inf")
    largest = max(abs(x) for p in a for x in p)
    return max((abs(x - y) for p, q in zip(a, b) for x, y in zip(p, q)), default=0) / largest


def run(isowave, *words):
    return subprocess.run([isowave, *map(str, words), "--quiet"], capture_output=True, text=True)


def there_and_back(isowave, mesh, scheme, variant, folder):
    """(what went wrong or None, the larger of the two differences)"""
    original, fine, base, details, rebuilt = (folder / n for n in ("original.off", "fine.off", "base.off", "details", "rebuilt.off"))
    for words in (("subdivide", mesh, "--scheme", scheme, "--depth", 0, "-o", original),
                  ("subdivide", mesh, "--scheme", scheme, "-o", fine),
                  ("reverse", fine, "--scheme", scheme, "--variant", variant, "--depth", 1, "-o", base, "--details", details),
                  ("rebuild", base, "--details", details, "-o", rebuilt)):
        done = run(isowave, *words)
        if done.returncode:
            return done.returncode, f"{words[0]}: exit {done.returncode}: {done.stderr.strip()}", None
    worst = difference(points_of(fine), points_of(rebuilt))
    if scheme != "catmull-clark":
        worst = max(worst, difference(points_of(original), points_of(base)))
    return 0, None if worst <= TOLERANCE else f"differs by {worst:.2g} of its size", worst


def main(isowave, *places):
    meshes = [m for place in map(pathlib.Path, places)
              for m in (sorted(place.iterdir()) if place.is_dir() else [place]) if m.suffix in (".obj", ".off", ".ply")]
    failures, trips, worst = 0, 0, 0.0
    for mesh in meshes:
        for scheme, variants in VARIANTS.items():
            for variant in variants:
                with tempfile.TemporaryDirectory() as folder:
                    code, wrong, apart = there_and_back(isowave, mesh, scheme, variant, pathlib.Path(folder))
                if code == REFUSED:
                    print(f"{mesh.name} {scheme}: passed over: {wrong}")
                    break
                trips += 1
                failures += wrong is not None
                worst = max(worst, apart or 0)
                if wrong:
                    print(f"{mesh.name} {scheme} {variant}: {wrong}")
    print(f"{len(meshes)} meshes, {trips} trips, {failures} failures; the largest difference is {worst:.2g} of a mesh's size")
    return 1 if failures or not trips else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
