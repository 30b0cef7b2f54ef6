"""Curves: what the command makes of the same input."""

import json

import numpy as np
import pytest
from conftest import DATA, command, complaint

import isowave

AFRICA = DATA / "curves2d/africa.geojson"
KEYRING = DATA / "curves2d/keyring.png"


def command_curves(tmp_path, source, *options):
    result = command("curves", source, "-o", tmp_path / "out/x", "--json", "-", "--quiet", *options)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def stable(report):
    return {key: [{k: v for k, v in step.items() if k != "file"} for step in value] if key == "steps" else value
            for key, value in report.items() if key not in ("peak_memory_bytes", "remarks")}  # fmt: skip


@pytest.mark.parametrize("source, options", [(AFRICA, {"pixels": 256}), (KEYRING, {}), (KEYRING, {"smooth": True, "hold": "none"})])
def test_report_and_files_are_those_of_the_command(tmp_path, source, options):
    words = [w for k, v in options.items() for w in ([f"--{k}"] if v is True else [f"--{k}", v])]
    ladder = isowave.curves(source, **options)
    assert stable(ladder.report) == stable(command_curves(tmp_path, source, *words))
    for level in ladder:
        level.save(tmp_path / "one.svg")
        assert (tmp_path / "one.svg").read_bytes() == (tmp_path / f"out/x/x_L{level.level}.svg").read_bytes()


def test_rings_are_those_of_the_report_and_enclose_its_area():
    for level in isowave.curves(AFRICA, pixels=256):
        area = sum(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2 for x, y in (r.points.T for r in level.rings))
        assert area == pytest.approx(level.report["area"], rel=1e-9)
        assert sum(r.hole for r in level.rings) == level.report["holes"]
        assert sum(len(r.points) for r in level.rings) == level.report["points"]


def test_polygons_in_memory_are_those_of_a_file(tmp_path):
    data = json.loads(AFRICA.read_text())
    polygons = data["geometry"]["coordinates"]
    of_file, of_lists = isowave.curves(AFRICA, pixels=128), isowave.curves(polygons, pixels=128)
    assert [level.report for level in of_file] == [level.report for level in of_lists]

    class Shape:
        __geo_interface__ = {"type": "MultiPolygon", "coordinates": polygons}

    assert [level.report for level in isowave.curves(Shape(), pixels=128)] == [level.report for level in of_file]


def test_geojson_in_memory_is_that_of_a_file(tmp_path):
    polygons = json.loads(AFRICA.read_text())["geometry"]["coordinates"]
    one, rest = {"type": "Polygon", "coordinates": polygons[0]}, {"type": "MultiPolygon", "coordinates": polygons[1:]}
    collection = {"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": {"type": "GeometryCollection", "geometries": [one]}},
        {"type": "Feature", "properties": {}, "geometry": None},
        {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
        {"type": "Feature", "properties": {}, "geometry": rest}]}  # fmt: skip
    (tmp_path / "a.geojson").write_text(json.dumps(collection))

    class Frame:  # as geopandas has it
        __geo_interface__ = collection

    of_file = isowave.curves(tmp_path / "a.geojson", pixels=128)
    assert "1 geometry that is no polygon left out (first: Point)" in of_file.remarks
    for source in (collection, Frame()):
        ladder = isowave.curves(source, pixels=128)
        assert [level.report for level in ladder] == [level.report for level in of_file]
        assert ladder.remarks == [remark.replace(f"{tmp_path / 'a.geojson'}: ", "") for remark in of_file.remarks]


@pytest.mark.parametrize("source, says", [
    ({"type": "FeatureCollection", "features": []}, "holds no geometry; expected Polygon"),
    ({"type": "Feature", "geometry": {"type": "Point", "coordinates": [0, 0]}}, "is a Point; expected Polygon"),
    ({"type": "Feature"}, "a Feature without 'geometry'; expected GeoJSON"),
    ({"type": "Polygon"}, "a Polygon without 'coordinates'; expected GeoJSON"),
    ({"features": []}, 'an object without a "type"; expected GeoJSON'),
    ([np.zeros((3, 2))], r"polygon 0 is one ring of the shape \(3, 2\); expected a list of rings"),
])  # fmt: skip
def test_what_is_no_polygon_is_told(source, says):
    with pytest.raises(isowave.InputError, match=says):
        isowave.curves(source)


def test_pixels_must_be_finite():
    picture = np.zeros((20, 20), np.float32)
    picture[5:15, 5:15] = 1
    picture[9, 7] = np.nan
    with pytest.raises(isowave.InputError, match=r"picture: pixel \(7, 9\) is nan; 1 of 400 pixels are not finite"):
        isowave.curves(picture)


