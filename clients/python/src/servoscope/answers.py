"""Parts of results as dataclasses. What a class does not name is in its ``raw``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

Interval: TypeAlias = tuple[float, float]
Raw: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Parameter:
    """An estimated parameter.

    Attributes:
        name: Its name.
        value: Best estimate, in ``unit``; None if the data say nothing about it.
        std: Standard deviation; None if the data do not determine it.
        interval95: 95 % interval; None if the data do not determine it.
        unit: Its unit.
        identifiable: Whether the data determine it.
        at_bound: Whether the value lies at a bound of what is physically possible.
    """

    name: str
    value: float | None
    std: float | None
    interval95: Interval | None
    unit: str
    identifiable: bool
    at_bound: bool
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, name: str, raw: Raw) -> Parameter:
        """Read the server's answer."""
        return cls(
            name=name,
            value=raw.get("value"),
            std=raw.get("std"),
            interval95=_interval(raw.get("interval95")),
            unit=raw["unit"],
            identifiable=raw["identifiable"],
            at_bound=raw["at_bound"],
            raw=raw,
        )


@dataclass(frozen=True)
class Gain:
    """By how much the causes improve the prediction of data that no fit has seen.

    Attributes:
        nrmse_before: Error of the base model, as a share of the response.
        nrmse_after: Error of the model with the causes.
        ratio: The one divided by the other.
        interval95: 95 % interval of the ratio.
        heldout: What was held out, in words.
    """

    nrmse_before: float
    nrmse_after: float
    ratio: float
    interval95: Interval
    heldout: str
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: Raw) -> Gain:
        """Read the server's answer."""
        low, high = raw["interval95"]
        return cls(
            nrmse_before=raw["heldout_nrmse_before"],
            nrmse_after=raw["heldout_nrmse_after"],
            ratio=raw["ratio"],
            interval95=(low, high),
            heldout=raw["heldout"],
            raw=raw,
        )


@dataclass(frozen=True)
class Fit:
    """How well a model explains the data.

    Attributes:
        nrmse: What is left, as a share of the response.
        chi2_per_dof: χ² per degree of freedom; about 1 if only noise is left, None if the
            noise is unknown.
        dof: Degrees of freedom.
        adequate: Whether no more than noise is left; None if the noise is unknown.
    """

    nrmse: float
    chi2_per_dof: float | None
    dof: int
    adequate: bool | None
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: Raw) -> Fit:
        """Read the server's answer."""
        return cls(
            nrmse=raw["nrmse"],
            chi2_per_dof=raw.get("chi2_per_dof"),
            dof=raw["dof"],
            adequate=raw.get("adequate"),
            raw=raw,
        )


@dataclass(frozen=True)
class TransferFunction:
    """The linear block from the input to the velocity.

    Attributes:
        numerator: Coefficients, highest power of s first.
        denominator: The same; the leading one is 1.
        poles: Poles, rad/s.
        dc_gain: Gain at rest, response units per input unit.
    """

    numerator: list[float]
    denominator: list[float]
    poles: list[complex]
    dc_gain: float
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: Raw) -> TransferFunction:
        """Read the server's answer."""
        return cls(
            numerator=raw["numerator"],
            denominator=raw["denominator"],
            poles=[complex(*pole) for pole in raw["poles"]],
            dc_gain=raw["dc_gain"],
            raw=raw,
        )


@dataclass(frozen=True)
class Cause:
    """An effect that the base model lacks.

    Attributes:
        effect: Its id.
        confidence: Probability that it is really present, 0 to 1.
        parameters: Its parameters by name.
        explanation: What it means for the machine.
        equivalents: Ids of effects that these data cannot tell from it.
        gain: Improvement by this cause alone; None if that cannot be measured.
    """

    effect: str
    confidence: float
    parameters: dict[str, Parameter]
    explanation: str
    equivalents: list[str]
    gain: Gain | None
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: Raw) -> Cause:
        """Read the server's answer."""
        return cls(
            effect=raw["effect"],
            confidence=raw["confidence"],
            parameters=parameters(raw["parameters"]),
            explanation=raw["explanation"],
            equivalents=raw["equivalents"],
            gain=Gain.of(raw["gain"]) if raw.get("gain") else None,
            raw=raw,
        )


@dataclass(frozen=True)
class Fault:
    """A fault of the measurement. The answer is for the measurement with it corrected.

    Attributes:
        fault: Its kind.
        sentence: Where it is, and how large.
        remedy: How to correct it.
    """

    fault: str
    sentence: str
    remedy: str
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: Raw) -> Fault:
        """Read the server's answer."""
        return cls(raw["fault"], raw["sentence"], raw["remedy"], raw)


@dataclass(frozen=True)
class NextExperiment:
    """The experiment that would best tell apart the causes still in doubt.

    Attributes:
        magnitude: Peak amplitude of the input, in its unit.
        omega_rad_s: Frequency, rad/s.
        reason: Why this one.
    """

    magnitude: float
    omega_rad_s: float
    reason: str
    raw: Raw = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: Raw) -> NextExperiment:
        """Read the server's answer."""
        return cls(raw["magnitude"], raw["omega_rad_s"], raw["reason"], raw)


def parameters(raw: Raw) -> dict[str, Parameter]:
    """Read parameters by name."""
    return {name: Parameter.of(name, value) for name, value in raw.items()}


def _interval(ends: Sequence[float] | None) -> Interval | None:
    return None if ends is None else (ends[0], ends[1])
