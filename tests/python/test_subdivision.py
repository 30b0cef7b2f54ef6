"""Filters, subdivision and its reverse."""

import json
from fractions import Fraction

import numpy as np
import pytest
from conftest import DATA, command

import isowave

CAR = DATA / "subdiv/catmark_car.obj"
ANCHOR = DATA / "meshes/anchor_semiregular_tri.off"


def test_filters_are_those_of_the_command():
    for name, width in (("cubic", 7), ("butterfly", 3), ("catmull-clark", None)):
        found = isowave.filters(name, width=width)
        shown = json.loads(command("filters", name, "--json", "-", *(["--width", width] if width else [])).stdout)
        assert found.holds and found.width == shown["width"] and found.lattice == shown["lattice"]
        assert list(map(str, found.A.taps.values())) == shown["A"]["values"]
        assert len(found.B) == len(shown["B"])


def test_a_filter_is_exact_and_its_rows_sum_to_one():
    cubic = isowave.filters("cubic", width=7)
    assert sum(cubic.A.taps.values()) == 1 and all(isinstance(v, Fraction) for v in cubic.A.taps.values())
    own = isowave.filters(mask="1/8 1/2 3/4 1/2 1/8", width=7)
    assert own.A.taps == cubic.A.taps
    # AP = I: the coarse node k of P stands 2k further.
    for k in range(-4, 5):
        product = sum(a * cubic.P.taps.get(node - 2 * k, Fraction(0)) for node, a in cubic.A.taps.items())
        assert product == (k == 0)


def test_filters_refuse():
    with pytest.raises(isowave.InputError):
        isowave.filters("quintic")
    with pytest.raises(isowave.InputError):
        isowave.filters("cubic", width=2)
    for arguments in ({}, {"name": "cubic", "mask": "1 1"}, {"name": "cubic", "lattice": "quad"}, {"mask": "1 1", "lattice": "hex"}):
        with pytest.raises(isowave.UsageError):
            isowave.filters(**arguments)


def test_subdivide_is_that_of_the_command(tmp_path):
    assert command("subdivide", CAR, "--depth", 2, "-o", tmp_path / "fine.off").returncode == 0
    of_path = isowave.subdivide(CAR, depth=2)
    points = np.loadtxt(tmp_path / "fine.off", skiprows=2, max_rows=len(of_path.points))
    np.testing.assert_array_equal(of_path.points, points)
    assert of_path.faces.shape[1] == 4


