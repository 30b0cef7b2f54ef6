"""Arrays and images: the same solid as of a file, wherever and however the voxels lie."""

import numpy as np
import pytest
from conftest import CRANIUM, command_report, complaint

import isowave

LPS = np.diag([-1.0, -1, 1, 1])


def volumes(ladder):
    return [level.report["volume"] for level in ladder]


def same(a, b):
    """To the bit."""
    return len(a) == len(b) and all(
        np.array_equal(x.points, y.points) and np.array_equal(x.triangles, y.triangles) for x, y in zip(a, b)
    )


def test_five_lines_from_a_nifti_to_five_meshes_of_the_commands_volumes(cranium, tmp_path):
    nibabel = pytest.importorskip("nibabel")
    array, affine = cranium
    path = tmp_path / "head.nii"
    nibabel.Nifti1Image(array, LPS @ affine).to_filename(path)

    import nibabel  # the five lines

    head = nibabel.load(path)
    ladder = isowave.lod(head, iso=300, levels=(0, 4))
    meshes = [level.mesh for level in ladder]
    ladder.save(tmp_path / "out/head")

    assert len(meshes) == 5
    report = command_report(tmp_path, path, "--iso", 300, "--levels", "0..4")
    expected = [level["volume"] for level in report["levels"]]
    assert len(expected) == 5
    np.testing.assert_allclose(volumes(ladder), expected, rtol=1e-9, atol=0)
    assert sorted(p.name for p in (tmp_path / "out/head").iterdir()) == [f"head_L{i}.ply" for i in range(5)] + ["report.json"]


def test_an_array_gives_what_its_file_gives_to_the_bit(cranium):
    array, affine = cranium
    of_file = isowave.lod(CRANIUM, iso=300, levels=(0, 2))
    assert same(isowave.lod(array, affine=affine, iso=300, levels=(0, 2)), of_file)


@pytest.fixture(scope="module")
def plain(ball):
    return isowave.lod(ball.astype(np.uint8), spacing=(1, 2, 3), levels=(0, 1))


@pytest.mark.parametrize("dtype", ["?", "i1", "u1", "<i2", ">i2", "<u2", ">u2", "<i4", ">i4", "<u4", ">u4", "<i8", ">i8", "<u8",
                                   ">u8", "<f4", ">f4", "<f8", ">f8"])  # fmt: skip
@pytest.mark.parametrize("order", ["C", "F"])
def test_any_type_of_number_and_byte_order(ball, plain, dtype, order):
    assert same(isowave.lod(ball.astype(dtype, order=order), spacing=(1, 2, 3), levels=(0, 1)), plain)


def laid_out(ball):
    big = np.zeros([2 * n for n in ball.shape], np.float32)
    big[::2, ::2, ::2] = ball
    yield "every second voxel", big[::2, ::2, ::2]
    yield "backwards", ball[::-1, ::-1, ::-1].astype(np.int16)[::-1, ::-1, ::-1]
    for axes in [(0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1)]:
        back = np.argsort(axes)
        yield f"in memory by axes {axes}", np.ascontiguousarray(ball.transpose(axes).astype(np.float64)).transpose(back)
    raw = bytearray(1) + ball.astype("<f4").tobytes(order="F")
    yield "not aligned", np.ndarray(ball.shape, "<f4", raw, 1, order="F")
    frozen = ball.astype(np.uint8)
    frozen.setflags(write=False)
    yield "read-only", frozen
    yield "nested lists", ball.astype(int).tolist()


def test_any_layout_in_memory(ball, plain):
    for name, array in laid_out(ball):
        assert same(isowave.lod(array, spacing=(1, 2, 3), levels=(0, 1)), plain), name


def test_axes_zyx_are_the_indices_of_simpleitk_and_the_place_stays_xyz(ball, plain):
    reversed_indices = np.ascontiguousarray(ball.transpose(2, 1, 0))
    assert same(isowave.lod(reversed_indices, axes="zyx", spacing=(1, 2, 3), levels=(0, 1)), plain)


def test_the_mesh_lies_where_the_affine_says(ball):
    turn = np.array([[0.0, -2, 0, 10], [1, 0, 0, 20], [0, 0, 3, 30], [0, 0, 0, 1]])
    points = isowave.lod(ball, affine=turn, levels=0)[0].points
    middle = turn @ [13.2, 12.6, 11.4, 1]
    np.testing.assert_allclose((points.min(0) + points.max(0)) / 2, middle[:3], atol=0.5)
    np.testing.assert_allclose(points.max(0) - points.min(0), [36, 18, 54], atol=2)


def test_ras_is_lps_with_two_axes_turned(ball):
    lps = isowave.lod(ball, spacing=(1, 2, 3), origin=(5, 6, 7), levels=0)
    ras = isowave.lod(ball, affine=LPS @ np.array([[1, 0, 0, 5], [0, 2, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1.0]]), space="RAS", levels=0)
    assert same(lps, ras)


