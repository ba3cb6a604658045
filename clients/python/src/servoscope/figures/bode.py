"""Frequency response: measured, simulated, and the errors beneath."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.lines import Line2D

from .parts import NAMES, Canvas, colours, comparison_of, curves, levels, plain

if TYPE_CHECKING:
    from ..comparison import Complexes, Floats
    from ..results import Result

#: How each model is drawn: its curve, and its errors.
_CURVE: dict[str, dict[str, Any]] = {
    "base": {"linestyle": "--", "linewidth": 1.0},
    "extended": {"linestyle": "-", "linewidth": 1.2},
}
_ERROR: dict[str, dict[str, Any]] = {
    "base": {"linestyle": "--", "linewidth": 0.7, "marker": "x", "markersize": 4},
    "extended": {"linestyle": "-", "linewidth": 0.7, "marker": ".", "markersize": 5},
}
#: Most magnitudes that the legend names.
_MOST_NAMED = 8


def draw(canvas: Canvas, result: Result) -> None:
    """Draw gain and phase, and what the models leave of them."""
    comparison = comparison_of(result)
    gain, phase, gain_error, phase_error = canvas.subplots(
        4, 1, sharex=True, height_ratios=(3, 3, 2, 2)
    )
    level = levels(comparison.magnitude)
    colour = colours(int(level.max()) + 1)
    named: dict[int, float] = {}
    for rows in curves(comparison):
        number = int(level[rows[0]])
        named.setdefault(number, float(comparison.magnitude[rows[0]]))
        frequency = comparison.frequency_hz[rows]
        look = {"color": colour[number]}
        with np.errstate(divide="ignore", invalid="ignore"):
            measured = comparison.measured[rows] / comparison.input[rows]
        reference = np.zeros(len(rows))
        for model in result.models:
            ratio = getattr(comparison, model)[rows] / comparison.input[rows]
            reference = _phase(ratio)
            gain.plot(frequency, _decibels(ratio), **look, **_CURVE[model])
            phase.plot(frequency, reference, **look, **_CURVE[model])
            error = _ratio(measured, ratio)
            gain_error.plot(frequency, _decibels(error), **look, **_ERROR[model])
            phase_error.plot(frequency, np.degrees(np.angle(error)), **look, **_ERROR[model])
        gain.plot(frequency, _decibels(measured), "o", markersize=3, **look)
        phase.plot(frequency, _near(measured, reference), "o", markersize=3, **look)
    gain.set_ylabel("gain (dB)")
    phase.set_ylabel("phase (°)")
    gain_error.set_ylabel("measured over\nsimulated (dB)")
    phase_error.set_ylabel("measured less\nsimulated (°)")
    phase_error.set_xlabel("frequency (Hz)")
    phase_error.set_xscale("log")
    for axes in (gain, phase, gain_error, phase_error):
        axes.grid(alpha=0.3)
    for axes in (gain_error, phase_error):
        axes.axhline(0.0, color="black", linewidth=0.8)
    gain.set_title("Frequency response")
    gain.legend(handles=_looks(result), fontsize="small", loc="lower left")
    unit = comparison.quantities.input_unit
    magnitudes = [
        Line2D([], [], color=colour[number], label=plain(f"{value:.4g} {unit}".strip()))
        for number, value in sorted(named.items())
    ]
    if len(magnitudes) <= _MOST_NAMED:
        phase.legend(handles=magnitudes, title="magnitude", fontsize="small", loc="lower left")


def _looks(result: Result) -> list[Line2D]:
    measured = Line2D(
        [], [], color="grey", marker="o", markersize=3, linestyle="", label="measured"
    )
    models = [
        Line2D([], [], color="grey", label=NAMES[model], **_CURVE[model]) for model in result.models
    ]
    return [measured, *models]


def _decibels(ratio: Complexes) -> Floats:
    """Size in dB; NaN, which is not drawn, where nothing moves."""
    size = np.abs(ratio)
    return np.asarray(20 * np.log10(np.where(size > 0, size, np.nan)))


def _ratio(measured: Complexes, simulated: Complexes) -> Complexes:
    return np.asarray(measured / np.where(np.abs(simulated) > 0, simulated, np.nan))


def _phase(ratio: Complexes) -> Floats:
    """Phase in degrees without jumps of whole turns; where it is unknown, NaN."""
    phase = np.angle(ratio)
    known = np.isfinite(phase) & (np.abs(ratio) > 0)
    phase[known] = np.unwrap(phase[known])
    phase[~known] = np.nan
    return np.asarray(np.degrees(phase))


def _near(ratio: Complexes, reference: Floats) -> Floats:
    """Phase in degrees, within half a turn of a reference where there is one."""
    phase = np.degrees(np.angle(ratio))
    turns = np.round((phase - np.nan_to_num(reference)) / 360)
    return np.asarray(np.where(np.abs(ratio) > 0, phase - 360 * turns, np.nan))
