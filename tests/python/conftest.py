"""Real inputs, and the command itself to compare with."""

import gzip
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

DATA = Path(os.environ["ISOWAVE_TEST_DATA"])
GEAR = DATA / "meshes/gearwheel.bin.stl"
CRANIUM = DATA / "ct/cranium_crop.nrrd"


def read_cranium():
    """The crop of a head CT as an array (x, y, z), F-contiguous, and its affine in LPS; read here, not by isowave."""
    header, voxels = CRANIUM.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
    size = [int(n) for n in fields["sizes"].split()]
    array = np.frombuffer(gzip.decompress(voxels), "<i2").reshape(size, order="F")
    columns = [eval(column) for column in fields["space directions"].split()]
    affine = np.eye(4)
    affine[:3, :3] = np.transpose(columns)
    affine[:3, 3] = eval(fields["space origin"])
    return array, affine


def command(*arguments, **options):
    return subprocess.run([os.environ["ISOWAVE_BINARY"], *map(str, arguments)], capture_output=True, text=True, **options)


def command_report(tmp_path, source, *options):
    """report.json of `isowave lod`."""
    result = command("lod", source, "-o", tmp_path / "command", "--quiet", *options)
    assert result.returncode == 0, result.stderr
    return json.loads((tmp_path / "command/report.json").read_text())


def complaint(*arguments):
    """The one line with which the command fails, without its name."""
    result = command(*arguments)
    assert result.returncode in (1, 2, 3), result
    (line,) = result.stderr.splitlines()
    return line.removeprefix("isowave: ")


@pytest.fixture(scope="session")
def cranium():
    return read_cranium()


@pytest.fixture(scope="session")
def ball():
    """A ball of 9 voxels around the middle of 28^3, as bool, not the same along any two axes."""
    x, y, z = np.ogrid[:28, :26, :24]
    return (x - 13.2) ** 2 + (y - 12.6) ** 2 + (z - 11.4) ** 2 < 81
