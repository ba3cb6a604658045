"""A measurement as the server keeps it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .comparison import Quantities
from .html import table

#: Notes that a notebook shows.
_MOST_NOTES = 6


@dataclass(frozen=True)
class Measurement:
    """A stored measurement.

    Attributes:
        id: Its id.
        name: Its name.
        experiments: Number of experiments: pairs of magnitude and frequency, or inputs of many
            lines.
        highest_harmonic: Highest harmonic of any experiment.
        magnitude_range: Smallest and largest magnitude, in the unit of the input.
        omega_range_rad_s: Lowest and highest fundamental, rad/s.
        input_unit: Unit of the input; empty if the measurement does not say.
        response_kind: ``"velocity"``, ``"position"`` or ``"acceleration"``.
        response_unit: Unit of the response; empty if the measurement does not say.
        notes: How the server understood the files. Read them once.
        raw: The whole answer of the server.
    """

    id: str
    name: str | None
    experiments: int
    highest_harmonic: int
    magnitude_range: tuple[float, float]
    omega_range_rad_s: tuple[float, float]
    input_unit: str
    response_kind: str
    response_unit: str
    notes: list[str]
    raw: dict[str, Any] = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: dict[str, Any]) -> Measurement:
        """Read the server's answer."""
        low, high = raw["magnitude_range"]
        slow, fast = raw["omega_range_rad_s"]
        quantities = Quantities.of(raw)
        return cls(
            id=raw["id"],
            name=raw.get("name"),
            experiments=raw["experiments"],
            highest_harmonic=raw["highest_harmonic"],
            magnitude_range=(low, high),
            omega_range_rad_s=(slow, fast),
            input_unit=quantities.input_unit,
            response_kind=quantities.response_kind,
            response_unit=quantities.response_unit,
            notes=raw["notes"],
            raw=raw,
        )

    def _repr_html_(self) -> str:
        rows = [
            ("name", self.name or ""),
            ("machine, axis", " ".join(filter(None, map(self.raw.get, ("machine", "axis"))))),
            ("experiments", str(self.experiments)),
            ("harmonics", f"up to {self.highest_harmonic}"),
            ("response", " ".join(filter(None, (self.response_kind, self.response_unit)))),
            ("magnitudes", "{:g} to {:g}".format(*self.magnitude_range) + f" {self.input_unit}"),
            ("fundamentals", "{:g} to {:g} rad/s".format(*self.omega_range_rad_s)),
            *(("note", note) for note in self.notes[:_MOST_NOTES]),
        ]
        if (more := len(self.notes) - _MOST_NOTES) > 0:
            rows.append(("", f"and {more} more notes"))
        return table(("Measurement", self.id), rows)
