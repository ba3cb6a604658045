"""Results as HTML, for notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from .html import paragraph, table

if TYPE_CHECKING:
    from .answers import Parameter
    from .results import Result


def page(result: Result) -> str:
    """Write what a reader wants to know first."""
    from .results import Diagnosis

    parts = [paragraph(result.headline)]
    if isinstance(result, Diagnosis):
        parts.insert(0, paragraph(result.verdict.upper(), "h3"))
        parts += [
            paragraph(f"Measurement: {fault.sentence}. {fault.remedy}") for fault in result.faults
        ]
        for cause in result.causes:
            parts.append(paragraph(f"{cause.effect}, confidence {percent(cause.confidence)}", "h4"))
            parts.append(paragraph(cause.explanation))
            if cause.equivalents:
                parts.append(paragraph(f"Cannot be told from {', '.join(cause.equivalents)}."))
        if gain := result.gain:
            parts.append(
                paragraph(
                    f"On data held out the causes divide the error by {gain.ratio:.3g}, "
                    f"95 % from {gain.interval95[0]:.3g} to {gain.interval95[1]:.3g}."
                )
            )
        if following := result.next_experiment:
            parts.append(
                paragraph(
                    f"Measure next at magnitude {following.magnitude:.4g} and "
                    f"{following.omega_rad_s:.4g} rad/s: {following.reason}"
                )
            )
    parts.append(_parameters(result.model.parameters.values()))
    return "".join(parts)


def percent(confidence: float) -> str:
    """Write a probability without more digits than it deserves."""
    return "above 99.9 %" if confidence > 0.999 else f"{100 * confidence:.3g} %"


def _parameters(parameters: Iterable[Parameter]) -> str:
    rows = []
    for parameter in parameters:
        low, high = parameter.interval95 or (None, None)
        cells = [parameter.name, *map(_number, (parameter.value, low, high)), parameter.unit]
        rows.append([*cells, "" if parameter.identifiable else "not determined by this data"])
    return table(("parameter", "value", "95 % from", "to", "unit", ""), rows)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.5g}"
