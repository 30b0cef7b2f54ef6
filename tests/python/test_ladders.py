"""Ladders, levels, fields, pyramids: what the command makes of the same input, without files between."""

import gc
import json
import re

import numpy as np
import pytest
from conftest import GEAR, command, command_report, complaint

import isowave

TETRAHEDRON = (
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float),
    np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]),
)
UNSTABLE = ("seconds", "peak_memory_bytes", "file", "memory_bytes")


@pytest.fixture(scope="module")
def gear():
    return isowave.lod(GEAR, voxels=64, levels=(0, 2))


def stable(value):
    """Without what differs from run to run, and the names of files."""
    if isinstance(value, dict):
        return {key: stable(v) for key, v in value.items() if key not in UNSTABLE}
    return [stable(v) for v in value] if isinstance(value, list) else value


def test_report_is_that_of_the_command(gear, tmp_path):
    assert stable(gear.report) == stable(command_report(tmp_path, GEAR, "--voxels", 64, "--levels", "0..2"))
    assert [level.report for level in gear] == gear.report["levels"]


def test_save_writes_the_commands_files_to_the_byte(gear, tmp_path):
    command_report(tmp_path, GEAR, "--voxels", 64, "--levels", "0..2")
    (tmp_path / "command").rename(tmp_path / "out")
    assert command("lod", GEAR, "--voxels", 64, "--levels", "0..2", "-o", tmp_path / "a/part", "--quiet").returncode == 0
    written = gear.save(tmp_path / "b/part")
    names = sorted(p.name for p in (tmp_path / "a/part").iterdir())
    assert sorted(p.rsplit("/", 1)[1] for p in written) == names == sorted(p.name for p in (tmp_path / "b/part").iterdir())
    for name in names:
        a, b = (tmp_path / x / "part" / name for x in "ab")
        if name == "report.json":
            assert [level["file"] for level in json.loads(b.read_text())["levels"]] == names[:-1]
        else:
            assert a.read_bytes() == b.read_bytes()


def test_save_refuses_what_the_command_refuses(gear, tmp_path):
    with pytest.raises(isowave.UsageError, match="--format: 'xyz' is not one of stl, ply"):
        gear.save(tmp_path / "out", format="xyz")
    with pytest.raises(isowave.UsageError, match="--space: the axes of this input have no medical meaning"):
        gear.save(tmp_path / "out", space="lps")
    (tmp_path / "file").write_text("")
    with pytest.raises(isowave.OperationError):
        gear.save(tmp_path / "file/out")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_distances_to_level_0_are_saved_as_the_command_saves_them(gear, tmp_path):
    options = "--voxels", 64, "--levels", "0..2", "--colour", "distance", "--format"
    for format in "ply", "vtp", "glb":
        assert command("lod", GEAR, *options, format, "-o", tmp_path / "a" / format).returncode == 0
        for path in gear.save(tmp_path / "b" / format, format=format, colour="distance")[:-1]:
            assert open(path, "rb").read() == (tmp_path / "a" / format / path.rsplit("/", 1)[1]).read_bytes()
    gear[2].save(tmp_path / "one.ply", colour="distance")
    assert (tmp_path / "one.ply").read_bytes() == (tmp_path / "b/ply/ply_L2.ply").read_bytes()
    assert b"property float distance_to_level0" in (tmp_path / "one.ply").read_bytes()
    with pytest.raises(isowave.UsageError, match="--colour distance needs a format with numbers at vertices, which stl"):
        gear.save(tmp_path / "out", format="stl", colour="distance")
    with pytest.raises(isowave.UsageError, match="let the levels begin with 0"):
        isowave.lod(GEAR, voxels=32, levels=(1, 2)).save(tmp_path / "out", colour="distance")
    assert not (tmp_path / "out").exists()


