"""The synchronous client."""

from __future__ import annotations

import time
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


class Client:
    """A server, asked step by step. Close it, or use it in a ``with`` statement.

    Args:
        base_url: Where the server is.
        api_key: Key that is sent as ``Authorization: Bearer``, for a server that asks for one;
            None: the key in the environment variable ``SERVOSCOPE_KEY``, if there is one.
        timeout_s: Seconds that the server may take to answer a request.
        give_up_after_s: Seconds for which a request is repeated while the server is busy or
            cannot be reached. No repetition makes a second measurement or job.
    """

    def __init__(
        self,
        base_url: str = DEFAULT_URL,
        *,
        api_key: str | None = None,
        timeout_s: float = 30.0,
        give_up_after_s: float = 30.0,
    ) -> None:
        self._http = httpx.Client(**http_settings(base_url, api_key, timeout_s))
        self._give_up_after_s = give_up_after_s

    def upload(
        self,
        source: Source,
        *,
        idempotency_key: str | None = None,
        **said: Unpack[UploadSettings],
    ) -> Measurement:
        """Upload a measurement.

        Args:
            source: A path, or several that form one measurement; a pandas frame or columns by
                name, with the names that a file would have; a ``TimeRecord``; a
                ``FrequencyResponse``.
            idempotency_key: The same key with the same data gives the same measurement. By
                default each call makes one.
            **said: What the data do not say, such as ``input="current A"``,
                ``response="velocity rad/s"``, ``period_s=0.5``: see ``UploadSettings``.

        Raises:
            ProblemError: The data cannot be read; ``line`` and ``column`` say where.
            ServerUnreachable: The server does not answer.
        """
        return self._run(calls.upload(source, said, idempotency_key, self._give_up_after_s))

    def measurement(self, measurement_id: str) -> Measurement:
        """Ask for a stored measurement."""
        return self._run(calls.measurement(measurement_id, self._give_up_after_s))

    def diagnose(
        self,
        measurement: Measurement | str,
        *,
        actuator_order: Order | None = None,
        method: str | None = None,
        options: dict[str, Any] | None = None,
        priority: Priority | None = None,
        validation: Measurement | str | None = None,
        idempotency_key: str | None = None,
    ) -> Job[Diagnosis]:
        """Ask where the base model is wrong, and why.

        Args:
            measurement: A measurement or its id.
            actuator_order: 0, 1 or 2; None: chosen from the data.
            method: How parameters are estimated; None: the server's default.
            options: Options such as ``{"seed": 2, "noise_std": 0.01}``.
            priority: ``"low"``, ``"normal"`` or ``"high"``: which waiting jobs of the same key it
                goes before; None: normal.
            validation: A second measurement of the axis, on which the improvement is measured.
            idempotency_key: The same key with the same request gives the same job. By default
                each call makes one.

        Raises:
            ProblemError: The server refused; ``member`` says which argument is wrong.
            ServerUnreachable: The server does not answer.
        """
        body = calls.job_body(
            "diagnose", measurement, actuator_order, method, options, priority, validation
        )
        return self._submit(body, idempotency_key)

    def identify(
        self,
        measurement: Measurement | str,
        *,
        actuator_order: Order | None = None,
        method: str | None = None,
        options: dict[str, Any] | None = None,
        priority: Priority | None = None,
        idempotency_key: str | None = None,
    ) -> Job[Identification]:
        """Fit the base model. Arguments and errors are those of ``diagnose``."""
        body = calls.job_body("identify", measurement, actuator_order, method, options, priority)
        return self._submit(body, idempotency_key)

    def job(self, job_id: str) -> Job[Result]:
        """Come back to a job by its id."""
        return Job(self, self._run(jobs.look(job_id, self._give_up_after_s)))

    def batch(
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
    ) -> Batch:
        """Compute many measurements in the same way, as one batch.

        Args:
            measurements: Measurements or their ids, at most 10 000, each of them once.
            kind: ``"diagnose"`` or ``"identify"``.
            name: Name of the batch, for people.
            actuator_order: 0, 1 or 2; None: chosen from the data of each.
            method: How parameters are estimated; None: the server's default.
            options: Options such as ``{"seed": 2}``.
            priority: ``"low"``, ``"normal"`` or ``"high"``: which waiting jobs of the same key
                its jobs go before; None: normal.
            idempotency_key: The same key with the same request gives the same batch. By default
                each call makes one.

        Raises:
            ProblemError: The server refused; ``member`` says which measurement or argument is
                wrong. Nothing is computed then.
            ServerUnreachable: The server does not answer.
        """
        body = calls.batch_body(measurements, kind, name, actuator_order, method, options, priority)
        steps = batches.submit(body, idempotency_key, self._give_up_after_s)
        return Batch(self, self._run(steps))

    def find_batch(self, batch_id: str) -> Batch:
        """Come back to a batch by its id."""
        return Batch(self, self._run(batches.look(batch_id, self._give_up_after_s)))

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _submit(self, body: dict[str, Any], key: str | None) -> Job[Any]:
        return Job(self, self._run(jobs.submit(body, key, self._give_up_after_s)))

    def _run(self, steps: Steps[T]) -> T:
        outcome: Outcome = None
        while True:
            try:
                step = steps.send(outcome)
            except StopIteration as end:
                return cast(T, end.value)
            outcome = self._do(step)

    def _do(self, step: Step) -> Outcome:
        if isinstance(step, Pause):
            time.sleep(step.seconds)
            return None
        try:
            return self._http.request(**step.arguments(self._http))
        except httpx.TransportError as error:
            return error


