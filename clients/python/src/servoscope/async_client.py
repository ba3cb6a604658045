"""The asynchronous client: the methods of ``Client``, to be awaited."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

import httpx

from . import batches, calls, jobs
from .batches import BatchRow, BatchState
from .calls import Order, Priority
from .jobs import JobState, Kind
from .measurements import Measurement
from .results import Diagnosis, Identification, Result
from .steps import DEFAULT_URL, Outcome, Pause, Step, Steps, http_settings
from .uploads import Source, UploadSettings

if TYPE_CHECKING:
    from typing_extensions import Self, Unpack

T = TypeVar("T")
R = TypeVar("R", bound=Result)


class AsyncClient:
    """A server, asked without blocking. Arguments are those of ``Client``.

    Close it, or use it in an ``async with`` statement.
    """

    def __init__(
        self,
        base_url: str = DEFAULT_URL,
        *,
        api_key: str | None = None,
        timeout_s: float = 30.0,
        give_up_after_s: float = 30.0,
    ) -> None:
        self._http = httpx.AsyncClient(**http_settings(base_url, api_key, timeout_s))
        self._give_up_after_s = give_up_after_s

    async def upload(
        self,
        source: Source,
        *,
        idempotency_key: str | None = None,
        **said: Unpack[UploadSettings],
    ) -> Measurement:
        """Upload a measurement: see ``Client.upload``."""
        return await self._run(calls.upload(source, said, idempotency_key, self._give_up_after_s))

    async def measurement(self, measurement_id: str) -> Measurement:
        """Ask for a stored measurement."""
        return await self._run(calls.measurement(measurement_id, self._give_up_after_s))

    async def diagnose(
        self,
        measurement: Measurement | str,
        *,
        actuator_order: Order | None = None,
        method: str | None = None,
        options: dict[str, Any] | None = None,
        priority: Priority | None = None,
        validation: Measurement | str | None = None,
        idempotency_key: str | None = None,
    ) -> AsyncJob[Diagnosis]:
        """Ask where the base model is wrong, and why: see ``Client.diagnose``."""
        body = calls.job_body(
            "diagnose", measurement, actuator_order, method, options, priority, validation
        )
        return await self._submit(body, idempotency_key)

    async def identify(
        self,
        measurement: Measurement | str,
        *,
        actuator_order: Order | None = None,
        method: str | None = None,
        options: dict[str, Any] | None = None,
        priority: Priority | None = None,
        idempotency_key: str | None = None,
    ) -> AsyncJob[Identification]:
        """Fit the base model: see ``Client.identify``."""
        body = calls.job_body("identify", measurement, actuator_order, method, options, priority)
        return await self._submit(body, idempotency_key)

    async def job(self, job_id: str) -> AsyncJob[Result]:
        """Come back to a job by its id."""
        return AsyncJob(self, await self._run(jobs.look(job_id, self._give_up_after_s)))

    async def batch(
        self,
        measurements: Iterable[Measurement | str],
        kind: Kind = "diagnose",
        *,
        name: str | None = None,
        actuator_order: Order | None = None,
        method: str | None = None,
        options: dict[str, Any] | None = None,
        priority: Priority | None = None,
        idempotency_key: str | None = None,
    ) -> AsyncBatch:
        """Compute many measurements in the same way, as one batch: see ``Client.batch``."""
        body = calls.batch_body(measurements, kind, name, actuator_order, method, options, priority)
        steps = batches.submit(body, idempotency_key, self._give_up_after_s)
        return AsyncBatch(self, await self._run(steps))

    async def find_batch(self, batch_id: str) -> AsyncBatch:
        """Come back to a batch by its id."""
        return AsyncBatch(self, await self._run(batches.look(batch_id, self._give_up_after_s)))

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def _submit(self, body: dict[str, Any], key: str | None) -> AsyncJob[Any]:
        return AsyncJob(self, await self._run(jobs.submit(body, key, self._give_up_after_s)))

    async def _run(self, steps: Steps[T]) -> T:
        outcome: Outcome = None
        while True:
            try:
                step = steps.send(outcome)
            except StopIteration as end:
                return cast(T, end.value)
            outcome = await self._do(step)

    async def _do(self, step: Step) -> Outcome:
        if isinstance(step, Pause):
            await asyncio.sleep(step.seconds)
            return None
        try:
            return await self._http.request(**step.arguments(self._http))
        except httpx.TransportError as error:
            return error


class AsyncJob(Generic[R]):
    """A job on the server, as ``Job``."""

    def __init__(self, client: AsyncClient, state: JobState) -> None:
        self._client = client
        self.state = state

    @property
    def id(self) -> str:
        """Its id, by which ``AsyncClient.job`` comes back to it."""
        return self.state.id

    async def refresh(self) -> JobState:
        """Ask how it stands."""
        return await self._update(jobs.look(self.id, self._client._give_up_after_s))

    async def wait(self, timeout_s: float | None = None, *, progress: bool = True) -> R:
        """Wait for the end and give the result: see ``Job.wait``."""
        patience_s = self._client._give_up_after_s
        state = await self._update(jobs.wait(self.id, timeout_s, progress, patience_s))
        return cast(R, await self._client._run(jobs.result_of(state, patience_s)))

    async def cancel(self) -> JobState:
        """Cancel it: see ``Job.cancel``."""
        return await self._update(jobs.cancel(self.id, self._client._give_up_after_s))

    async def _update(self, steps: Steps[JobState]) -> JobState:
        self.state = await self._client._run(steps)
        return self.state

    def __repr__(self) -> str:
        return f"<{self.state.kind} {self.id}: {self.state.status}>"


class AsyncBatch:
    """A batch on the server, as ``Batch``."""

    def __init__(self, client: AsyncClient, state: BatchState) -> None:
        self._client = client
        self.state = state

    @property
    def id(self) -> str:
        """Its id, by which ``AsyncClient.find_batch`` comes back to it."""
        return self.state.id

    async def refresh(self) -> BatchState:
        """Ask how it stands."""
        return await self._update(batches.look(self.id, self._client._give_up_after_s))

    async def wait(
        self, timeout_s: float | None = None, *, progress: bool = True
    ) -> list[BatchRow]:
        """Wait for the end and give what came of each measurement: see ``Batch.wait``."""
        patience_s = self._client._give_up_after_s
        await self._update(batches.wait(self.id, timeout_s, progress, patience_s))
        return await self.rows()

    async def rows(self) -> list[BatchRow]:
        """Ask what came of each measurement so far, in the order in which they were given."""
        return await self._client._run(batches.rows(self.id, self._client._give_up_after_s))

    async def cancel(self) -> BatchState:
        """Cancel what has not ended. Cancelling twice is no error."""
        return await self._update(batches.cancel(self.id, self._client._give_up_after_s))

    async def _update(self, steps: Steps[BatchState]) -> BatchState:
        self.state = await self._client._run(steps)
        return self.state

    def __repr__(self) -> str:
        return f"<batch {self.id}: {self.state.state}>"