def test_save_does_not_replace_its_input(tmp_path):
    source = tmp_path / "part_L0.stl"
    source.write_bytes(GEAR.read_bytes())
    (tmp_path / "part").mkdir()
    source = source.rename(tmp_path / "part/part_L0.stl")
    ladder = isowave.lod(source, voxels=32, levels=0)
    with pytest.raises(isowave.UsageError, match="is what this command reads"):
        ladder.save(tmp_path / "part", format="stl")
    assert source.read_bytes() == GEAR.read_bytes()


def test_arrays_are_views_that_outlive_the_ladder():
    ladder = isowave.lod(GEAR, voxels=48, levels=0)
    points, triangles = ladder[0].mesh
    assert points.dtype == np.float64 and triangles.dtype == np.int32 and points.flags.c_contiguous
    assert not points.flags.owndata and not triangles.flags.owndata and not points.flags.writeable
    assert np.shares_memory(points, ladder[0].mesh.points)
    kept = points.copy()
    del ladder
    gc.collect()
    np.array_equal(points, kept)
    assert triangles.min() == 0 and triangles.max() == len(points) - 1


def test_a_level_is_closed_and_its_volume_is_that_of_its_triangles(gear):
    for level in gear:
        a, b, c = level.points[level.triangles].transpose(1, 0, 2)
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        assert volume == pytest.approx(level.report["volume"], rel=1e-9)
        assert isowave.check(level) and isowave.check(level.mesh).volume == pytest.approx(volume, rel=1e-9)
        np.testing.assert_allclose(np.linalg.norm(level.normals, axis=1), 1, atol=1e-5)


def test_indexing_is_that_of_a_sequence(gear):
    assert len(gear) == 3 and gear[-1].level == 2 and [level.step for level in gear[1:]] == [3, 6]
    assert [level.level for level in gear] == [0, 1, 2] and gear[0] in gear
    with pytest.raises(IndexError):
        gear[3]


def test_the_ladder_ends_before_a_level_at_which_nothing_is_left(ball):
    ladder = isowave.lod(ball, spacing=(1, 1, 1), hold="none")
    assert all(len(level.triangles) > 0 for level in ladder)


def test_budgets_come_after_levels(tmp_path):
    part = isowave.lod(GEAR, voxels=32, triangles=[2000, 500], levels=0)
    assert len(part.levels) == 1 and len(part.budgets) == 2 and part[1] is part.budgets[0]
    assert [len(level.triangles) <= most for level, most in zip(part.budgets, (2000, 500))] == [True, True]
    assert part[1].report["triangles_asked"] == 2000 and "why" in part[2].report
    report = command_report(tmp_path, GEAR, "--voxels", 32, "--triangles", "2000,500", "--levels", 0)
    assert stable(part.report) == stable(report)
    names = [p.rsplit("/", 1)[1] for p in part.save(tmp_path / "x/part")]
    assert names == ["part_L0.ply", "part_T2000.ply", "part_T500.ply", "report.json"]


def test_one_level_is_saved_in_the_format_of_its_name(gear, tmp_path):
    for extension in ("stl", "ply", "obj", "off", "glb", "vtp", "3mf"):
        gear[2].save(tmp_path / f"new/part.{extension}")
        assert isowave.check(tmp_path / f"new/part.{extension}")
    with pytest.raises(isowave.InputError):
        gear[2].save(tmp_path / "part.xyz")


@pytest.mark.parametrize("levels, found", [(1, [1]), ("1..2", [1, 2]), ((1, 2), [1, 2]), (range(0, 2), [0, 1]), ([0, 1], [0, 1]), ((2, None), None)])
def test_ranges_of_levels(levels, found):
    made = [level.level for level in isowave.lod(GEAR, voxels=32, levels=levels)]
    assert made == found or (found is None and made[0] == 2)


@pytest.mark.parametrize("levels", [[0, 2], [], [None, 1], ["a"]])
def test_a_list_of_levels_leaves_none_out(levels):
    with pytest.raises(isowave.UsageError, match="levels: .* leaves some out; give"):
        isowave.lod(np.ones((2, 2, 2)), levels=levels)


