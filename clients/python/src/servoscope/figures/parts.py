"""What the figures share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from ..errors import ServoscopeError

if TYPE_CHECKING:
    from ..comparison import Comparison, Floats
    from ..results import Result

Canvas = Figure | SubFigure

#: Names of the models for a reader.
NAMES = {"base": "base model", "extended": "with causes"}
#: Excited lines above which an input is one of many lines.
_FEW_LINES = 3
#: Relative difference of magnitudes that are meant to be the same, where they were measured.
_SAME = 0.05


def comparison_of(result: Result) -> Comparison:
    """Give the measured and simulated harmonics of a result."""
    if result.comparison is None:
        raise ServoscopeError("the server gave no comparison for this result")
    return result.comparison


def curves(comparison: Comparison) -> list[NDArray[np.int64]]:
    """Give the excited rows that belong together, by rising frequency.

    Single cosines of one magnitude form a curve, and so does each input of many lines.
    """
    excited = [comparison.excited(rows) for rows in comparison.experiments()]
    excited = [rows for rows in excited if len(rows)]
    if any(len(rows) > _FEW_LINES for rows in excited):
        return excited
    size = np.abs(comparison.input)
    strongest = np.array([rows[np.argmax(size[rows])] for rows in excited], dtype=np.int64)
    level = levels(comparison.magnitude)[strongest]
    by_frequency = strongest[np.argsort(comparison.frequency_hz[strongest])]
    order = levels(comparison.magnitude)[by_frequency]
    return [by_frequency[order == index] for index in np.unique(level)]


def has_many_lines(comparison: Comparison) -> bool:
    """Whether some input has many lines."""
    return any(len(comparison.excited(rows)) > _FEW_LINES for rows in comparison.experiments())


def levels(magnitude: Floats) -> NDArray[np.int64]:
    """Number the magnitudes, the smallest first; those that are meant to be the same share one."""
    numbers = np.empty(len(magnitude), dtype=np.int64)
    number, first = -1, -np.inf
    for row in np.argsort(magnitude):
        if number < 0 or magnitude[row] > first * (1 + _SAME):
            number, first = number + 1, magnitude[row]
        numbers[row] = number
    return numbers


def colours(count: int) -> list[tuple[float, float, float, float]]:
    """Give a colour for each magnitude, the smallest first."""
    return [mpl.colormaps["viridis"](place) for place in np.linspace(0.0, 0.8, max(count, 1))]


def with_unit(name: str, unit: str) -> str:
    """Name an axis. Text from files must not be read as a formula."""
    return plain(f"{name} ({unit})" if unit else name)


def plain(text: str) -> str:
    """Write a text so that matplotlib takes no part of it for a formula."""
    return text.replace("$", r"\$")