def test_faces_of_several_sizes_and_creases():
    house = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]], float)
    faces = [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    smooth = isowave.subdivide(house, faces)
    creased = isowave.subdivide(house, faces, creases=[(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (3, 0, 1.0)])
    corners = slice(0, 4)  # the house's own come first
    assert smooth.faces.shape == (16, 4) and (creased.points[corners, 2] == 0).all() and (smooth.points[corners, 2] > 0).all()
    back = isowave.subdivide(house, faces, depth=0)
    assert isinstance(back.faces, list) and [len(face) for face in back.faces] == [4, 3, 3, 3, 3]


def test_a_real_mesh_there_and_back(tmp_path):
    levels = isowave.reverse(ANCHOR, scheme="loop")
    fine = levels.rebuild()
    assert len(levels) >= 1 and len(levels.details) == len(levels)
    assert levels.report["round_trip"] <= 1e-12 * levels.report["diagonal"]
    shown = json.loads(command("reverse", ANCHOR, "--scheme", "loop", "-o", tmp_path / "base.off", "--details",
                               tmp_path / "anchor.details", "--json", "-", "--quiet").stdout)  # fmt: skip
    assert shown == levels.report
    levels.save(tmp_path / "python.details")
    assert (tmp_path / "python.details").read_bytes() == (tmp_path / "anchor.details").read_bytes()
    loaded = isowave.Hierarchy.load(tmp_path / "anchor.details")
    np.testing.assert_array_equal(loaded.rebuild().points, fine.points)
    assert loaded.report is None and loaded.scheme == "loop"
    np.testing.assert_array_equal(levels.rebuild(0).points, levels.base.points)
    assert len(levels.rebuild(1).faces) == 4 * len(levels.base.faces)


def test_the_longest_details_alone_make_a_smaller_file(tmp_path):
    levels = isowave.reverse(ANCHOR, scheme="loop")
    levels.save(tmp_path / "whole")
    levels.save(tmp_path / "part", keep=100)
    command("reverse", ANCHOR, "--scheme", "loop", "-o", tmp_path / "base.off", "--details", tmp_path / "c", "--keep", 100)
    assert (tmp_path / "part").read_bytes() == (tmp_path / "c").read_bytes()
    assert (tmp_path / "part").stat().st_size < (tmp_path / "whole").stat().st_size / 2
    part = isowave.Hierarchy.load(tmp_path / "part")
    np.testing.assert_array_equal(part.rebuild().points, levels.rebuild(keep=100).points)
    levels.save(tmp_path / "again")  # nothing was dropped from what is held
    assert (tmp_path / "again").read_bytes() == (tmp_path / "whole").read_bytes()
    for wrong in ({"keep": 1, "threshold": 1}, {"keep": -1}, {"threshold": float("nan")}, {"threshold": 0}):
        with pytest.raises(isowave.UsageError, match="--keep|--threshold"):
            levels.save(tmp_path / "x", **wrong)
    assert not (tmp_path / "x").exists()


def test_an_edit_of_the_base_moves_all_and_simplifying_leaves_details_out():
    levels = isowave.reverse(ANCHOR, scheme="loop")
    moved = levels.rebuild(moved=levels.base.points + [1, 2, 3])
    np.testing.assert_allclose(moved.points, levels.rebuild().points + [1, 2, 3], atol=1e-9)
    plain = levels.rebuild(keep=0)
    assert np.abs(plain.points - levels.rebuild().points).max() > 0
    with pytest.raises(isowave.UsageError, match="moved: has the shape"):
        levels.rebuild(moved=[[0, 0, 0]])
    with pytest.raises(isowave.UsageError, match="exclude each other"):
        levels.rebuild(keep=1, threshold=1)
    with pytest.raises(isowave.UsageError, match="--depth"):
        levels.rebuild(14)
    with pytest.raises(isowave.UsageError, match="--frames"):
        levels.rebuild(frames="other")


def test_limit_positions_are_for_looking_at(tmp_path):
    levels = isowave.reverse(ANCHOR, scheme="loop")
    shown = levels.rebuild(0, limit=True)
    np.testing.assert_array_equal(shown.points, isowave.subdivide(*levels.base, scheme="loop", depth=0, limit=True).points)
    assert np.abs(shown.points - levels.base.points).max() > 1e-3
    # Subdivision without details leads there.
    far = isowave.subdivide(*levels.base, scheme="loop", depth=6).points[: len(shown.points)]
    assert np.abs(far - shown.points).max() < 1e-2 * np.abs(levels.base.points - shown.points).max()  # seen 1.3e-3
    with pytest.raises(isowave.InputError, match="limit positions"):
        levels.rebuild(moved=shown.points)


def test_errors():
    points, faces = isowave.subdivide(CAR, depth=1)
    with pytest.raises(isowave.InputError, match="mesh: "):
        isowave.reverse(points, faces, scheme="pentagon")
    with pytest.raises(isowave.InputError):
        isowave.reverse(points[:3], np.array([[0, 1, 2]]), depth=3)
    with pytest.raises(isowave.InputError):
        isowave.subdivide(points, faces, scheme="loop")
    with pytest.raises(isowave.UsageError, match="--crease"):
        isowave.reverse(points, faces, crease=200)
    with pytest.raises(isowave.UsageError, match="creases belong"):
        isowave.subdivide(CAR, creases=[(0, 1, 1.0)])
    with pytest.raises(isowave.UsageError, match="--depth"):
        isowave.subdivide(points, faces, depth=16)