def test_steps_between_levels():
    ladder = isowave.lod(GEAR, voxels=32, steps=(2, 3))
    assert [level.step for level in ladder] == [2, 3] and ladder[0].level is None


def test_field_is_that_of_the_pyramid_and_of_the_command(gear, tmp_path):
    pyramid = isowave.analyse(GEAR, voxels=64)
    points = gear[1].points[::50]
    np.testing.assert_array_equal(gear[1].field(points), isowave.field(GEAR, voxels=64, step=3)(points))
    np.testing.assert_allclose(gear[1].field(points), pyramid.field(3)(points), atol=1e-5)  # there and back in float32
    gear[1].field.save(tmp_path / "python.vdb")
    assert command("field", GEAR, "--voxels", 64, "--step", 3, "-o", tmp_path / "command.vdb").returncode == 0
    assert (tmp_path / "python.vdb").read_bytes() == (tmp_path / "command.vdb").read_bytes()


def test_field_is_zero_on_its_mesh_and_its_gradient_points_outside():
    field = isowave.field(GEAR, voxels=64)
    mesh = field.polygonize(refine=2)
    values = field(mesh.mesh.points)
    step = np.linalg.norm(field.gradient(mesh.mesh.points), axis=1) * min(field.spacing)
    assert np.median(np.abs(values) / step) < 0.02  # in voxels
    inside = np.einsum("ij,ij->i", field.gradient(mesh.mesh.points), mesh.normals)
    assert (inside > 0).mean() > 0.999
    ahead = field(mesh.mesh.points[:100] + 1e-4 * field.gradient(mesh.mesh.points[:100]))
    assert (ahead > values[:100]).all()
    with pytest.raises(isowave.UsageError):
        field.polygonize(refine=3)
    with pytest.raises(isowave.UsageError):
        field.polygonize(iso=2)
    with pytest.raises(isowave.UsageError, match="have the shape"):
        field([1, 2])


def test_regions_are_those_of_the_command(tmp_path):
    box, ring = "-40,-40,-40:0,40,40", "0,-40,-40:40,0,40:1"
    ladder = isowave.lod(GEAR, voxels=48, levels=(0, 2), fine=[box, ring], fine_within=0.5)
    report = command_report(tmp_path, GEAR, "--voxels", 48, "--levels", "0..2", "--fine", box, "--fine", ring, "--fine-within", 0.5)
    assert stable(ladder.report) == stable(report)
    assert ladder[2].report["regions"]["triangles_inside"] > 0 and ladder[0].report["regions"] is None
    one = isowave.lod(GEAR, voxels=48, levels=(0, 1), fine=box)
    assert len(one[1].triangles) > len(isowave.lod(GEAR, voxels=48, levels=(0, 1))[1].triangles)
    with pytest.raises(isowave.InputError, match="none.stl"):
        isowave.lod(GEAR, voxels=32, fine=tmp_path / "none.stl")


def test_keep_field_false_has_no_field():
    ladder = isowave.lod(GEAR, voxels=32, levels=0, keep_field=False)
    with pytest.raises(isowave.UsageError, match="keep_field=False"):
        ladder[0].field


def test_pyramid_there_and_back(tmp_path):
    pyramid = isowave.analyse(*TETRAHEDRON, voxels=32)
    pyramid.save(tmp_path / "p.vdb")
    back = isowave.Pyramid.load(tmp_path / "p.vdb")
    assert back.steps == pyramid.steps and back.source == pyramid.source and back.K == pyramid.K
    points = np.random.default_rng(0).uniform(-0.1, 1.1, (200, 3))
    for step in (0, 4, pyramid.step_count):
        np.testing.assert_array_equal(back.field(step)(points), pyramid.field(step)(points))
    of_path, of_pyramid = isowave.lod(tmp_path / "p.vdb"), isowave.lod(pyramid)
    assert [level.report["volume"] for level in of_path] == [level.report["volume"] for level in of_pyramid]
    assert of_path[1].field(points) == pytest.approx(of_pyramid[1].field(points), abs=0)
    with pytest.raises(isowave.UsageError, match="no step 99"):
        pyramid.field(99)
    with pytest.raises(isowave.UsageError, match="--voxels"):
        isowave.lod(pyramid, voxels=32)
    (tmp_path / "no.vdb").write_bytes(b"no pyramid")
    with pytest.raises(isowave.InputError, match="no.vdb"):
        isowave.Pyramid.load(tmp_path / "no.vdb")


