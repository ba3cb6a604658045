"""Jobs: submitting, waiting, cancelling."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias
from urllib.parse import quote
from uuid import uuid4

import httpx
from tqdm import tqdm

from .comparison import Comparison, Quantities
from .errors import JobCancelled, JobFailed, WaitTimeout
from .results import Result, read_result
from .steps import Pause, Request, Steps, send, send_if_there

Kind: TypeAlias = Literal["identify", "diagnose"]
Status: TypeAlias = Literal["queued", "running", "succeeded", "failed", "cancelled"]

#: Longest that one request waits for the end of a job, seconds.
_LOOK_S = 30
#: The same where a progress bar is shown: the server tells of progress as it answers.
_LOOK_FOR_PROGRESS_S = 1
#: Shortest time between two looks at a job, seconds.
_PAUSE_S = 0.1


@dataclass(frozen=True)
class JobState:
    """A job as it stood when the server was asked.

    Attributes:
        id: Its id.
        kind: ``"identify"`` or ``"diagnose"``.
        measurement_id: The measurement it works on.
        status: ``"queued"``, ``"running"``, ``"succeeded"``, ``"failed"`` or ``"cancelled"``.
        fraction: Share of the computation that is done, 0 to 1.
        stage: What is being computed, in words.
        remaining_s: Estimate of the time left, seconds; None while it is unknown.
        failure: Why it failed; None unless it did.
        raw: The whole answer of the server.
    """

    id: str
    kind: Kind
    measurement_id: str
    status: Status
    fraction: float
    stage: str
    remaining_s: float | None
    failure: str | None
    raw: dict[str, Any] = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: dict[str, Any]) -> JobState:
        """Read the server's answer."""
        progress = raw.get("progress") or {}
        failure = raw.get("failure") or {}
        return cls(
            id=raw["id"],
            kind=raw["kind"],
            measurement_id=raw["measurement_id"],
            status=raw["status"],
            fraction=progress.get("fraction", 0.0),
            stage=progress.get("stage", ""),
            remaining_s=progress.get("remaining_s"),
            failure=failure.get("reason"),
            raw=raw,
        )

    @property
    def ended(self) -> bool:
        """Whether it has ended, well or not."""
        return self.status not in ("queued", "running")


def submit(body: dict[str, Any], key: str | None, give_up_after_s: float) -> Steps[JobState]:
    """Queue a job. Sent again, the request gives the same job."""
    headers = {"Idempotency-Key": key or str(uuid4())}
    request = Request("POST", "/v1/jobs", headers=headers, json=body)
    return _state((yield from send(request, give_up_after_s)))


def look(job_id: str, give_up_after_s: float, wait_s: int = 0) -> Steps[JobState]:
    """Ask for a job, as soon as it has ended or so many seconds are over."""
    request = Request("GET", _path(job_id), params={"wait": str(wait_s)}, patience_s=wait_s)
    return _state((yield from send(request, give_up_after_s)))


def cancel(job_id: str, give_up_after_s: float) -> Steps[JobState]:
    """Cancel a job. Cancelling twice is no error."""
    request = Request("POST", f"{_path(job_id)}/cancel")
    return _state((yield from send(request, give_up_after_s)))


def wait(
    job_id: str, timeout_s: float | None, progress: bool, give_up_after_s: float
) -> Steps[JobState]:
    """Wait for the end of a job, over interruptions of the connection."""
    begin = time.monotonic()
    longest_s = _LOOK_FOR_PROGRESS_S if progress else _LOOK_S
    form = "{percentage:3.0f}% |{bar}| {desc}"
    with tqdm(total=1.0, bar_format=form, disable=not progress) as bar:
        while True:
            spent_s = time.monotonic() - begin
            left_s = longest_s if timeout_s is None else max(0.0, timeout_s - spent_s)
            job = yield from look(job_id, give_up_after_s, int(min(longest_s, left_s)))
            bar.set_description_str(_words(job), refresh=False)
            bar.update(job.fraction - bar.n)
            if job.ended:
                return job
            if timeout_s is not None and left_s <= 0.0:
                raise WaitTimeout(job_id, timeout_s)
            yield Pause(min(_PAUSE_S, left_s))


def result_of(job: JobState, give_up_after_s: float) -> Steps[Result]:
    """Fetch the result of a job that has ended, with what its figures need.

    Raises:
        JobFailed: It failed.
        JobCancelled: It was cancelled.
    """
    if job.status == "failed":
        raise JobFailed(job)
    if job.status == "cancelled":
        raise JobCancelled(job)

    def get(path: str) -> Request:
        return Request("GET", path, patience_s=60)

    answer = yield from send(get(f"{_path(job.id)}/result"), give_up_after_s)
    table = yield from send_if_there(get(f"{_path(job.id)}/comparison.csv"), give_up_after_s)
    measured = yield from send_if_there(
        get(f"/v1/measurements/{job.measurement_id}"), give_up_after_s
    )
    comparison = None
    if table is not None and measured is not None:
        comparison = Comparison.of(table.text, Quantities.of(measured.json()))
    return read_result(answer.json(), comparison)


def _path(job_id: str) -> str:
    return f"/v1/jobs/{quote(job_id, safe='')}"


def _state(response: httpx.Response) -> JobState:
    return JobState.of(response.json())


def _words(job: JobState) -> str:
    left = "" if job.remaining_s is None else f", {job.remaining_s:.0f} s left"
    return f"{job.stage or job.status}{left}"
