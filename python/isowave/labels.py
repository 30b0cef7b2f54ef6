"""Label images of which every label is a solid of its own."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np

from . import _native
from ._meshes import PathLike, is_path
from ._options import given
from ._volumes import Geometry, voxels_of
from ._watch import ProgressLike, Watch
from .errors import InputError, UsageError
from .solids import Ladder, lod

__all__ = ["LabelLadders", "each_label"]

_MOST_LABELS = 256  # values of an image that is one of labels, as the command has it
_BUDGETS = ("triangles", "ratio", "tolerance", "min_component")
_FILES = ("volume", "size", "type", "endian", "header_bytes", "series", "stack", "channel", "time", "resample_slices", "grid")
_PLACES = ("affine", "spacing", "origin", "direction", "axes", "space")
_Label = tuple[float, str, list[int]]


class LabelLadders(Mapping[float, Ladder]):
    """Label -> its ladder, in the order of the labels. ``names`` and ``colours``: label -> "the ring", "#E69F00"."""

    def __init__(self, labels: Sequence[_Label], ladders: Sequence[Ladder], inputs: list[str]) -> None:
        self._labels = list(labels)
        self._ladders = {label: ladder for (label, _, _), ladder in zip(labels, ladders)}
        self._inputs = inputs
        self.names = {label: name for label, name, _ in labels}
        self.colours = {label: "#" + "".join(f"{part:02X}" for part in colour) for label, _, colour in labels}
        #: Of all ladders, each behind the label's name.
        self.remarks = [f"{self.names[label]}: {remark}" for label, ladder in self._ladders.items() for remark in ladder.remarks]

    def __getitem__(self, label: float) -> Ladder:
        return self._ladders[label]

    def __iter__(self) -> Iterator[float]:
        return iter(self._ladders)

    def __len__(self) -> int:
        return len(self._ladders)

    def save(
        self, folder: PathLike, *, space: Optional[str] = None, threads: Optional[int] = None, progress: Optional[ProgressLike] = None
    ) -> list[str]:
        """What ``isowave lod --each-label --format 3mf -o folder`` writes: a 3MF a level with an object a label, and report.json.

        space: "lps" or "ras", the axes of the written coordinates. Returns the files' paths. All appear at once, or none does.
        Raises UsageError for a file that is the input, OperationError where writing fails.
        """
        ladders = [ladder._native for ladder in self._ladders.values()]
        watch = Watch(progress, threads)
        paths = _native.save_labels(self._labels, ladders, os.fspath(folder), (space or "").lower(), self._inputs, self.remarks, watch)
        return [os.fspath(path) for path in paths]

    def __repr__(self) -> str:
        return f"<isowave.LabelLadders: {', '.join(self.names.values())}>"


def _labels_in(source: Any, options: dict[str, Any]) -> list[float]:
    """All values of voxels in memory but 0."""
    array = voxels_of(source, Geometry(*(options.get(name) for name in _PLACES)), options.get("volume")).array
    values = np.unique(array)
    if len(values) > _MOST_LABELS or values[0] < 0 or (values != np.round(values)).any():
        raise InputError(
            f"the array is no label image, with at most {_MOST_LABELS} values, all of them whole and none below 0; "
            f"values run from {values[0]} to {values[-1]}"
        )
    labels = [float(value) for value in values if value != 0]
    if not labels:
        raise InputError("the array: all of its voxels are 0; there is no label")
    return labels


def each_label(
    source: Any,
    *,
    label: Union[None, float, Sequence[float]] = None,
    names: Optional[Mapping[float, str]] = None,
    progress: Optional[ProgressLike] = None,
    **options: Any,
) -> LabelLadders:
    """Every label of a label image as a solid of its own, as ``isowave lod --each-label`` makes it.

    source: a path, an array or an image, as lod() takes it. label: those that are wanted; without it all but 0.
    names: label -> what its objects are called. Without one, what the file calls it (.seg.nrrd, DICOM segmentations), else "label 3".
    options: those of lod(), but for budgets.

    Labels are fitted one by one, and their surfaces where they meet are not one.

    Raises InputError: no label image; UsageError: a budget; else as lod() does.

    >>> x, y, z = np.indices((24, 20, 20))
    >>> balls = 1 * (abs(x - 6) + abs(y - 10) + abs(z - 10) < 5) + 2 * (abs(x - 17) + abs(y - 10) + abs(z - 10) < 5)
    >>> made = each_label(balls, spacing=(1, 1, 1), names={2: "the second"}, levels=0)
    >>> list(made), made.names[2.0], made[1][0].report["parts"]
    ([1.0, 2.0], 'the second', 1)
    """
    if any(options.get(name) is not None for name in _BUDGETS):
        raise UsageError("--each-label and budgets exclude each other; give one of them")
    wanted = None if label is None else [float(number) for number in np.atleast_1d(np.asarray(label, dtype=float))]
    if is_path(source):
        reading = {name: options.get(name) for name in _FILES}
        labels = _native.labels_of(os.fspath(source), given(label=wanted, **reading), Watch(progress, options.get("threads")))
    else:
        numbers = _labels_in(source, options) if wanted is None else wanted
        labels = [(number, f"label {number:g}", _native.label_colour(i)) for i, number in enumerate(numbers)]
    labels = [(number, (names or {}).get(number, name), colour) for number, name, colour in labels]
    ladders = [lod(source, label=number, progress=progress, **options) for number, _, _ in labels]
    return LabelLadders(labels, ladders, [os.fspath(source)] if is_path(source) else [])