def test_a_packed_solid_is_a_pyramid_and_a_source(tmp_path):
    assert command("pack", GEAR, "--voxels", 32, "-o", tmp_path / "gear.iwz").returncode == 0
    whole = isowave.analyse(GEAR, voxels=32)
    packed = isowave.Pyramid.load(tmp_path / "gear.iwz")
    assert packed.steps == whole.steps and packed.remarks == []
    for step in (0, 3):
        a, b = (pyramid.field(step).polygonize() for pyramid in (packed, whole))
        np.testing.assert_array_equal(a.points, b.points)
    (level,) = isowave.lod(tmp_path / "gear.iwz", levels=(2, 2))
    np.testing.assert_array_equal(level.points, isowave.lod(GEAR, voxels=32, levels=(2, 2))[0].points)


def test_a_pyramid_is_saved_as_a_packed_solid(tmp_path):
    whole = isowave.analyse(GEAR, voxels=32)
    whole.save(tmp_path / "gear.iwz")
    back = isowave.Pyramid.load(tmp_path / "gear.iwz")
    a, b = (pyramid.field(0).polygonize() for pyramid in (back, whole))
    np.testing.assert_array_equal(a.triangles, b.triangles)
    np.testing.assert_allclose(a.points, b.points, atol=1e-4)  # level 0 is analysed and put together twice
    with pytest.raises(isowave.UsageError, match="packed ones .iwz"):
        whole.save(tmp_path / "gear.zip")


def test_a_solid_within_a_bound_says_so(tmp_path):
    assert command("pack", GEAR, "--voxels", 32, "--bound", "0.1voxel", "-o", tmp_path / "gear.iwz").returncode == 0
    (remark,) = isowave.Pyramid.load(tmp_path / "gear.iwz").remarks
    assert "within 0.1 voxels of what was packed" in remark


def test_errors_of_the_job_are_the_commands_one_line(tmp_path):
    for options in ({"voxels": 3}, {"voxel": -1}, {"refine": 3}, {"voxels": 32, "voxel": 1}, {"voxels": 32, "levels": 40},
                    {"iso": 1}, {"ratio": 2}, {"max_genus": -1}, {"unit": "yd"}, {"voxels": 64, "max_memory": 1e-6}):  # fmt: skip
        words = [word for name, value in options.items() for word in ("--" + name.replace("_", "-"), value)]
        with pytest.raises(isowave.Error) as caught:
            isowave.lod(GEAR, **options)
        assert str(caught.value) == complaint("lod", GEAR, "-o", tmp_path / "out", *words), options


def test_levels_of_flat_voxels_make_them_cubes_first(tmp_path):
    x, y, z = np.indices((40, 40, 20))
    ball = np.hypot(np.hypot(x - 19.5, y - 19.5), 2 * (z - 9.5)) < 15
    ladder = isowave.lod(ball, spacing=(1, 1, 2), levels=(0, 2))
    assert [level.step for level in ladder] == [0, 2, 5] and [level.level for level in ladder] == [0, 1, 2]
    assert [level.report["spacing"] for level in ladder] == [[1, 1, 2], [2, 2, 2], [4, 4, 4]]
    assert ladder.report["first_levels"] == ["xy"] and any("--axes xyz" in remark for remark in ladder.remarks)
    ladder.save(tmp_path / "ball")
    assert sorted(path.name for path in tmp_path.glob("ball/*.ply")) == ["ball_L0.ply", "ball_L1.ply", "ball_L2.ply"]
    in_turn = isowave.lod(ball, spacing=(1, 1, 2), levels=(0, 2), step_axes="xyz")
    assert [level.step for level in in_turn] == [0, 3, 6] and in_turn.report["first_levels"] == []
    pyramid = isowave.analyse(ball, spacing=(1, 1, 2))
    assert [step["level"] for step in pyramid.steps][:6] == [0, None, 1, None, None, 2]
    assert pyramid.field(2).spacing == isowave.field(ball, spacing=(1, 1, 2), step=2).spacing == (2, 2, 2)
    pyramid.save(tmp_path / "ball.vdb")
    with pytest.raises(isowave.UsageError, match="--axes has no meaning for"):
        isowave.lod(tmp_path / "ball.vdb", step_axes="xyz")


