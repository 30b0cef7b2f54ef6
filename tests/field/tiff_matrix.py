#!/usr/bin/python3
"""TIFFs of tifffile in every type, compression and layout, and what isowave says of them beside what was written.

    tiff_matrix.py ISOWAVE [FOLDER...]

Writes volumes by tifffile (numpy types x compressions x strips or tiles x byte order x BigTIFF x ImageJ, OME or plain), runs
`isowave info --json` and compares size, voxel size, range and percentiles. Each TIFF of a FOLDER must be read with the size and the
range that tifffile finds, or be refused in one line. Exit code 1 where something differs. Needs python3-tifffile.
"""
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import tifffile

TYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "float16", "float32", "float64", "bool"]
COMPRESSIONS = [None, "zlib"]  # the others need python3-imagecodecs
SPACING = (0.7, 0.8, 1.2)
PERCENTILES = (1, 25, 50, 75, 99)


def info(isowave, path, *options):
    done = subprocess.run([isowave, "info", str(path), *options, "--json", "-", "--quiet"], capture_output=True, text=True)
    return (json.loads(done.stdout) if done.returncode == 0 else None), done.stderr.strip()


def differences(found, values, spacing):
    """What isowave says and numpy does not; values: [z, y, x]"""
    wrong = []
    if found["dimensions"] != list(values.shape[::-1]):
        wrong.append(f"size {found['dimensions']} of {values.shape[::-1]}")
    if spacing and not np.allclose(found["spacing"], spacing, rtol=1e-6):
        wrong.append(f"spacing {found['spacing']} of {spacing}")
    stored = values.astype(np.float32)
    if found["range"] != [float(stored.min()), float(stored.max())]:
        wrong.append(f"range {found['range']} of {stored.min()}, {stored.max()}")
    step = float(stored.max() - stored.min()) / 100
    for percent in PERCENTILES:
        if abs(found["percentiles"][str(percent)] - np.percentile(stored, percent, method="nearest")) > step:
            wrong.append(f"{percent} %: {found['percentiles'][str(percent)]}")
    return wrong


def made(folder):
    """(name, path, options, values [z, y, x], spacing or None)"""
    generator = np.random.default_rng(57)
    # Smooth, so that percentiles do not jump; 0 and 1 for bool.
    base = np.cumsum(generator.integers(0, 3, (5, 40, 36)), axis=2)
    for kind, compression, tile, order, big in itertools.product(TYPES, COMPRESSIONS, (None, (16, 32)), "<>", (False, True)):
        values = (base % 100 - (50 if kind[0] in "if" else 0)).astype(kind) if kind != "bool" else base % 2 == 1
        if compression and kind == "bool" or tile and kind == "bool":
            continue
        path = folder / "a.tif"
        tifffile.imwrite(path, values, compression=compression, tile=tile, byteorder=order, bigtiff=big, photometric="minisblack")
        yield f"{kind} {compression} {tile} {order} {big}", path, (), values, None
    volume = np.stack([base, base + 300]).astype("uint16")  # [c, z, y, x]
    path = folder / "b.tif"
    tifffile.imwrite(path, volume.transpose(1, 0, 2, 3), imagej=True, resolution=(1 / SPACING[0], 1 / SPACING[1]),
                     metadata={"axes": "ZCYX", "spacing": SPACING[2], "unit": "mm"})
    for c in (0, 1):
        yield f"ImageJ channel {c + 1}", path, ("--channel", str(c + 1)), volume[c], SPACING
    sizes = {f"PhysicalSize{a}": s for a, s in zip("XYZ", SPACING)} | {f"PhysicalSize{a}Unit": "mm" for a in "XYZ"}
    for axes in ("CZYX", "TZYX"):
        path = folder / f"{axes}.ome.tif"
        tifffile.imwrite(path, volume, ome=True, compression="zlib", metadata={"axes": axes, **sizes})
        option = "--channel" if axes[0] == "C" else "--time"
        for c in (0, 1):
            yield f"OME {axes} {c + 1}", path, (option, str(c + 1)), volume[c], SPACING


def main(isowave, *folders):
    wrong, count, refused = 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for name, path, options, values, spacing in made(pathlib.Path(folder)):
            found, said = info(isowave, path, *options)
            differs = differences(found, values, spacing) if found else [said]
            count += 1
            wrong += bool(differs)
            if differs:
                print(f"{name}: {'; '.join(differs)}")
    for path in (p for folder in folders for p in sorted(pathlib.Path(folder).rglob("*")) if p.suffix.lower() in (".tif", ".tiff")):
        found, said = info(isowave, path)
        count += 1
        if not found:
            refused += 1
            if len(said.splitlines()) != 1:
                wrong += 1
            print(f"{path}: {said}")
            continue
        values = tifffile.imread(path)
        if values.ndim != 3 or differences(found, values, None):
            wrong += 1
            print(f"{path}: tifffile {values.shape}, isowave {found['dimensions']}")
    print(f"{count} files, {refused} refused, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