def test_spacing_origin_and_direction_make_the_affine(ball):
    direction = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1.0]])
    affine = np.column_stack([direction * [1, 2, 3], [5, 6, 7]])
    by_parts = isowave.lod(ball, spacing=(1, 2, 3), origin=(5, 6, 7), direction=direction, levels=0)
    flat = isowave.lod(ball, spacing=(1, 2, 3), origin=(5, 6, 7), direction=direction.ravel(), levels=0)
    assert same(by_parts, isowave.lod(ball, affine=affine, levels=0)) and same(by_parts, flat)


class ItkLike:
    """What isowave asks an image of SimpleITK for."""

    def __init__(self, array):
        self.array = array

    def GetSpacing(self):
        return (1.0, 2.0, 3.0)

    def GetOrigin(self):
        return (0.0, 0.0, 0.0)

    def GetDirection(self):
        return (1.0, 0, 0, 0, 1, 0, 0, 0, 1)

    def GetSize(self):
        return self.array.shape[::-1]


def GetArrayViewFromImage(image):  # SimpleITK has this function in the module of its images
    return image.array


def test_an_image_of_simpleitk_by_what_it_can_do(ball, plain):
    assert same(isowave.lod(ItkLike(np.ascontiguousarray(ball.transpose(2, 1, 0).astype(np.int16))), levels=(0, 1)), plain)


def test_of_a_fourth_dimension_one_volume_is_chosen(ball, plain):
    four = np.stack([np.zeros(ball.shape, bool), ball], axis=-1)
    assert same(isowave.lod(four, volume=2, spacing=(1, 2, 3), levels=(0, 1)), plain)
    with pytest.raises(isowave.InputError, match="holds 2 volumes .* --volume 1 to 2"):
        isowave.lod(four, spacing=(1, 2, 3))
    with pytest.raises(isowave.UsageError, match="no volume 3"):
        isowave.lod(four, volume=3)


@pytest.mark.parametrize(
    "arguments, words",
    [
        (dict(affine=np.eye(4), spacing=(1, 1, 1)), "affine and spacing exclude each other"),
        (dict(affine=np.eye(4), origin=(1, 1, 1)), "affine and origin exclude each other"),
        (dict(affine=np.eye(4), direction=np.eye(3)), "affine and direction exclude each other"),
        (dict(affine=np.eye(3)), "affine: has the shape"),
        (dict(affine=np.ones((4, 4))), "last row"),
        (dict(spacing=(1, 1)), "spacing: has the shape"),
        (dict(spacing=(1, 1, 0)), "not above 0"),
        (dict(spacing=(1, 1, np.nan)), "not finite"),
        (dict(axes="yxz"), "axes: 'yxz' is not one of xyz, zyx"),
        (dict(space="lpi"), "space: 'lpi' is not one of LPS, RAS"),
        (dict(voxels=32), "--voxels has no meaning for array, which is an image"),
        (dict(series="1"), "--series says how a file is read"),
        (dict(label=1, iso=0.5), "--label and --iso exclude each other"),
        (dict(iso="x"), "--iso: 'x' is not a number"),
        (dict(levels=(3, 1)), "levels"),
        (dict(levels=1, steps=2), "--levels and --steps"),
        (dict(hold="tight"), "--hold: 'tight' is not one of local, shift, none"),
        (dict(threads=0), "--threads"),
    ],
)
def test_arguments_that_contradict_each_other_are_refused(ball, arguments, words):
    with pytest.raises(isowave.UsageError, match=words.replace("(", r"\(")) as caught:
        isowave.lod(ball, **arguments)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "array, words",
    [
        (np.zeros((4, 4)), r"has 2 dimensions \(4 x 4\)"),
        (np.zeros((2, 2, 2, 2, 2)), "has 5 dimensions"),
        (np.zeros((0, 4, 4)), "size is 0 x 4 x 4"),
        (np.zeros((4, 4, 4)), "every voxel has the value 0"),
        (np.full((4, 4, 4), np.nan), r"voxel \(0, 0, 0\) is nan, the first of 64"),
        (np.zeros((4, 4, 4), complex), "type complex128"),
        (np.zeros((4, 4, 4), np.float16), "type float16"),
        (np.array([[["a"]]]), "type <U1"),
        (np.ma.masked_greater(np.arange(8.0).reshape(2, 2, 2), 3), "is masked"),
    ],
)
def test_what_is_no_volume_is_refused(array, words):
    with pytest.raises(isowave.InputError, match=words) as caught:
        isowave.lod(array, spacing=(1, 1, 1), iso=0.5 if array.dtype.kind == "f" and array.any() else None)
    assert str(caught.value).startswith("array: ") and "\n" not in str(caught.value)