def test_every_option_of_the_command_is_an_argument():
    import inspect

    from isowave import _native, plane

    parameters = set(inspect.signature(isowave.lod).parameters)
    renamed = {"axes": "step_axes"}  # axes is the order of an array's indices
    options = {renamed.get(name, name) for name in (n[2:].replace("-", "_") for n in _native.solid_option_names())}
    assert options <= parameters, options - parameters
    shown = command("lod", "--help").stdout
    names = {renamed.get(name, name.replace("-", "_")) for name in re.findall(r"^ *(?:-\w, *)?--([a-z-]+)", shown, re.MULTILINE)}
    assert len(names) > 30 and names - parameters == {
        "output", "format", "colour", "json", "view", "glb_lods", "tiles", "each_label", "quiet", "verbose", "dry_run", "list",
    }  # fmt: skip
    of_curves = {name[2:].replace("-", "_") for name in _native.curve_option_names()}
    assert of_curves <= set(inspect.signature(plane.curves).parameters)
    given = set(inspect.signature(isowave.analyse).parameters)
    making = {"levels", "steps", "refine", "hold", "preserve_volume", "keep_specks", "features", "refit", "compact", "relax",
              "deviation", "fine", "fine_within", "adaptive", "triangles", "ratio", "tolerance", "max_genus", "max_parts", "min_component"}  # fmt: skip
    assert options - making <= given


def test_the_table_of_a_notebook_has_a_row_a_mesh(gear):
    html = gear._repr_html_()
    assert html.count("<tr>") == 4 and f"{len(gear[0].triangles):,}" in html and "gearwheel.bin.stl: 3 meshes" in html
    assert "color:#" not in html and "background:#" not in html  # the page's own colours
    budget = isowave.lod(GEAR, voxels=48, triangles=[500], unit="mm")._repr_html_()
    assert "at most 500 triangles" in budget


def test_names_that_look_like_html_are_text(tmp_path):
    path = tmp_path / "<b>&part.stl"
    path.write_bytes(GEAR.read_bytes())
    assert "&lt;b&gt;&amp;part.stl" in isowave.lod(path, voxels=32, levels=0)._repr_html_()


def test_tiles_are_those_of_the_command(tmp_path):
    ladder = isowave.lod(GEAR, voxels=32, levels=(0, 1))
    for tiles in ("neuroglancer", "3d-tiles"):
        paths = ladder.save(tmp_path / "out/gear", tiles=tiles)
        assert str(tmp_path / f"out/gear/gear_{tiles}") in paths
        command("lod", GEAR, "--voxels", 32, "--levels", "0..1", "--tiles", tiles, "-o", tmp_path / "by/gear")
        made, expected = tmp_path / f"out/gear/gear_{tiles}", tmp_path / f"by/gear/gear_{tiles}"
        names = sorted(p.relative_to(expected) for p in expected.rglob("*") if p.is_file())
        assert names == sorted(p.relative_to(made) for p in made.rglob("*") if p.is_file()) and len(names) >= 3
        assert all((made / name).read_bytes() == (expected / name).read_bytes() for name in names)
    with pytest.raises(isowave.UsageError, match="give --levels"):
        isowave.lod(GEAR, voxels=32, steps=(0, 1)).save(tmp_path / "steps", tiles="3d-tiles")
