"""Curves and heights by reversing subdivision, and their files of details."""

import json
import struct

import numpy as np
import pytest
from conftest import DATA, command

import isowave

COAST = DATA / "coast/iceland.txt"


def wave(points=96):
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * (10 + np.sin(9 * angle))[:, None]


def hill(rows=33, columns=41):
    y, x = np.mgrid[0:rows, 0:columns]
    return 20 * np.exp(-((x - 16.0) ** 2 + (y - 12.0) ** 2) / 64) + np.sin(x * 1.3) * np.cos(y)


def two_pages():
    """A TIFF of two pages of 8 x 8 grey pixels."""
    entry = lambda tag, kind, value: struct.pack("<HHII", tag, kind, 1, value)  # noqa: E731
    tags = [(256, 4, 8), (257, 4, 8), (258, 4, 8), (259, 4, 1), (262, 4, 1), (273, 4, 8), (277, 4, 1), (278, 4, 8), (279, 4, 64)]
    directory = struct.pack("<H", len(tags)) + b"".join(entry(*tag) for tag in tags)
    first = 8 + 64
    return (struct.pack("<2sHI", b"II", 42, first) + bytes(range(64)) + directory + struct.pack("<I", first + len(directory) + 4)
            + directory + struct.pack("<I", 0))  # fmt: skip


def test_curves_and_their_file_are_those_of_the_command(tmp_path):
    levels = isowave.curve_levels(COAST, depth=3)
    shown = json.loads(command("curve-levels", COAST, "--depth", 3, "-o", tmp_path / "out", "--details", tmp_path / "c",
                               "--json", "-", "--quiet").stdout)  # fmt: skip
    assert shown == levels.report
    levels.save(tmp_path / "new/p")
    assert (tmp_path / "new/p").read_bytes() == (tmp_path / "c").read_bytes()
    loaded = isowave.CurveDetails.load(tmp_path / "c")
    assert loaded.report is None and loaded.scheme == "dlg-refined" and len(loaded) == len(levels) == 3
    for mine, other in zip(levels.rebuild(), loaded.rebuild()):
        np.testing.assert_array_equal(mine.points, other.points)
    coarse = np.loadtxt(tmp_path / "out/level_3.txt", comments=("#", ">"))
    ours = np.concatenate([np.vstack([c.points, c.points[:1]]) if c.closed else c.points for c in loaded.coarse])
    np.testing.assert_allclose(ours, coarse, rtol=1e-9)


def test_curves_of_arrays_come_back_at_every_depth():
    line = np.cumsum(np.ones((50, 3)) + [[0, 0.1, 0.2]], axis=0)
    levels = isowave.curve_levels([isowave.Curve(wave(), True), line], depth=2, scheme="cubic-7")
    closed, opened = levels.rebuild()
    np.testing.assert_allclose(closed.points, wave(), atol=1e-10)
    np.testing.assert_allclose(opened.points, line, atol=1e-10)
    assert closed.closed and not opened.closed
    for mine, coarse in zip(levels.rebuild(0), levels.coarse):
        np.testing.assert_array_equal(mine.points, coarse.points)
    repeated = isowave.curve_levels(np.vstack([wave(), wave()[:1]]), depth=2, scheme="cubic-7")
    np.testing.assert_array_equal(repeated.coarse[0].points, levels.coarse[0].points)
    own = isowave.curve_levels(isowave.Curve(wave(), True), depth=2, mask="1/8 1/2 3/4 1/2 1/8", width=7)
    np.testing.assert_allclose(own.coarse[0].points, levels.coarse[0].points, atol=1e-10)


def test_an_edit_of_coarse_curves_moves_all_and_dropping_makes_a_smaller_file(tmp_path):
    levels = isowave.curve_levels(isowave.Curve(wave(), True), depth=3)
    moved = [isowave.Curve(curve.points + [5, -2], curve.closed) for curve in levels.coarse]
    np.testing.assert_allclose(levels.rebuild(moved=moved)[0].points, wave() + [5, -2], atol=1e-9)
    turn = np.array([[0, 1], [-1, 0]])
    turned = [isowave.Curve(curve.points @ turn, curve.closed) for curve in levels.coarse]
    np.testing.assert_allclose(levels.rebuild(moved=turned, frames="local")[0].points, wave() @ turn, atol=1e-8)
    few = isowave.curve_levels(isowave.Curve(wave(), True), depth=3, keep=5)
    levels.save(tmp_path / "all")
    few.save(tmp_path / "few")
    assert (tmp_path / "few").stat().st_size < (tmp_path / "all").stat().st_size
    np.testing.assert_allclose(few.rebuild()[0].points, levels.rebuild(keep=5)[0].points, atol=1e-12)
    with pytest.raises(isowave.InputError):
        levels.rebuild(moved=[isowave.Curve(wave(), True)])
    with pytest.raises(isowave.UsageError, match="--depth"):
        levels.rebuild(4)
    with pytest.raises(isowave.UsageError, match="--frames"):
        levels.rebuild(frames="other")


