"""Jobs, and what happens to them."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from uuid import uuid4

import httpx
import pytest
from server import Server

from servoscope import (
    AsyncClient,
    Client,
    Diagnosis,
    Identification,
    JobCancelled,
    ProblemError,
    ServerUnreachable,
    WaitTimeout,
)
from servoscope.steps import Pause, Request, send


@pytest.fixture
def mortal() -> Iterator[Server]:
    """A server that a test may kill."""
    server = Server()
    server.start()
    yield server
    server.end()


def test_static_friction_is_named(diagnosis: Diagnosis) -> None:
    assert diagnosis.verdict == "explained"
    [cause] = diagnosis.causes
    assert cause.effect == "static_friction"
    assert cause.confidence > 0.99
    assert cause.parameters["fs_plus"].value == pytest.approx(0.8, rel=0.05)
    assert diagnosis.gain
    assert diagnosis.gain.interval95[0] > 1.0
    assert diagnosis.extended
    assert diagnosis.extended.fit.adequate
    assert diagnosis.model is diagnosis.extended
    assert diagnosis.headline.startswith("EXPLAINED: The simulation lacks static friction")
    assert diagnosis.raw["provenance"]["software_version"]


def test_the_same_key_gives_the_same_job(client: Client, sticky: Path) -> None:
    measurement, key = client.upload(sticky), str(uuid4())
    jobs = [client.identify(measurement, actuator_order=0, idempotency_key=key) for _ in range(2)]
    assert jobs[0].id == jobs[1].id
    with pytest.raises(ProblemError, match="key"):
        client.identify(measurement, actuator_order=1, idempotency_key=key)


def test_a_repeated_request_carries_the_same_key() -> None:
    request = Request("POST", "/v1/jobs", headers={"Idempotency-Key": "k"})
    steps = send(request, give_up_after_s=5.0)
    assert next(steps) is request
    assert isinstance(steps.send(httpx.ReadError("the connection broke")), Pause)
    assert steps.send(None) is request
    assert isinstance(steps.send(httpx.Response(503)), Pause)
    assert steps.send(None) is request
    with pytest.raises(StopIteration) as end:
        steps.send(httpx.Response(202))
    assert end.value.value.status_code == 202


def test_a_job_is_found_again_by_its_id(client: Client, sticky: Path) -> None:
    job = client.identify(client.upload(sticky), actuator_order=0)
    result = client.job(job.id).wait(progress=False)
    assert isinstance(result, Identification)
    assert job.refresh().status == "succeeded"
    assert job.wait(progress=False) == result


def test_a_job_takes_the_priority_that_it_is_given(client: Client, sticky: Path) -> None:
    measurement = client.upload(sticky)
    low = client.identify(measurement, actuator_order=0, priority="low")
    high = client.identify(measurement, actuator_order=0, priority="high")
    unsaid = client.identify(measurement, actuator_order=0)
    assert [job.state.raw["priority"] for job in (low, high, unsaid)] == ["low", "high", "normal"]


def test_a_cancelled_job_has_no_result(client: Client, sticky: Path) -> None:
    job = client.diagnose(client.upload(sticky))
    job.cancel()
    with pytest.raises(JobCancelled, match=job.id):
        job.wait(progress=False)
    with pytest.raises(ProblemError) as refusal:
        done = client.identify(job.state.measurement_id, actuator_order=0)
        done.wait(progress=False)
        done.cancel()
    assert refusal.value.status == 409


def test_waiting_ends_when_its_time_is_over(client: Client, sticky: Path) -> None:
    job = client.diagnose(client.upload(sticky))
    begin = time.monotonic()
    with pytest.raises(WaitTimeout):
        job.wait(timeout_s=0.5, progress=False)
    assert 0.4 < time.monotonic() - begin < 3.0
    job.cancel()


def test_progress_is_shown(
    client: Client, sticky: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    client.identify(client.upload(sticky), actuator_order=0).wait()
    assert "100%" in capsys.readouterr().err


def test_waiting_goes_on_after_the_server_was_away(mortal: Server, sticky: Path) -> None:
    with Client(mortal.url) as client:
        job = client.diagnose(client.upload(sticky), actuator_order=0)

        def interrupt() -> None:
            time.sleep(0.5)
            mortal.kill()
            time.sleep(0.5)
            mortal.start()

        away = threading.Thread(target=interrupt)
        away.start()
        result = job.wait(progress=False)
        away.join()
    assert [cause.effect for cause in result.causes] == ["static_friction"]
    assert job.state.raw["attempt"] == 2


def test_a_server_that_stays_away_is_an_error(mortal: Server, sticky: Path) -> None:
    with Client(mortal.url, give_up_after_s=0.5) as client:
        job = client.diagnose(client.upload(sticky))
        mortal.kill()
        with pytest.raises(ServerUnreachable):
            job.wait(progress=False)


def test_the_asynchronous_client_does_the_same(
    server: Server, sticky: Path, diagnosis: Diagnosis
) -> None:
    async def ask() -> list[Identification]:
        async with AsyncClient(server.url) as client:
            measurement = await client.upload(sticky)
            assert await client.measurement(measurement.id) == measurement
            jobs = [await client.identify(measurement, actuator_order=order) for order in (0, 1)]
            return await asyncio.gather(*(job.wait(progress=False) for job in jobs))

    first, second = asyncio.run(ask())
    assert first.parameters["pole"].value == diagnosis.base.parameters["pole"].value
    assert "actuator_pole" in second.parameters


def test_the_asynchronous_client_cancels(server: Server, sticky: Path) -> None:
    async def ask() -> None:
        async with AsyncClient(server.url) as client:
            job = await client.diagnose(await client.upload(sticky))
            await job.cancel()
            with pytest.raises(JobCancelled):
                await (await client.job(job.id)).wait(progress=False)

    asyncio.run(ask())


def test_an_unknown_id_is_an_error(client: Client) -> None:
    for ask in (client.job, client.measurement):
        with pytest.raises(ProblemError) as refusal:
            ask("../../livez")
        assert refusal.value.status == 404


def test_a_key_is_sent_and_not_shown() -> None:
    client = Client(api_key="secret")
    assert client._http.headers["Authorization"] == "Bearer secret"
    assert "secret" not in repr(client)
    assert "secret" not in repr(client._http.headers)
    with pytest.raises(ValueError, match="api_key") as refusal:
        Client(api_key="secret\n")
    assert "secret" not in str(refusal.value)


def test_a_key_of_the_environment_is_sent_where_none_is_given(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("SERVOSCOPE_KEY", "secret")
    assert Client()._http.headers["Authorization"] == "Bearer secret"
    assert Client(api_key="other")._http.headers["Authorization"] == "Bearer other"
    monkeypatch.delenv("SERVOSCOPE_KEY")
    assert "Authorization" not in Client()._http.headers


def test_an_address_that_is_none_is_an_error_at_once() -> None:
    with Client("ftp://127.0.0.1") as client, pytest.raises(ServerUnreachable, match="protocol"):
        client.measurement("1")
