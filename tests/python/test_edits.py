"""Pyramid.edit(): the command's bytes, whatever a tool is given as."""

import gzip
import json
import math
import re

import numpy as np
import pytest
from conftest import GEAR, command, complaint

import isowave

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
SIDES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])  # fmt: skip


def block(low, high):
    return CORNERS * (np.array(high) - low) + low, SIDES


def write_off(path, mesh):
    points, triangles = mesh
    lines = ["OFF", f"{len(points)} {len(triangles)} 0"]
    lines += [" ".join(map(repr, map(float, p))) for p in points] + ["3 " + " ".join(map(str, t)) for t in triangles]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """A torus of radii 20 and 8 about the z axis, in a file of its own."""
    x, y, z = np.ogrid[-30:31, -30:31, -10:11]
    distance = np.hypot(np.hypot(x, y) - 20, z) - 8
    folder = tmp_path_factory.mktemp("ring")
    isowave.analyse(distance, iso=0, invert=True, spacing=(1, 1, 1), origin=(-30, -30, -10)).save(folder / "old.vdb")
    return folder / "old.vdb"


def commands(ring, out, *options):
    result = command("edit", ring, "-o", out, "--json", "-", *options)
    assert result.returncode == 0, result.stderr
    return out.read_bytes(), json.loads(result.stdout)


def stable(report):
    return {key: value for key, value in report.items() if key not in ("input", "output", "seconds")}


def expect_same(ring, tmp_path, options, *ways):
    """Each way to call edit() makes what the command makes of its options. Returns the last result."""
    wanted, told = commands(ring, tmp_path / "command.vdb", *options)
    old = isowave.Pyramid.load(ring)
    for arguments in ways:
        new = old.edit(**arguments)
        new.save(tmp_path / "python.vdb")
        assert (tmp_path / "python.vdb").read_bytes() == wanted
        assert stable(new.report) == stable(told) and new.report["input"] is None and new.report["output"] is None
        assert new.remarks == told["remarks"]
    return new


def test_balls_and_boxes_are_the_commands_to_the_byte(ring, tmp_path):
    options = ("--add", "ball:0.1,0,0,6", "--add", "18,-3,-12:23,3,3", "--cut", "box:-23,-3,-3,-18,3,12", "--level", 1)
    cut = ([-23, -3, -3], [-18, 3, 12])
    tools = (["ball:0.1,0,0,6", "18,-3,-12:23,3,3"], [((0.1, 0, 0), 6), ((18, -3, -12), (23, 3, 3))],
             [(np.array([0.1, 0, 0]), np.float32(6)), np.array([[18, -3, -12], [23, 3, 3]])])  # fmt: skip
    expect_same(ring, tmp_path, options, *({"add": add, "cut": cut, "level": 1} for add in tools))


def test_files_and_fillets_are_the_commands_to_the_byte(ring, tmp_path):
    write_off(tmp_path / "block.off", block((15, -4, 0), (25, 4, 14)))
    (tmp_path / "block.off.gz").write_bytes(gzip.compress((tmp_path / "block.off").read_bytes()))
    for name in ("block.off", "block.off.gz"):
        options = ("--add", tmp_path / name, "--blend", 2.5, "--check")
        tools = (tmp_path / name, str(tmp_path / name))
        new = expect_same(ring, tmp_path, options, *({"add": tool, "blend": 2.5, "check": True} for tool in tools))
        assert new.report["steps_closed"] == new.report["steps_checked"] > 0


def test_a_mesh_in_memory_is_its_file(ring, tmp_path):
    mesh = block((15, -4, 0), (25, 4, 14))
    write_off(tmp_path / "block.off", mesh)
    old = isowave.Pyramid.load(ring)
    file, memory = old.edit(add=tmp_path / "block.off", level=1), old.edit(add=mesh, level=1)
    assert memory.report["edits"][0]["edit"] == "--add a mesh"
    assert memory.report["edits"][0]["tool_volume"] == pytest.approx(10 * 8 * 14)
    points = np.random.default_rng(0).uniform(-30, 30, (300, 3))
    for step in (0, 3, old.step_count):
        np.testing.assert_array_equal(file.field(step)(points), memory.field(step)(points))
    # A level of a ladder is a mesh, too.
    level = isowave.lod(*mesh, voxels=24, levels=0)[0]
    assert old.edit(cut=level).report["edits"][0]["tool_volume"] == pytest.approx(level.report["volume"], rel=1e-9)