def test_heights_and_their_file_are_those_of_the_command(tmp_path):
    for values in (hill(), np.stack([hill(), -hill()], axis=2)):
        np.save(tmp_path / "h.npy", values)
        of_path, of_array = isowave.relief(tmp_path / "h.npy"), isowave.relief(values)
        shown = json.loads(command("relief", tmp_path / "h.npy", "-o", tmp_path / "out", "--details", tmp_path / "c", "--json", "-",
                                   "--quiet").stdout)  # fmt: skip
        assert shown == of_path.report == of_array.report
        of_array.save(tmp_path / "p")
        assert (tmp_path / "p").read_bytes() == (tmp_path / "c").read_bytes()
        loaded = isowave.ReliefDetails.load(tmp_path / "c")
        assert loaded.report is None and loaded.scheme == of_path.scheme and len(loaded) == 2
        np.testing.assert_array_equal(loaded.coarse, np.load(tmp_path / "out/level_2.npy"))
        np.testing.assert_array_equal(loaded.rebuild(1), np.load(tmp_path / "out/level_1.npy"))
        np.testing.assert_allclose(loaded.rebuild(), values, atol=1e-9)
        loaded.save(tmp_path / "again")
        assert (tmp_path / "again").read_bytes() == (tmp_path / "c").read_bytes()


def test_edited_heights_ride_along():
    levels = isowave.relief(hill())
    np.testing.assert_allclose(levels.rebuild(edited=levels.coarse + 3), hill() + 3, atol=1e-9)
    assert np.abs(levels.rebuild(keep=0) - hill()).max() > 0.1
    assert np.abs(levels.rebuild(0, limit=True) - levels.coarse).max() >= 0
    with pytest.raises(isowave.InputError, match="heights: has 33 x 41 samples"):
        levels.rebuild(edited=hill())


def test_errors(tmp_path):
    for wrong in ({"scheme": "cubic-7", "mask": "1/2 1 1/2"}, {"width": 7}, {"depth": 61}, {"depth": -1}, {"resample": 1},
                  {"keep": 1, "threshold": 1}, {"keep": -1}, {"threshold": 0}):  # fmt: skip
        with pytest.raises(isowave.UsageError):
            isowave.curve_levels(wave(), **wrong)
    with pytest.raises(isowave.UsageError, match="curve 0 has the shape"):
        isowave.curve_levels([np.zeros((4, 5))])
    with pytest.raises(isowave.InputError, match="curves: "):
        isowave.curve_levels(wave(), scheme="septic")
    with pytest.raises(isowave.InputError, match="curves: "):
        isowave.curve_levels([[0, 0], [1, 1]])
    with pytest.raises(isowave.UsageError, match="has the shape"):
        isowave.relief(np.zeros(7))
    with pytest.raises(isowave.UsageError, match="--depth"):
        isowave.relief(hill(), depth=21)
    with pytest.raises(isowave.InputError, match="heights: "):
        isowave.relief(np.full((9, 9), np.nan))
    with pytest.raises(isowave.InputError, match="heights: is masked"):
        isowave.relief(np.ma.masked_greater(hill(), 0.5))
    (tmp_path / "pages.tif").write_bytes(two_pages())
    with pytest.raises(isowave.InputError, match="pages.tif: holds 2 pages; expected one"):
        isowave.relief(tmp_path / "pages.tif")
    with pytest.raises(isowave.InputError, match="heights: "):
        isowave.relief(np.zeros((3, 3)), depth=5)
    isowave.relief(hill()).save(tmp_path / "relief")
    with pytest.raises(isowave.InputError, match="relief"):
        isowave.CurveDetails.load(tmp_path / "relief")
    with pytest.raises(isowave.InputError, match="none"):
        isowave.ReliefDetails.load(tmp_path / "none")
