"""Results as a reader sees them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_uploads import multisine

from servoscope import Client, Diagnosis, Quantities, ServoscopeError
from servoscope.answers import Gain
from servoscope.figures.friction import torque
from servoscope.figures.parts import levels
from servoscope.notebook import change
from servoscope.results import Frame, Plot


@pytest.mark.parametrize("kind", ["overview", "bode", "residuals", "friction"])
def test_every_figure_is_written(diagnosis: Diagnosis, tmp_path: Path, kind: Plot) -> None:
    path = tmp_path / f"{kind}.png"
    diagnosis.plot(kind).savefig(path)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert path.stat().st_size > 5000


def test_a_record_of_many_lines_is_drawn(client: Client, tmp_path: Path) -> None:
    measurement = client.upload(multisine(), period_s=2.0)
    result = client.identify(measurement, actuator_order=0).wait(progress=False)
    assert result.comparison
    assert len(result.comparison.excited(np.arange(len(result.comparison.harmonic)))) > 20
    result.plot().savefig(tmp_path / "overview.svg")
    assert "measured" in (tmp_path / "overview.svg").read_text()
    assert "noise" in result.headline
    with pytest.raises(ServoscopeError, match="causes"):
        result.frame("causes")


@pytest.mark.parametrize(
    ("table", "columns"),
    [
        ("parameters", {"model", "parameter", "value", "low95", "high95", "unit"}),
        ("causes", {"effect", "confidence", "parameter", "value"}),
        ("candidates", {"effect", "delta_chi2", "rejected"}),
        ("residuals", {"by", "from", "to", "rms_sigmas"}),
        ("comparison", {"frequency_hz", "measured", "base", "extended"}),
    ],
)
def test_every_table_is_a_frame(diagnosis: Diagnosis, table: Frame, columns: set[str]) -> None:
    frame = diagnosis.frame(table)
    assert len(frame) > 0
    assert columns <= set(frame.columns)


def test_pages_escape_what_comes_from_files(
    client: Client, diagnosis: Diagnosis, sticky: Path
) -> None:
    page = diagnosis._repr_html_()
    assert "<b>" not in page
    assert "&lt;b&gt;" in page
    assert "static_friction" in page
    assert "<h3>EXPLAINED: The simulation lacks static friction" in page
    assert "<p>Improvement on held-out data: residual ÷ " in page
    assert " (95 % interval " in page
    measurement = client.upload(sticky, name="<script>alert(1)</script>", machine="<img src=x>")
    page = measurement._repr_html_()
    assert "&lt;script&gt;" in page
    assert "<script" not in page
    assert "<img" not in page


def test_the_friction_curve_starts_at_the_level_and_rises_by_the_damping(
    diagnosis: Diagnosis,
) -> None:
    at_rest, moving = torque(diagnosis.model, 1, np.array([0.0, 2.0]))
    assert at_rest == pytest.approx(0.5, rel=0.02)
    assert moving - at_rest == pytest.approx(2.0, rel=0.02)
    assert torque(diagnosis.model, -1, np.array([0.0]))[0] == pytest.approx(-0.4, rel=0.02)


def test_the_fastest_motion_is_that_of_the_record(diagnosis: Diagnosis) -> None:
    assert diagnosis.comparison
    assert diagnosis.comparison.quantities == Quantities("$A<b>", "velocity", "rad/s")
    assert not diagnosis.comparison.std_estimated
    assert 5.0 < diagnosis.comparison.fastest() < 6.5


def test_units_of_the_velocity_follow_from_the_response() -> None:
    def said(kind: str, unit: str) -> dict[str, object]:
        return {"response": {"name": kind, "unit": unit}, "response_kind": kind}

    units = [
        Quantities.of(said(kind, unit)).velocity_unit
        for kind, unit in (
            ("velocity", "mm/s"),
            ("position", "mm"),
            ("acceleration", "m/s²"),
            ("position", ""),
        )
    ]
    assert units == ["mm/s", "mm/s", "(m/s²)·s", ""]


def test_what_moves_an_axis_follows_from_its_units() -> None:
    units = {
        ("N", "m/s"): "force",
        ("N m", "rad/s"): "torque",
        ("Nm", ""): "torque",
        ("A", "mm/s"): "force",
        ("V", "(rad/s)"): "torque",
        ("A", ""): "force or torque",
    }
    for (source, response), effort in units.items():
        assert Quantities(source, "velocity", response).effort == effort, source


def test_a_residual_that_grows_is_not_called_smaller() -> None:
    raw = {"heldout_nrmse_before": 0.02, "heldout_nrmse_after": 0.01, "heldout": "lines"}
    better = Gain.of({**raw, "ratio": 4.2, "interval95": [3.5, 5.0]})
    assert change(better) == "residual ÷ 4.2 (95 % interval 3.5 to 5)"
    worse = Gain.of({**raw, "ratio": 0.5, "interval95": [0.4, 0.8]})
    assert change(worse) == "residual × 2 (95 % interval 1.25 to 2.5)"


def test_magnitudes_that_were_measured_form_levels() -> None:
    magnitudes = np.array([2.41, 1.2, 2.4, 1.203, 1.3])
    assert levels(magnitudes).tolist() == [2, 0, 2, 0, 1]
