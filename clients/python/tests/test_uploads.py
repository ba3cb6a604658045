"""Measurements on their way to the server."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path
from uuid import uuid4

import numpy as np
import pandas as pd
import pytest

from servoscope import Client, FrequencyResponse, ProblemError, TimeRecord
from servoscope.uploads import Source


def multisine(periods: int = 6) -> TimeRecord:
    """A record of 10/(s + 10) without friction, with noise."""
    chance = np.random.default_rng(1)
    lines = np.arange(1, 30)
    omega = 2 * np.pi * lines / 2.0
    amplitude = np.exp(2j * np.pi * chance.random(len(lines)))
    time_s = np.arange(periods * 2000) * 1e-3
    turns = np.exp(1j * np.outer(time_s, omega))
    return TimeRecord(
        time_s=time_s,
        input=(turns @ amplitude).real,
        output=(turns @ (amplitude * 10 / (10 + 1j * omega))).real
        + 1e-3 * chance.standard_normal(len(time_s)),
    )


def test_a_file_is_uploaded_as_it_is(client: Client, sticky: Path) -> None:
    measurement = client.upload(sticky)
    assert (measurement.experiments, measurement.highest_harmonic) == (27, 5)
    assert measurement.magnitude_range == (1.6, 6.4)
    assert client.measurement(measurement.id) == measurement


def test_a_frame_and_its_columns_give_what_the_file_gives(client: Client, sticky: Path) -> None:
    frame = pd.read_csv(sticky, comment="#")
    columns = {str(name): frame[name].to_numpy() for name in frame}
    sources: list[Source] = [str(sticky), frame.convert_dtypes(), columns]
    uploads = [client.upload(source) for source in sources]
    assert [upload.omega_range_rad_s for upload in uploads] == [(1.0, 100.0)] * 3
    results = [client.identify(upload, actuator_order=0) for upload in uploads]
    values = [job.wait(progress=False).parameters["pole"].value for job in results]
    assert values[0] == values[1] == values[2]


def test_several_files_form_one_measurement(client: Client, sticky: Path, tmp_path: Path) -> None:
    lines = sticky.read_text().splitlines(keepends=True)
    names = next(index for index, line in enumerate(lines) if line.startswith("magnitude"))
    rows = lines[names + 1 :]
    halves = [tmp_path / "first.csv", tmp_path / "second.csv"]
    for path, part in zip(halves, (rows[:96], rows[96:]), strict=True):
        path.write_text("".join([lines[names], *part]))
    assert client.upload(halves).experiments == 27


def test_a_record_over_time_is_identified(client: Client) -> None:
    measurement = client.upload(
        multisine(), input="current A", response="velocity rad/s", period_s=2.0
    )
    result = client.identify(measurement, actuator_order=0).wait(progress=False)
    assert result.parameters["pole"].value == pytest.approx(-10.0, rel=0.02)
    assert result.parameters["pole"].unit == "rad/s"
    assert result.transfer_function.dc_gain == pytest.approx(1.0, rel=0.02)
    assert result.fit.nrmse < 0.01


def test_a_frequency_response_needs_only_its_magnitude(client: Client) -> None:
    frequency_hz = np.geomspace(0.1, 20, 25)
    ratio = 10 / (10 + 2j * np.pi * frequency_hz)
    measurement = client.upload(FrequencyResponse(frequency_hz, ratio, magnitude=0.5, std=1e-3))
    assert measurement.magnitude_range == (0.5, 0.5)
    assert measurement.experiments == 25


def test_what_is_said_beside_the_data_is_stored(client: Client, sticky: Path) -> None:
    measurement = client.upload(
        sticky,
        machine="press 4",
        axis="Y",
        labels={"site": "north"},
        measured_at=datetime(2024, 5, 31, 13, 45, tzinfo=timezone.utc),
        inverted=False,
    )
    assert measurement.raw["machine"] == "press 4"
    assert measurement.raw["labels"] == {"site": "north"}
    assert measurement.raw["measured_at"].startswith("2024-05-31T13:45")


def test_a_refused_upload_says_line_and_column(client: Client, sticky: Path) -> None:
    frame = pd.read_csv(sticky, comment="#").astype({"im": object})
    frame.loc[3, "im"] = "two"
    with pytest.raises(ProblemError) as refusal:
        client.upload(frame)
    assert (refusal.value.status, refusal.value.file) == (422, "frame.csv")
    assert (refusal.value.line, refusal.value.column) == (5, "im")
    assert "two" in refusal.value.detail
    assert refusal.value.title == "Unreadable measurement"


def test_a_missing_sample_is_refused_at_its_line(client: Client) -> None:
    record = multisine()
    output = np.array(record.output)
    output[7] = np.nan
    with pytest.raises(ProblemError) as refusal:
        client.upload(TimeRecord(record.time_s, record.input, output))
    assert (refusal.value.line, refusal.value.column) == (9, "output")


def test_the_same_key_gives_the_same_measurement(client: Client, sticky: Path) -> None:
    key = str(uuid4())
    first, again = (client.upload(sticky, idempotency_key=key) for _ in range(2))
    assert first.id == again.id
    with pytest.raises(ProblemError, match="key"):
        client.upload(multisine(), idempotency_key=key)


def test_what_cannot_be_an_upload_is_refused_before_it_is_sent(client: Client) -> None:
    with pytest.raises(ValueError, match="different lengths"):
        client.upload(TimeRecord([0, 1], [0, 1], [0]))
    with pytest.raises(ValueError, match="complex"):
        client.upload({"gain": [1j], "frequency_hz": [1.0]})
    with pytest.raises(ValueError, match="time zone"):
        client.upload(multisine(), measured_at=datetime(2024, 5, 31))
    with pytest.raises(TypeError, match="colour"):
        client.upload(multisine(), colour="red")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="takes a path"):
        client.upload(7)  # type: ignore[arg-type]
