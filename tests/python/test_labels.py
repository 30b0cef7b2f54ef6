"""Label images of which every label is a solid of its own: what lod --each-label makes."""

import json

import numpy as np
import pytest
from conftest import command
from test_ladders import stable


import isowave


@pytest.fixture
def two_labels(tmp_path):
    """A segmentation of two balls, 1 with a name and a colour, 2 with a name."""
    x, y, z = np.ogrid[:30, :18, :18]
    voxels = 1 * ((x - 8) ** 2 + (y - 9) ** 2 + (z - 9) ** 2 < 36) + 2 * ((x - 22) ** 2 + (y - 9) ** 2 + (z - 9) ** 2 < 30)
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 30 18 18\nspacings: 1 1 1\nencoding: raw\n"
              "Segment0_ID:=a\nSegment0_Name:=the left\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Color:=1 0.5 0\n"
              "Segment1_ID:=b\nSegment1_Name:=the right\nSegment1_LabelValue:=2\nSegment1_Layer:=0\n\n")  # fmt: skip
    path = tmp_path / "two.seg.nrrd"
    path.write_bytes(header.encode() + voxels.astype(np.uint8).tobytes(order="F"))
    return path, voxels.astype(np.uint8)


def test_files_of_labels_are_those_of_the_command(two_labels, tmp_path):
    path, _ = two_labels
    made = isowave.each_label(path, levels=(0, 1))
    assert made.names == {1: "the left", 2: "the right"} and made.colours[1] == "#FF8000"
    saved = made.save(tmp_path / "a/two")
    options = ("--levels", "0..1", "--each-label", "--format", "3mf", "-o", tmp_path / "b/two", "--quiet")
    assert command("lod", path, *options).returncode == 0
    assert [p.rsplit("/", 1)[1] for p in saved] == ["two_L0.3mf", "two_L1.3mf", "report.json"]
    for name in ("two_L0.3mf", "two_L1.3mf"):
        assert (tmp_path / "a/two" / name).read_bytes() == (tmp_path / "b/two" / name).read_bytes()
    reports = [json.loads((tmp_path / x / "two/report.json").read_text()) for x in "ab"]
    assert all(report.pop("remarks") for report in reports)
    assert stable(reports[0]) == stable(reports[1])


def test_labels_of_an_array_have_the_meshes_of_the_file(two_labels):
    path, voxels = two_labels
    from_file, from_array = isowave.each_label(path, levels=0), isowave.each_label(voxels, spacing=(1, 1, 1), levels=0)
    assert list(from_array) == [1, 2] and from_array.names[2] == "label 2"
    for label in (1, 2):
        assert (from_array[label][0].points == from_file[label][0].points).all()
    assert list(isowave.each_label(voxels, spacing=(1, 1, 1), label=2, levels=0)) == [2]


def test_what_has_no_labels_or_a_budget_is_refused(two_labels):
    with pytest.raises(isowave.UsageError, match="--each-label and budgets exclude each other"):
        isowave.each_label(two_labels[0], triangles=100)
    with pytest.raises(isowave.InputError, match="is no label image"):
        isowave.each_label(np.linspace(0, 1, 1000).reshape(10, 10, 10))
    with pytest.raises(isowave.InputError, match="there is no label"):
        isowave.each_label(np.zeros((8, 8, 8), np.uint8))