def test_an_affine_that_cannot_be_inverted_is_refused(ball):
    with pytest.raises(isowave.InputError, match="cannot be inverted"):
        isowave.lod(ball, affine=np.array([[1, 1, 0, 0], [0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]))


def test_nan_is_taken_as_what_nan_says(ball):
    holes = np.where(ball, np.nan, 0.0)
    assert same(isowave.lod(holes, nan=1, iso=0.5, fit="mask", spacing=(1, 2, 3), levels=0),
                isowave.lod(ball, fit="mask", spacing=(1, 2, 3), levels=0))  # fmt: skip


def test_images_and_files_have_a_place_of_their_own(ball):
    with pytest.raises(isowave.UsageError, match="spacing says where an array lies; an image has a place of its own"):
        isowave.lod(ItkLike(ball), spacing=(1, 1, 1))
    with pytest.raises(isowave.UsageError, match="affine says where an array lies; .*cranium_crop.nrrd has a place"):
        isowave.lod(CRANIUM, affine=np.eye(4), iso=300)


def test_spacing_of_a_file_is_the_commands_option(tmp_path):
    ladder = isowave.lod(CRANIUM, iso=300, spacing=(1, 1, 2), levels=1)
    assert volumes(ladder) == [level["volume"] for level in
                               command_report(tmp_path, CRANIUM, "--iso", 300, "--spacing", "1x1x2", "--levels", 1)["levels"]]  # fmt: skip
    assert any("spacing" in remark for remark in ladder.remarks)


def test_errors_are_the_commands_one_line(tmp_path):
    broken = tmp_path / "broken.nrrd"
    broken.write_bytes(CRANIUM.read_bytes()[:2000])
    for source, options, error in [
        (broken, {"iso": 300}, isowave.InputError),
        (tmp_path / "none.nii", {}, isowave.InputError),
        (CRANIUM, {}, isowave.UsageError),
        (CRANIUM, {"iso": 1e9}, isowave.InputError),
        (CRANIUM, {"iso": 300, "voxels": 64}, isowave.UsageError),
    ]:
        words = [word for name, value in options.items() for word in (f"--{name}", value)]
        with pytest.raises(error) as caught:
            isowave.lod(source, **options)
        assert str(caught.value) == complaint("lod", source, "-o", tmp_path / "out", *words)


def test_an_assumed_spacing_is_said(ball):
    assert any("1 x 1 x 1 mm is assumed" in remark for remark in isowave.lod(ball, levels=0).remarks)


def test_an_ome_zarr_gives_what_its_array_gives_to_the_bit(cranium, tmp_path):
    zarr = pytest.importorskip("zarr")
    array, _ = cranium
    group = zarr.open_group(str(tmp_path / "scan.ome.zarr"), mode="w")
    group.create_dataset("0", data=array.transpose(2, 1, 0), chunks=(16, 40, 40), dimension_separator="/")
    axes = [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    steps = [{"type": "scale", "scale": [500, 250, 250]}, {"type": "translation", "translation": [1000, 0, -2000]}]
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": steps}]}]
    of_array = isowave.lod(array, spacing=(0.25, 0.25, 0.5), origin=(-2, 0, 1), iso=300, levels=(0, 2))
    for path in (tmp_path / "scan.ome.zarr", tmp_path / "scan.ome.zarr/0"):
        assert same(isowave.lod(path, iso=300, levels=(0, 2)), of_array)
    assert same([isowave.analyse(tmp_path / "scan.ome.zarr", iso=300).field(3).polygonize()],
                [isowave.analyse(array, spacing=(0.25, 0.25, 0.5), origin=(-2, 0, 1), iso=300).field(3).polygonize()])  # fmt: skip
    words = ("lod", tmp_path / "scan.ome.zarr", "-o", tmp_path / "out", "--channel", 1)
    with pytest.raises(isowave.UsageError) as caught:
        isowave.lod(tmp_path / "scan.ome.zarr", channel=1)
    assert str(caught.value) == complaint(*words)


def test_slabs_give_what_the_whole_does(cranium, tmp_path):
    array, _ = cranium
    options = dict(spacing=(0.25, 0.25, 0.5), iso=300)
    assert same(isowave.lod(array, slabs=3, levels=1, **options), isowave.lod(array, levels=1, **options))
    for slabs, name in ((None, "whole.vdb"), (3, "parts.vdb")):
        isowave.analyse(array, slabs=slabs, **options).save(tmp_path / name)
    assert (tmp_path / "whole.vdb").read_bytes() == (tmp_path / "parts.vdb").read_bytes()
    with pytest.raises(isowave.UsageError, match="--slabs"):
        isowave.lod(array, slabs=0, **options)


def test_a_pyramid_may_take_less_memory_than_levels(cranium):
    array, _ = cranium
    options = dict(spacing=(1, 1, 1), iso=300)
    needed = next(gigabytes for gigabytes in np.geomspace(1e-3, 1, 40) if not refused(isowave.analyse, array, gigabytes, options))
    assert refused(isowave.lod, array, needed, options)
    assert not refused(isowave.field, array, needed, options)


def refused(make, array, gigabytes, options):
    try:
        make(array, max_memory=gigabytes, **options)
    except isowave.InputError as error:
        assert "over the limit" in str(error)
        return True
    return False
