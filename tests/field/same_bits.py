#!/usr/bin/python3
"""Whether isowave's results are the same to the bit, whatever runs it.

    same_bits.py ISOWAVE [OTHER...] [--data FOLDER]

Runs lod, analyse, mesh, field, curves, subdivide and reverse on files of tests/data (or FOLDER) and compares the hashes of
everything that they write, and print, with those of the first run:
  - by 1, 2, 4 and 8 threads;
  - with vectors of 2, 4 and 8 doubles (ISOWAVE_VECTORS), and with the plain functions of the C library (GLIBC_TUNABLES);
  - by OTHER programs: another build of the same sources, such as Debug;
  - lod, of a mesh whose triangles, and their corners, stand in another order in the file. By the binary fit only the last digits of
    the input's `volume`, and of `volume_error`, may differ. The distance fit puts its conditions on thin walls at places that
    depend on the order: volumes of levels may differ by 0.5 %, and how far they do is printed.
Of reports the entries that no two runs share are left out: seconds, peak_memory_bytes, threads, paths. Exit code 1 where anything
else differs.
"""
import argparse
import hashlib
import json
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

RUNS_DIFFER = {"seconds", "peak_memory_bytes", "threads", "path", "memory_bytes"}
PLAIN = "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable"


def commands(data):
    gear, head = data / "meshes/gearwheel.bin.stl", data / "ct/cranium_crop.nrrd"
    bones = data / "meshes/bones.off"
    return {
        "lod of a mesh": ["lod", gear, "--voxels", "40", "--levels", "0..2", "-o", "@/part"],
        "lod with budgets": ["lod", bones, "--voxels", "40", "--triangles", "1000", "--levels", "1..1", "--features",
                             "-o", "@/part"],
        "lod of an image": ["lod", head, "--iso", "300", "--levels", "1..2", "--preserve-volume", "--deviation", "-o", "@/part"],
        "lod, shifted": ["lod", head, "--iso", "300", "--levels", "2..3", "--hold", "shift", "--refit", "-o", "@/part"],
        "analyse": ["analyse", gear, "--voxels", "48", "-o", "@/a.vdb"],
        "mesh": ["mesh", gear, "--voxels", "40", "--level", "1", "--refine", "2", "--compact", "-o", "@/a.stl"],
        "field": ["field", head, "--iso", "300", "-o", "@/a.vdb"],
        "curves of a bitmap": ["curves", data / "curves2d/horse.png", "--smooth", "--json", "@/a.json", "-o", "@/part"],
        "curves of polygons": ["curves", data / "curves2d/africa.geojson", "--flatness", "0.1", "-o", "@/part"],
        "subdivide": ["subdivide", data / "meshes/catmark_toroidal_tet.obj", "--depth", "2", "-o", "@/a.ply"],
        "reverse": ["reverse", data / "meshes/anchor_semiregular_tri.off", "--scheme", "loop", "--details", "@/a.details",
                    "-o", "@/a.ply"],
    }


def without_run(value):
    """A report without what no two runs share"""
    if isinstance(value, dict):
        return {k: without_run(v) for k, v in value.items() if k not in RUNS_DIFFER}
    return [without_run(v) for v in value] if isinstance(value, list) else value


def takes_threads(isowave, command):
    return "--threads" in subprocess.run([isowave, command, "--help"], capture_output=True, text=True).stdout


def results(isowave, words, threads=None, environment={}):
    """Name -> hash of every file that the command writes; reports as values"""
    with tempfile.TemporaryDirectory() as folder:
        line = [isowave] + [str(w).replace("@", folder) for w in words] + ["--quiet"]
        if threads and takes_threads(isowave, words[0]):
            line += ["--threads", str(threads)]
        run = subprocess.run(line, capture_output=True, env={**os.environ, **environment})
        if run.returncode:
            sys.exit(f"{' '.join(line)}: {run.stderr.decode()}")
        made = {}
        for file in sorted(pathlib.Path(folder).rglob("*")):
            if file.suffix == ".json":
                made[file.name] = without_run(json.loads(file.read_text()))
            elif file.is_file():
                made[file.name] = hashlib.sha256(file.read_bytes()).hexdigest()
        return made


