"""Results as pandas frames."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pandas as pd

from .answers import Interval, Parameter
from .errors import ServoscopeError
from .results import Diagnosis, Frame, Result

if TYPE_CHECKING:
    from .comparison import Comparison

Row = dict[str, Any]


def frame(result: Result, table: Frame) -> pd.DataFrame:
    """Give a table of a result."""
    if table == "parameters":
        return pd.DataFrame(list(_parameters(result)))
    if table == "comparison":
        if result.comparison is None:
            raise ServoscopeError("the server gave no comparison for this result")
        return _comparison(result.comparison)
    if not isinstance(result, Diagnosis):
        raise ServoscopeError(f"an identification has no table `{table}`")
    if table == "causes":
        return pd.DataFrame(list(_causes(result)))
    if table == "candidates":
        return pd.DataFrame(result.raw["candidates"])
    if table == "residuals":
        return pd.DataFrame(list(_residuals(result)))
    raise ServoscopeError(f"there is no table `{table}`")


def _parameters(result: Result) -> Iterator[Row]:
    for model, identification in result.models.items():
        for parameter in identification.parameters.values():
            yield {"model": model, **_estimate(parameter)}


def _causes(result: Diagnosis) -> Iterator[Row]:
    for cause in result.causes:
        gain = cause.gain
        for parameter in cause.parameters.values():
            yield {
                "effect": cause.effect,
                "confidence": cause.confidence,
                "ratio": gain.ratio if gain else None,
                "parameter": parameter.name,
                **_estimate(parameter),
                "equivalents": " ".join(cause.equivalents),
            }


def _residuals(result: Diagnosis) -> Iterator[Row]:
    for by in ("magnitude", "frequency", "harmonic", "run"):
        for group in result.raw["discrepancy"][f"by_{by}"]:
            yield {"by": by, **group}


def _estimate(parameter: Parameter) -> Row:
    low, high = _ends(parameter.interval95)
    return {
        "parameter": parameter.name,
        "value": parameter.value,
        "std": parameter.std,
        "low95": low,
        "high95": high,
        "unit": parameter.unit,
        "identifiable": parameter.identifiable,
    }


def _ends(interval: Interval | None) -> tuple[float | None, float | None]:
    return interval or (None, None)


def _comparison(comparison: Comparison) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "experiment": comparison.experiment,
            "magnitude": comparison.magnitude,
            "frequency_hz": comparison.frequency_hz,
            "harmonic": comparison.harmonic,
            "input": comparison.input,
            "measured": comparison.measured,
            "std": comparison.std,
            "base": comparison.base,
            "extended": comparison.extended,
        }
    )
