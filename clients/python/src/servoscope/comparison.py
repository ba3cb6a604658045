"""Measured and simulated harmonics, side by side."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: What units of the input begin with where it is a force or a torque, and units of the response
#: where the axis is linear or turns: as the server tells them apart.
_FORCES = frozenset(["N", "mN", "kN", "MN", "lbf", "kgf", "dyn"])
_TORQUES = frozenset(["Nm", "mNm", "kNm", "cNm", "ozin", "lbin", "lbft", "kgfcm"])
_LENGTHS = frozenset(["m", "mm", "cm", "dm", "um", "µm", "μm", "nm", "in", "inch", "ft"])
_ANGLES = frozenset(
    [
        "rad",
        "mrad",
        "urad",
        "µrad",
        "deg",
        "°",
        "rev",
        "r",
        "turn",
        "turns",
        "rpm",
        "arcsec",
        "arcmin",
    ]
)

#: Share of the power of an input that its excited lines carry.
_EXCITED_POWER = 0.99


@dataclass(frozen=True)
class Quantities:
    """What input and response are.

    Attributes:
        input_unit: Unit of the input; empty if the measurement does not say.
        response_kind: ``"velocity"``, ``"position"`` or ``"acceleration"``.
        response_unit: Unit of the response; empty if the measurement does not say.
    """

    input_unit: str = ""
    response_kind: str = "velocity"
    response_unit: str = ""

    @classmethod
    def of(cls, measurement: dict[str, Any]) -> Quantities:
        """Read the server's answer; one that was stored by an older server says nothing."""
        source, response = measurement.get("input") or {}, measurement.get("response") or {}
        kind = measurement.get("response_kind") or "velocity"
        return cls(source.get("unit", ""), kind, response.get("unit", ""))

    @property
    def velocity_unit(self) -> str:
        """Unit of the velocity that belongs to the response; empty if it is unknown."""
        if not self.response_unit:
            return ""
        suffix = {"position": "/s", "acceleration": "·s"}.get(self.response_kind, "")
        compound = suffix and re.search(r"[/ ·*]", self.response_unit)
        return f"({self.response_unit}){suffix}" if compound else self.response_unit + suffix

    @property
    def effort(self) -> str:
        """What moves the axis, by its units: force, torque or, where none says it, either."""
        source, response = _factors(self.input_unit), _factors(self.response_unit)[:1]
        if source[:1] and source[0] in _FORCES:
            if len(source) == 1:
                return "force"
            if len(source) == 2 and source[1] in _LENGTHS:
                return "torque"
        if len(source) == 1 and source[0] in _TORQUES:
            return "torque"
        if response and response[0] in _ANGLES:
            return "torque"
        return "force" if response and response[0] in _LENGTHS else "force or torque"


def _factors(unit: str) -> list[str]:
    """Give the factors of the numerator of a unit: ``N·m/rad`` has N and m."""
    numerator = re.split(r"[/)]", unit.lstrip("("), maxsplit=1)[0]
    return [part for part in re.split(r"[ ·*.⋅]", numerator) if part]


@dataclass(frozen=True, eq=False)
class Comparison:
    """Every harmonic as it was measured and as each model has it; one row each.

    Peak amplitudes: a signal is the real part of the sum of amplitude·exp(j·harmonic·omega·t).

    Attributes:
        quantities: What input and response are.
        experiment: Index of the experiment, from 0.
        magnitude: Half the peak-to-peak value of the input, in its unit.
        omega: Fundamental of the experiment, rad/s.
        harmonic: Harmonic; 0 is the mean.
        input: Amplitude of the input.
        measured: Amplitude of the response.
        std: Standard deviation of its real and of its imaginary part.
        std_estimated: Whether `std` is estimated from the residual; otherwise the measurement
            states it or has repeats.
        base: Amplitude by the base model.
        extended: Amplitude by the model with the causes; NaN where there is none.
    """

    quantities: Quantities
    experiment: NDArray[np.int64]
    magnitude: Floats
    omega: Floats
    harmonic: NDArray[np.int64]
    input: Complexes
    measured: Complexes
    std: Floats
    std_estimated: bool
    base: Complexes
    extended: Complexes

    @classmethod
    def of(cls, text: str, quantities: Quantities) -> Comparison:
        """Read the server's table; units in the names of its columns are left aside."""
        names, *rows = csv.reader(io.StringIO(text))
        short = [name.split(" [")[0] for name in names]
        values = np.array([[float(cell or "nan") for cell in row] for row in rows])
        column = dict(zip(short, values.reshape(-1, len(short)).T, strict=True))

        def amplitude(name: str) -> Complexes:
            return np.asarray(column[f"{name}_re"] + 1j * column[f"{name}_im"])

        return cls(
            quantities=quantities,
            experiment=column["experiment"].astype(np.int64),
            magnitude=column["magnitude"],
            omega=column["omega"],
            harmonic=column["harmonic"].astype(np.int64),
            input=amplitude("u"),
            measured=amplitude("measured"),
            std=column["std"],
            std_estimated=bool(column["std_estimated"].any()),
            base=amplitude("base"),
            extended=amplitude("extended"),
        )

    @property
    def frequency_hz(self) -> Floats:
        """Frequency of each row, Hz."""
        return np.asarray(self.harmonic * self.omega / (2 * np.pi))

    def experiments(self) -> Iterator[NDArray[np.int64]]:
        """Give the rows of each experiment."""
        for index in np.unique(self.experiment):
            yield np.flatnonzero(self.experiment == index)

    def excited(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Those rows of an experiment at which its input excites the axis."""
        lines = rows[(self.harmonic[rows] > 0) & (np.abs(self.input[rows]) > 0)]
        power = np.abs(self.input[lines]) ** 2
        order = np.argsort(-power)
        before = np.cumsum(power[order]) - power[order]
        return np.sort(lines[order[before < _EXCITED_POWER * power.sum()]])

    def sigmas(self, model: Complexes) -> Floats:
        """Size of each residual of a model in standard deviations; noise alone gives about 1."""
        residual = np.abs(self.measured - model) / np.where(self.harmonic > 0, np.sqrt(2.0), 1.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.where(self.std > 0, residual / self.std, np.nan))

    def fastest(self) -> float:
        """Give the largest speed that was measured, in units of the velocity."""
        return max((self._fastest(rows) for rows in self.experiments()), default=0.0)

    def _fastest(self, rows: NDArray[np.int64]) -> float:
        order, omega = self.harmonic[rows], self.omega[rows][0]
        power = {"position": 1, "acceleration": -1}.get(self.quantities.response_kind, 0)
        used = order > 0 if power else order >= 0
        derivative = (1j * order[used] * omega) ** power if power else 1.0
        samples = 8 * max(8, int(order.max()))
        spectrum = np.zeros(samples // 2 + 1, dtype=complex)
        spectrum[order[used]] = self.measured[rows][used] * derivative * samples / 2
        spectrum[0] *= 2
        return float(np.abs(np.fft.irfft(spectrum, samples)).max())