def test_other_texts_and_the_sheet(tmp_path):
    ladder = isowave.curves(KEYRING, levels=(0, 2))
    assert [level.level for level in ladder] == [0, 1, 2]
    assert json.loads(ladder[0].text("geojson"))["type"] == "FeatureCollection" and ladder[0].text("txt").startswith("> outer")
    assert ladder.sheet().count("<path") >= 3 and "<svg" in ladder[0]._repr_svg_()
    assert ladder._repr_html_().count("<tr>") == 4
    with pytest.raises(isowave.UsageError, match="--format: 'png'"):
        ladder[0].save(tmp_path / "x.png")


def test_steps_are_those_of_the_command(tmp_path):
    ladder = isowave.curves(AFRICA, pixels=128, steps=(1, 4))
    assert [(level.step, level.level) for level in ladder] == [(1, None), (2, 1), (3, None), (4, 2)]
    assert stable(ladder.report) == stable(command_curves(tmp_path, AFRICA, "--pixels", 128, "--steps", "1..4"))
    ladder[0].save(tmp_path / "one.svg")
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "out/x/x_L0a.svg").read_bytes()
    assert "step 1" in repr(ladder[0]) and "0a" in ladder._repr_html_()
    with pytest.raises(isowave.UsageError, match="exclude each other"):
        isowave.curves(AFRICA, levels=1, steps=2)


def test_a_pyramid_takes_the_place_of_its_input(tmp_path):
    made = isowave.curves(AFRICA, pixels=128, pyramid=tmp_path / "new/p.iwc")
    command_curves(tmp_path, AFRICA, "--pixels", 128, "--pyramid", tmp_path / "c.iwc")
    assert (tmp_path / "new/p.iwc").read_bytes() == (tmp_path / "c.iwc").read_bytes()
    read = isowave.curves(tmp_path / "c.iwc")
    assert [level.text() for level in read] == [level.text() for level in made]
    assert [level.report for level in read] == [level.report for level in made]
    with pytest.raises(isowave.UsageError, match="fitted already"):
        isowave.curves(tmp_path / "c.iwc", pixels=128)
    with pytest.raises(isowave.UsageError, match="does not end in .iwc"):
        isowave.curves(AFRICA, pyramid=tmp_path / "p.vdb")
    with pytest.raises(isowave.UsageError, match="c.iwc"):
        isowave.curves(tmp_path / "c.iwc", pyramid=tmp_path / "c.iwc")
    (tmp_path / "cut.iwc").write_bytes((tmp_path / "c.iwc").read_bytes()[:200])
    with pytest.raises(isowave.InputError, match="truncated"):
        isowave.curves(tmp_path / "cut.iwc")


def test_edits_are_those_of_the_command(tmp_path):
    (tmp_path / "square.txt").write_text("20 0\n60 0\n60 20\n20 20\n")
    (tmp_path / "small.txt").write_text("21 1\n25 1\n25 5\n21 5\n")
    square, small = tmp_path / "square.txt", tmp_path / "small.txt"
    ladder = isowave.curves(AFRICA, pixels=128, add=square, cut=[small], edit_level=1, levels=(0, 2))
    words = ["--pixels", 128, "--add", square, "--cut", small, "--edit-level", 1, "--levels", "0..2"]
    assert stable(ladder.report) == stable(command_curves(tmp_path, AFRICA, *words))
    (tmp_path / "far.txt").write_text("900 900\n950 900\n950 950\n")
    with pytest.raises(isowave.InputError, match="far.txt: cuts nothing away"):
        isowave.curves(square, cut=tmp_path / "far.txt")


def test_errors(tmp_path):
    with pytest.raises(isowave.UsageError) as caught:
        isowave.curves(KEYRING, pixels=64)
    assert str(caught.value) == complaint("curves", KEYRING, "-o", tmp_path / "x", "--pixels", 64)
    with pytest.raises(isowave.InputError, match="no such file"):
        isowave.curves(tmp_path / "none.png")
    with pytest.raises(isowave.InputError, match="3 dimensions"):
        isowave.curves(np.zeros((3, 3, 3)))
    with pytest.raises(isowave.InputError, match="ring 0 has the shape"):
        isowave.curves([[[1, 2, 3]]])
    with pytest.raises(isowave.UsageError, match="holds no curves"):
        isowave.curves(3)
    with pytest.raises(isowave.UsageError, match="--band is larger"):
        isowave.curves(KEYRING, band=5)
