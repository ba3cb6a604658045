"""Results of jobs. What a class does not name is in its ``raw``."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

from . import answers, notebook
from .answers import Cause, Fault, Fit, Gain, NextExperiment, Parameter, Raw, TransferFunction
from .comparison import Comparison

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Verdict: TypeAlias = Literal["adequate", "explained", "improved", "unexplained"]
Plot: TypeAlias = Literal["overview", "bode", "residuals", "friction"]
Frame: TypeAlias = Literal["parameters", "causes", "candidates", "residuals", "comparison"]


@dataclass(frozen=True, kw_only=True)
class Result(ABC):
    """What identifications and diagnoses have in common.

    Attributes:
        comparison: Measured and simulated harmonics; None if the server gave none.
        raw: The whole answer of the server.
    """

    comparison: Comparison | None = field(repr=False, compare=False)
    raw: Raw = field(repr=False, compare=False)

    @property
    @abstractmethod
    def headline(self) -> str:
        """The result in one sentence."""

    @property
    @abstractmethod
    def models(self) -> dict[str, Identification]:
        """The models by name: ``base`` and, where causes are named, ``extended``."""

    @property
    def model(self) -> Identification:
        """The model to use: the one with the causes or, where none is named, the base model."""
        return list(self.models.values())[-1]

    def plot(self, kind: Plot = "overview") -> Figure:
        """Draw the result with matplotlib.

        Args:
            kind: ``"bode"``: measured, base model and model with the causes, and beneath the
                errors in dB and degrees. ``"residuals"``: what each model leaves, by frequency
                and magnitude. ``"friction"``: friction torque over velocity.
                ``"overview"``: all of them.

        Raises:
            ServoscopeError: The result has no data for this figure.
        """
        from .figures import draw

        return draw(self, kind)

    def frame(self, table: Frame = "parameters") -> pd.DataFrame:
        """Give a table of the result as a pandas frame.

        Args:
            table: ``"parameters"`` of every model; ``"causes"``; ``"candidates"``: every effect
                that was tried; ``"residuals"``: what the base model leaves, by magnitude,
                frequency (Hz), harmonic and run; ``"comparison"``: every harmonic as measured
                and as each model has it.

        Raises:
            ServoscopeError: The result has no such table.
        """
        from .frames import frame

        return frame(self, table)

    def _repr_html_(self) -> str:
        return notebook.page(self)


@dataclass(frozen=True, kw_only=True)
class Identification(Result):
    """A model, fitted to a measurement.

    Attributes:
        parameters: Estimates by name: ``pole``, ``constant``, ``dc_gain``, ``fc_plus``,
            ``fc_minus``, those of the actuator, and those of causes as ``effect.name``.
        transfer_function: The linear block.
        fit: How well it explains the data.
        noise: Where the weights come from: ``"given"``, ``"repeats"``, ``"periods"`` or
            ``"estimated"``.
        limitations: What these data cannot determine, in sentences.
    """

    parameters: dict[str, Parameter]
    transfer_function: TransferFunction
    fit: Fit
    noise: str
    limitations: list[str]

    @classmethod
    def of(cls, raw: Raw, comparison: Comparison | None) -> Identification:
        """Read the server's answer."""
        return cls(
            parameters=answers.parameters(raw["parameters"]),
            transfer_function=TransferFunction.of(raw["transfer_function"]),
            fit=Fit.of(raw["fit"]),
            noise=raw["noise"],
            limitations=raw["limitations"],
            comparison=comparison,
            raw=raw,
        )

    @property
    def headline(self) -> str:
        """The result in one sentence: the server's own, where it gave one."""
        if headline := self.raw.get("headline"):
            return str(headline)
        rest = {True: "which is noise", False: "more than noise", None: "the noise is unknown"}
        return f"the model leaves {self.fit.nrmse:.3%} of the response, {rest[self.fit.adequate]}"

    @property
    def models(self) -> dict[str, Identification]:
        """This model alone."""
        return {"base": self}


@dataclass(frozen=True, kw_only=True)
class Diagnosis(Result):
    """Where the base model is wrong, and why.

    Attributes:
        verdict: ``"adequate"``: the measurement shows no error in the base model.
            ``"explained"``: with the causes only noise is left. ``"improved"``: the causes help,
            and something remains. ``"unexplained"``: the base model is wrong, and no effect of
            the library improves it by more than chance.
        causes: Effects that the base model lacks, strongest first.
        gain: Improvement by all causes together; None where none is named.
        base: The base model.
        extended: The model with the causes; None where none is named.
        faults: Faults of the measurement. All else is of the measurement without them.
        next_experiment: What to measure next; None if nothing is in doubt.
        limitations: What this diagnosis cannot determine, in sentences.
    """

    verdict: Verdict
    causes: list[Cause]
    gain: Gain | None
    base: Identification
    extended: Identification | None
    faults: list[Fault]
    next_experiment: NextExperiment | None
    limitations: list[str]

    @classmethod
    def of(cls, raw: Raw, comparison: Comparison | None) -> Diagnosis:
        """Read the server's answer."""
        extended, following = raw.get("extended"), raw.get("next_experiment")
        return cls(
            verdict=raw["verdict"],
            causes=[Cause.of(cause) for cause in raw["causes"]],
            gain=Gain.of(raw["gain"]) if raw.get("gain") else None,
            base=Identification.of(raw["base"], comparison),
            extended=Identification.of(extended, comparison) if extended else None,
            faults=[Fault.of(fault) for fault in raw.get("measurement", [])],
            next_experiment=NextExperiment.of(following) if following else None,
            limitations=raw["limitations"],
            comparison=comparison,
            raw=raw,
        )

    @property
    def headline(self) -> str:
        """The verdict in one sentence; of an older server, its word and the causes."""
        if headline := self.raw.get("headline"):
            return str(headline)
        named = ", ".join(cause.effect for cause in self.causes)
        return f"{self.verdict.upper()}: {named}" if named else self.verdict.upper()

    @property
    def models(self) -> dict[str, Identification]:
        """The models by name: ``base`` and, where causes are named, ``extended``."""
        return {"base": self.base} | ({"extended": self.extended} if self.extended else {})


def read_result(raw: Raw, comparison: Comparison | None) -> Identification | Diagnosis:
    """Read the server's answer, of either kind."""
    kind = Diagnosis if "verdict" in raw else Identification
    return kind.of(raw, comparison)