def test_parts_move_as_the_command_moves_them(ring, tmp_path):
    options = ("--move", "-30,-30,-10:-5,30,10", "--by", "-4.5,0,0.25")
    box, by = ((-30, -30, -10), (-5, 30, 10)), (-4.5, 0, 0.25)
    moves = ((box, by), ("-30,-30,-10:-5,30,10", "-4.5,0,0.25"), [(np.array(box), np.array(by))])
    expect_same(ring, tmp_path, options, *({"move": move} for move in moves))


def test_several_calls_make_the_bits_of_one_line(ring, tmp_path):
    wanted, _ = commands(ring, tmp_path / "command.vdb", "--cut", "ball:20,0,0,9", "--add", "ball:20,0,0,3", "--add", "ball:0,20,8,4")
    old = isowave.Pyramid.load(ring)
    for new in (old.edit(cut="ball:20,0,0,9").edit(add=["ball:20,0,0,3", "ball:0,20,8,4"]),
                old.edit(cut="ball:20,0,0,9").edit(add="ball:20,0,0,3").edit(add="ball:0,20,8,4")):  # fmt: skip
        new.save(tmp_path / "python.vdb")
        assert (tmp_path / "python.vdb").read_bytes() == wanted
    assert new.source["edit.0"] == "--cut ball:20,0,0,9 --level 0" and "edit.2" in new.source


def test_the_old_pyramid_undoes_edits(ring, tmp_path):
    old = isowave.Pyramid.load(ring)
    new = old.edit(cut="ball:20,0,0,5")
    for other in (old, ring, str(ring)):
        new.edit(with_=other).save(tmp_path / "again.vdb")
        assert (tmp_path / "again.vdb").read_bytes() == ring.read_bytes()
    assert new.edit(with_=old).report["edits"][0]["edit"] == "--with a pyramid"
    assert old.report is None and isowave.Pyramid.load(ring).report is None


def test_a_level_is_replaced_by_a_field(ring, tmp_path):
    old = isowave.Pyramid.load(ring)
    new = old.edit(cut="ball:20,0,0,5")
    filled = new.edit(with_=old.field(3), level=1)
    assert filled.report["edits"][0]["edit"] == "--with a field"
    old.field(3).save(tmp_path / "level1.vdb")
    new.save(tmp_path / "new.vdb")
    _, told = commands(tmp_path / "new.vdb", tmp_path / "command.vdb", "--with", tmp_path / "level1.vdb", "--level", 1)
    assert filled.report["edits"][0]["volume_after"] == told["edits"][0]["volume_after"]
    with pytest.raises(isowave.InputError, match="another lattice"):
        new.edit(with_=old.field(3))


def test_half_a_ball_has_its_volume_at_every_level():
    """Half a ball of radius r cut off a flat side: 2/3 pi r^3."""
    slab = np.zeros((60, 60, 36), np.float32)
    slab[:] = 17.3 - np.arange(36)  # above 0: below z = 17.3
    slab = np.minimum(slab, np.minimum.outer(*[np.minimum(np.arange(60), 59 - np.arange(60)) - 5.0] * 2)[:, :, None])
    slab = np.minimum(slab, np.arange(36) - 3.0)
    old = isowave.analyse(slab, iso=0, spacing=(0.5, 0.5, 0.5))
    for r, level in ((2.5, 0), (4, 1), (5, 2)):
        ball = ((29.5 / 2, 29.5 / 2, 17.3 / 2), r)
        for change in (old.edit(cut=ball, level=level), old.edit(add=ball, level=level)):
            volume = abs(change.report["edits"][0]["volume_change"])
            assert volume == pytest.approx(2 / 3 * math.pi * r**3, rel=0.04), (r, level)


