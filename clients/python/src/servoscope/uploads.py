"""Measurements on their way to the server: files, frames and arrays."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class TimeRecord:
    """A record over time.

    Attributes:
        time_s: Time of each sample, seconds, evenly spaced.
        input: Input of the axis at these times, in the unit that the upload states.
        output: Response at these times, in the unit that the upload states.
        segment: Number of the segment that each sample belongs to. Each segment is an
            experiment with a period of its own. None: the record is one experiment.
    """

    time_s: ArrayLike
    input: ArrayLike
    output: ArrayLike
    segment: ArrayLike | None = None

    def columns(self) -> dict[str, ArrayLike]:
        """Give the record as columns of a table."""
        return {
            entry.name: value
            for entry in fields(self)
            if (value := getattr(self, entry.name)) is not None
        }


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """A measured frequency response, as an analyser gives it.

    Attributes:
        frequency_hz: Frequency of each point, Hz.
        ratio: Response over input at each point, complex.
        magnitude: Peak amplitude of the input, in its unit: one for all points, or one each.
        std: Standard deviation of the real and of the imaginary part of the response, in its
            unit (not of the ratio); None: unknown.
    """

    frequency_hz: ArrayLike
    ratio: ArrayLike
    magnitude: ArrayLike
    std: ArrayLike | None = None

    def columns(self) -> dict[str, ArrayLike]:
        """Give the points as columns of a table of fundamentals."""
        ratio = np.asarray(self.ratio, dtype=complex)
        magnitude = np.broadcast_to(np.asarray(self.magnitude, dtype=float), ratio.shape)
        response = ratio * magnitude
        table: dict[str, ArrayLike] = {
            "magnitude": magnitude,
            "frequency_hz": self.frequency_hz,
            "re": response.real,
            "im": response.imag,
        }
        if self.std is not None:
            table["std"] = np.broadcast_to(np.asarray(self.std, dtype=float), ratio.shape)
        return table


PathLike: TypeAlias = "str | os.PathLike[str]"
#: What can be uploaded.
Source: TypeAlias = (
    "PathLike | Sequence[PathLike] | pd.DataFrame | Mapping[str, ArrayLike]"
    " | TimeRecord | FrequencyResponse"
)


class UploadSettings(TypedDict, total=False):
    """What can be said beside the data. It holds before what a file says.

    name: name of the measurement. input: name and unit of the input, ``"current A"``.
    response: kind and unit of the response, ``"velocity rad/s"``, ``"position mm"``,
    ``"acceleration m/s²"``. magnitude: peak amplitude of the input, in its unit, for a table
    without it. period_s: period of a time record, seconds, or ``"none"``. settle_periods:
    periods to drop at the beginning. loop: ``"open"`` or ``"closed"``. amplitude:
    ``"peak"``, ``"rms"`` or ``"peak-to-peak"``. reference: ``"cos"`` or ``"sin"``.
    averages: averages behind each coherence. sample_s: seconds between samples, for a record
    without times. decimal: ``"comma"`` or ``"point"``. column_names: names of the columns
    between semicolons. sheet: sheet of a workbook. inverted: whether the response has the
    opposite sign. mapping: name of a stored mapping, which fills in what is not said. machine,
    axis, operator, measured_at, labels: by which lists are filtered.
    """

    name: str
    input: str
    response: str
    magnitude: float
    period_s: float | str
    settle_periods: int
    loop: str
    amplitude: str
    reference: str
    averages: float
    sample_s: float
    decimal: str
    column_names: str
    sheet: str
    inverted: bool
    mapping: str
    machine: str
    axis: str
    operator: str
    measured_at: str | datetime
    labels: Mapping[str, str]


Part: TypeAlias = tuple[str, tuple[str | None, bytes]]


def form(source: Source, settings: UploadSettings) -> list[Part]:
    """Encode an upload as the parts of a form.

    Raises:
        TypeError: The source or a setting is nothing that can be uploaded.
        ValueError: Columns of different lengths, or a time without a time zone.
        OSError: A file cannot be read.
    """
    parts: list[Part] = [("file", file) for file in _files(source)]
    for name, value in settings.items():
        if name not in UploadSettings.__annotations__:
            raise TypeError(f"upload has no setting `{name}`")
        if name == "labels":
            labels = settings["labels"]
            parts += [(f"label.{key}", (None, text.encode())) for key, text in labels.items()]
        elif value is not None:
            parts.append((name, (None, _text(value).encode())))
    return parts


def _files(source: Source) -> list[tuple[str, bytes]]:
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        return [(path.name, path.read_bytes())]
    if isinstance(source, TimeRecord | FrequencyResponse):
        return [("arrays.csv", _table(source.columns()))]
    if isinstance(source, Mapping):
        return [("arrays.csv", _table(source))]
    if isinstance(source, Sequence):
        return [file for path in source for file in _files(path)]
    if hasattr(source, "columns"):
        columns = {str(name): source[name].to_numpy(na_value=np.nan) for name in source.columns}
        return [("frame.csv", _table(columns))]
    raise TypeError("upload takes a path, paths, a DataFrame, columns by name, or a record")


def _table(columns: Mapping[str, ArrayLike]) -> bytes:
    """Write columns as CSV; numbers keep every digit, and a missing one is an empty cell."""
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    for name, array in arrays.items():
        if array.ndim != 1:
            raise ValueError(f"column `{name}` has {array.ndim} dimensions, not 1")
        if np.iscomplexobj(array):
            raise ValueError(f"column `{name}` is complex: give real and imaginary part")
    if len(lengths := {len(array) for array in arrays.values()}) > 1:
        raise ValueError(f"the columns have different lengths: {sorted(lengths)}")
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(arrays)
    writer.writerows(zip(*(_cells(array) for array in arrays.values()), strict=True))
    return text.getvalue().encode()


def _cells(array: np.ndarray) -> list[object]:
    return ["" if value is None or value != value else value for value in array.tolist()]


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, datetime):
        if value.tzinfo is None:
            raise ValueError("measured_at needs a time zone")
        return value.isoformat()
    return str(value)
