"""What each model leaves, by frequency and magnitude."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LogNorm

from .parts import Canvas, comparison_of, has_many_lines, levels, with_unit

if TYPE_CHECKING:
    from ..comparison import Floats
    from ..results import Result

_TITLES = {"base": "Left by the base model", "extended": "Left with the causes"}


def draw(canvas: Canvas, result: Result) -> None:
    """Draw a map of the residuals of each model, in standard deviations."""
    comparison = comparison_of(result)
    level = levels(comparison.magnitude)
    magnitudes = [float(comparison.magnitude[level == i][0]) for i in range(int(level.max()) + 1)]
    # A single cosine has one place, its fundamental, for all its harmonics.
    at = comparison.frequency_hz if has_many_lines(comparison) else comparison.omega / (2 * np.pi)
    shown = (comparison.harmonic > 0) & (at > 0)
    sigmas = {name: comparison.sigmas(getattr(comparison, name)) for name in result.models}
    largest = max(float(np.nanmax(values[shown], initial=10.0)) for values in sigmas.values())
    norm = LogNorm(0.5, largest)
    axes = canvas.subplots(len(sigmas), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (name, values) in zip(axes, sigmas.items(), strict=True):
        for number in range(len(magnitudes)):
            rows = shown & (level == number) & np.isfinite(values)
            if not rows.any():
                continue
            frequency, size = _by_frequency(at[rows], values[rows])
            edges = (number - 0.5, number + 0.5)
            cells = np.maximum(size, 0.5)[None, :]
            mesh = panel.pcolormesh(_edges(frequency), edges, cells, norm=norm, cmap="magma_r")
        panel.set_title(_TITLES[name])
        every = max(1, len(magnitudes) // 8)
        panel.set_yticks(range(0, len(magnitudes), every))
        panel.set_yticklabels([f"{value:.4g}" for value in magnitudes[::every]])
        panel.set_ylabel(with_unit("magnitude", comparison.quantities.input_unit))
        panel.set_xscale("log")
    axes[-1].set_xlabel("frequency (Hz)")
    canvas.colorbar(mesh, ax=list(axes), label="standard deviations (noise: 1)")


def _by_frequency(frequency: Floats, sigmas: Floats) -> tuple[Floats, Floats]:
    """Root mean square of all residuals at each frequency."""
    places, index = np.unique(frequency, return_inverse=True)
    total = np.bincount(index, weights=sigmas**2)
    return places, np.sqrt(total / np.bincount(index))


def _edges(frequency: Floats) -> Floats:
    """Where the cell of each frequency begins and ends: half-way on a logarithmic axis."""
    if len(frequency) == 1:
        return np.asarray(frequency[0] * np.array([0.5, 2.0]) ** 0.5)
    middle = np.sqrt(frequency[1:] * frequency[:-1])
    first, last = frequency[0] ** 2 / middle[0], frequency[-1] ** 2 / middle[-1]
    return np.concatenate([[first], middle, [last]])
