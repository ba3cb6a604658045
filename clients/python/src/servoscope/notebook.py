"""Results as HTML, for notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from .html import paragraph, table

if TYPE_CHECKING:
    from .answers import Gain, Parameter
    from .results import Result


def page(result: Result) -> str:
    """Write what a reader wants to know first."""
    from .results import Diagnosis

    parts = [paragraph(result.headline, "h3")]
    if isinstance(result, Diagnosis):
        parts.append(paragraph(_sentence(result.raw["discrepancy"]["sentence"])))
        parts += [
            paragraph(f"Measurement: {fault.sentence}. {fault.remedy}") for fault in result.faults
        ]
        for cause in result.causes:
            parts.append(paragraph(f"{cause.effect}, confidence {percent(cause.confidence)}", "h4"))
            parts.append(paragraph(cause.explanation))
            if cause.equivalents:
                parts.append(paragraph(f"Cannot be told from {', '.join(cause.equivalents)}."))
        if gain := result.gain:
            parts.append(paragraph(f"Improvement on held-out data: {change(gain)}."))
        if following := result.next_experiment:
            parts.append(paragraph(_sentence(following.reason)))
    parts.append(_parameters(result.model.parameters.values()))
    return "".join(parts)


def change(gain: Gain) -> str:
    """Write by what the causes divide or multiply the residual, with its 95 % interval."""
    is_smaller = gain.ratio >= 1
    ratio, *interval = (
        value if is_smaller else 1 / value for value in (gain.ratio, *gain.interval95)
    )
    low, high = sorted(interval)
    sign = "÷" if is_smaller else "×"
    return f"residual {sign} {ratio:.3g} (95 % interval {low:.3g} to {high:.3g})"


def percent(confidence: float) -> str:
    """Write a probability without more digits than it deserves."""
    return "above 99.9 %" if confidence > 0.999 else f"{100 * confidence:.3g} %"


def _parameters(parameters: Iterable[Parameter]) -> str:
    rows = []
    for parameter in parameters:
        low, high = parameter.interval95 or (None, None)
        cells = [parameter.name, *map(_number, (parameter.value, low, high)), parameter.unit]
        rows.append([*cells, "" if parameter.identifiable else "not determined by these data"])
    return table(("parameter", "value", "95 % from", "to", "unit", ""), rows)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.5g}"