def test_complaints_are_the_commands_line(ring, tmp_path):
    old = isowave.Pyramid.load(ring)
    write_off(tmp_path / "open.off", (CORNERS * 5, SIDES[:-1]))
    out = ("-o", tmp_path / "x.vdb")
    for arguments, options in (
        ({}, ()),
        ({"cut": "ball:1,2,3"}, ("--cut", "ball:1,2,3")),
        ({"cut": ((20, 0, 0), 3), "blend": -1}, ("--cut", "ball:20,0,0,3", "--blend", "-1")),
        ({"cut": ((20, 0, 0), 3), "level": 99}, ("--cut", "ball:20,0,0,3", "--level", 99)),
        ({"cut": ((20, 0, 0), 3), "level": -1}, ("--cut", "ball:20,0,0,3", "--level", -1)),
        ({"cut": ((500, 0, 0), 3)}, ("--cut", "ball:500,0,0,3")),
        ({"cut": ((0, 0, 0), 60)}, ("--cut", "ball:0,0,0,60")),
        ({"add": tmp_path / "open.off"}, ("--add", tmp_path / "open.off")),
        ({"add": tmp_path / "none.stl"}, ("--add", tmp_path / "none.stl")),
        ({"with_": tmp_path / "none.vdb"}, ("--with", tmp_path / "none.vdb")),
        ({"with_": ring}, ("--with", ring)),
    ):
        with pytest.raises((isowave.UsageError, isowave.InputError)) as caught:
            old.edit(**arguments)
        assert str(caught.value) == complaint("edit", ring, *options, *out), options


def test_what_is_no_tool_is_refused(ring):
    old = isowave.Pyramid.load(ring)
    nan = float("nan")
    for bad in (3, ((0, 0), 1), ((0, 0, 0), nan), ((0, 0, 0), "x"), ((0, 0, 0), -1), ((0, 0, nan), 1), [(0, 0, 0), 1], dict,
                ((0, 0, 0), (1, 1)), ((0, 0, 0), (1, 1, 0)), np.zeros(3), (1, 2), {}):  # fmt: skip
        with pytest.raises((isowave.UsageError, isowave.InputError), match="^--cut"):
            old.edit(cut=bad)
    for bad in ("0,0,0:1,1,1", ("ball:0,0,0,1", (1, 0, 0)), (((0, 0, 0), 1), (1, 0, 0)), (((0, 0, 0), (1, 1, 1)),)):
        with pytest.raises(isowave.UsageError, match="^--move"):
            old.edit(move=bad)
    for bad in (1, (1, 2), "1,2", (0, 0, nan), ("x", 0, 0)):
        with pytest.raises(isowave.UsageError, match="^--by"):
            old.edit(move=(((0, 0, 0), (1, 1, 1)), bad))
    with pytest.raises(isowave.UsageError, match="--with: 3 is a int"):
        old.edit(with_=3)
    with pytest.raises(isowave.InputError, match="the mesh of a tool: is open"):
        old.edit(add=(CORNERS, SIDES[:-1]))


def test_a_part_of_its_own_is_remarked_and_a_callback_stops(ring):
    old = isowave.Pyramid.load(ring)
    new = old.edit(add=((0, 0, 0), 5))
    assert new.remarks == ["--add ball:0,0,0,5: touches nothing; it is a part of its own"]

    def stop(share, stage):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        old.edit(add=((0, 0, 0), 5), check=True, progress=stop)
    one = old.edit(add=((0, 0, 0), 5), threads=1)
    points = np.random.default_rng(0).uniform(-30, 30, (300, 3))
    np.testing.assert_array_equal(one.field(0)(points), new.field(0)(points))


def test_every_option_of_the_command_is_an_argument():
    import inspect

    from isowave import _native

    parameters = set(inspect.signature(isowave.Pyramid.edit).parameters)
    taken = {name[2:] for name in _native.edit_option_names()}
    assert {name.replace("with", "with_").replace("-", "_") for name in taken - {"by"}} <= parameters
    shown = command("edit", "--help").stdout
    names = set(re.findall(r"^ *(?:-\w, *)?--([a-z-]+)", shown, re.MULTILINE))
    assert len(taken) > 6 and names - taken - {"help"} == {"output", "json", "threads", "quiet", "verbose", "progress"}
