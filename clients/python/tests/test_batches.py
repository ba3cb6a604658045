"""Many measurements at once."""

from __future__ import annotations

import asyncio
from pathlib import Path
from uuid import uuid4

import pytest
from server import Server

from servoscope import AsyncClient, Client, ProblemError, WaitTimeout


def test_a_batch_says_what_came_of_each_measurement(client: Client, sticky: Path) -> None:
    measurements = [client.upload(sticky) for _ in range(2)]
    batch = client.batch(measurements, name="press hall", actuator_order=0)
    rows = batch.wait(progress=False)
    assert batch.state.ended
    assert batch.state.name == "press hall"
    assert [row.measurement_id for row in rows] == [one.id for one in measurements]
    assert {(row.file, row.state, row.verdict, row.cause) for row in rows} == {
        ("sticky.csv", "succeeded", "explained", "static_friction")
    }
    assert all(row.tested for row in rows)
    assert batch.state.causes == {"static_friction": 2}
    assert client.job(rows[0].job_id).wait(progress=False).raw["verdict"] == "explained"
    assert client.find_batch(batch.id).state == batch.state


def test_the_same_key_gives_the_same_batch_and_a_wrong_id_is_named(
    client: Client, sticky: Path
) -> None:
    measurement, key = client.upload(sticky), str(uuid4())
    same = [client.batch([measurement], "identify", idempotency_key=key).id for _ in range(2)]
    assert same[0] == same[1]
    with pytest.raises(ProblemError) as refused:
        client.batch([measurement, "nobody"], "identify")
    assert refused.value.member == "measurement_ids[1]"


def test_a_batch_is_cancelled_and_waited_for_without_threads(server: Server, sticky: Path) -> None:
    endless = {"colony": {"food_sources": 1000, "cycles": 1000, "abandonment_limit": 1_000_000}}

    async def cancelled() -> set[str]:
        async with AsyncClient(server.url) as client:
            measurements = [await client.upload(sticky) for _ in range(3)]
            batch = await client.batch(measurements, "identify", options=endless)
            with pytest.raises(WaitTimeout, match="batch"):
                await batch.wait(timeout_s=0.0, progress=False)
            await batch.cancel()
            return {row.state for row in await batch.wait(progress=False)}

    assert asyncio.run(cancelled()) == {"cancelled"}