def differences(a, b, place=""):
    """Where two results differ, and by what"""
    if isinstance(a, dict) and isinstance(b, dict):
        return [d for k in sorted(a.keys() | b.keys()) for d in differences(a.get(k), b.get(k), f"{place}/{k}")]
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return [d for k, (x, y) in enumerate(zip(a, b)) for d in differences(x, y, f"{place}/{k}")]
    return [] if a == b else [(place, a, b)]


def shuffled(stl, seed):
    """The bytes of a binary STL with its triangles, and the corners of each, in another order"""
    head, body = stl[:84], stl[84:]
    generator = random.Random(seed)
    triangles = [body[k:k + 50] for k in range(0, len(body), 50)]
    generator.shuffle(triangles)

    def turned(t):
        corners = [t[12 + 12 * k:24 + 12 * k] for k in range(3)]
        turn = generator.randrange(3)
        return t[:12] + b"".join(corners[turn:] + corners[:turn]) + t[48:]
    return head + b"".join(map(turned, triangles))


def orders(isowave, data, more):
    """lod of a mesh in three orders: what differs between the results, and how far volumes of the levels do"""
    whole = (data / "meshes/gearwheel.bin.stl").read_bytes()
    assert struct.unpack("<I", whole[80:84])[0] * 50 == len(whole) - 84
    wrong, first = [], None
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "a.stl"
        for seed in range(3):
            file.write_bytes(shuffled(whole, seed) if seed else whole)
            made = results(isowave, ["lod", file, "--voxels", "40", "--levels", "0..2", "-o", "@/part"] + more)
            first = first or made
            wrong += differences(first, made)
    return wrong


def far(found, places, most):
    """Of the differences those elsewhere, and those of numbers that are not within `most`, which is relative"""
    return [(place, a, b) for place, a, b in found
            if place.split("/")[-1] not in places or abs(a - b) > most * max(1, abs(a))]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("isowave", nargs="+")
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "data")
    options = parser.parse_args()
    program, others = options.isowave[0], options.isowave[1:]
    ways = [(f"{n} threads", {"threads": n}) for n in (2, 4, 8)]
    ways += [(f"vectors of {n}", {"environment": {"ISOWAVE_VECTORS": n}}) for n in ("2", "4")]
    ways += [("a plain C library", {"environment": {"GLIBC_TUNABLES": PLAIN, "ISOWAVE_VECTORS": "2"}})]
    ways += [(other, {"program": other}) for other in others]
    wrong = 0

    def tell(what, found):
        nonlocal wrong
        wrong += len(found)
        for place, a, b in found[:10]:
            print(f"DIFFERS: {what}: {place}: {str(a)[:60]} and {str(b)[:60]}", flush=True)
    for name, words in commands(options.data).items():
        first = results(program, words, threads=1)
        for way, how in ways:
            how = dict(how)
            made = results(how.pop("program", program), words, **how)
            tell(f"{name}, {way}", differences(first, made))
        print(f"{name}: {len(first)} files, {len(ways) + 1} ways", flush=True)
    # Sums over triangles are taken in the file's order.
    tell("triangles in another order", far(orders(program, options.data, ["--fit", "binary"]), {"volume", "volume_error"}, 1e-14))
    # Conditions on thin walls stand at places that the order of triangles and corners chooses.
    volumes = [d for d in orders(program, options.data, []) if d[0].count("/") == 4 and d[0].endswith("/volume")]
    tell("triangles in another order, thin walls", far(volumes, {"volume"}, 0.005))
    print(f"triangles in another order: thin walls, {len(volumes)} volumes differ, by at most "
          f"{max((abs(a / b - 1) for _, a, b in volumes), default=0):.1e}")
    print("the same to the bit" if wrong == 0 else f"{wrong} differences")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