class Job(Generic[R]):
    """A job on the server. It computes whether or not somebody waits for it.

    Attributes:
        state: The job as it stood when the server was last asked.
    """

    def __init__(self, client: Client, state: JobState) -> None:
        self._client = client
        self.state = state

    @property
    def id(self) -> str:
        """Its id, by which ``Client.job`` comes back to it."""
        return self.state.id

    def refresh(self) -> JobState:
        """Ask how it stands."""
        return self._update(jobs.look(self.id, self._client._give_up_after_s))

    def wait(self, timeout_s: float | None = None, *, progress: bool = True) -> R:
        """Wait for the end, over interruptions of the connection, and give the result.

        Args:
            timeout_s: Longest time to wait, seconds; None: until it ends.
            progress: Whether a progress bar is shown.

        Raises:
            JobFailed: It failed.
            JobCancelled: It was cancelled.
            WaitTimeout: It has not ended within ``timeout_s``. It goes on computing.
            ServerUnreachable: The server was away for longer than ``give_up_after_s``.
        """
        patience_s = self._client._give_up_after_s
        state = self._update(jobs.wait(self.id, timeout_s, progress, patience_s))
        return cast(R, self._client._run(jobs.result_of(state, patience_s)))

    def cancel(self) -> JobState:
        """Cancel it: at once if it waits, at its next evaluation if it runs.

        Raises:
            ProblemError: It has already ended (status 409).
        """
        return self._update(jobs.cancel(self.id, self._client._give_up_after_s))

    def _update(self, steps: Steps[JobState]) -> JobState:
        self.state = self._client._run(steps)
        return self.state

    def __repr__(self) -> str:
        return f"<{self.state.kind} {self.id}: {self.state.status}>"


class Batch:
    """A batch on the server. It computes whether or not somebody waits for it."""

    def __init__(self, client: Client, state: BatchState) -> None:
        self._client = client
        self.state = state

    @property
    def id(self) -> str:
        """Its id, by which ``Client.find_batch`` comes back to it."""
        return self.state.id

    def refresh(self) -> BatchState:
        """Ask how it stands."""
        return self._update(batches.look(self.id, self._client._give_up_after_s))

    def wait(self, timeout_s: float | None = None, *, progress: bool = True) -> list[BatchRow]:
        """Wait for the end, and give what came of each measurement, whatever it is.

        Args:
            timeout_s: Longest time to wait, seconds; None: until it ends.
            progress: Whether a progress bar is shown.

        Raises:
            WaitTimeout: It has not ended within ``timeout_s``. It goes on computing.
            ServerUnreachable: The server was away for longer than ``give_up_after_s``.
        """
        patience_s = self._client._give_up_after_s
        self._update(batches.wait(self.id, timeout_s, progress, patience_s))
        return self.rows()

    def rows(self) -> list[BatchRow]:
        """Ask what came of each measurement so far, in the order in which they were given."""
        return self._client._run(batches.rows(self.id, self._client._give_up_after_s))

    def cancel(self) -> BatchState:
        """Cancel what has not ended. Cancelling twice is no error."""
        return self._update(batches.cancel(self.id, self._client._give_up_after_s))

    def _update(self, steps: Steps[BatchState]) -> BatchState:
        self.state = self._client._run(steps)
        return self.state

    def __repr__(self) -> str:
        return f"<batch {self.id}: {self.state.state}>"
