"""Batches: many measurements that are computed in the same way."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias
from urllib.parse import quote
from uuid import uuid4

import httpx
from tqdm import tqdm

from .errors import WaitTimeout
from .jobs import Kind
from .steps import Pause, Request, Steps, send

#: Where one job of a batch stands.
RowState: TypeAlias = Literal["queued", "running", "succeeded", "failed", "cancelled", "deleted"]

#: Time between two looks at a batch, seconds.
_PAUSE_S = 1.0
#: Rows of a page that is asked for.
_PAGE = 200


@dataclass(frozen=True)
class BatchState:
    """A batch as it stood when the server was asked.

    Attributes:
        id: Its id.
        name: Its name; None if it has none.
        kind: ``"identify"`` or ``"diagnose"``.
        state: ``"queued"``, ``"running"`` or ``"ended"``.
        jobs: How many jobs it had at first.
        counts: How many of them stand where: see ``BatchRow.state``.
        verdicts: How many results have which verdict; ``"not_tested"``: adequate, as the data
            were too few for any test.
        causes: How many results name which cause first.
        raw: The whole answer of the server.
    """

    id: str
    name: str | None
    kind: Kind
    state: Literal["queued", "running", "ended"]
    jobs: int
    counts: dict[RowState, int]
    verdicts: dict[str, int]
    causes: dict[str, int]
    raw: dict[str, Any] = field(repr=False, compare=False)

    @classmethod
    def of(cls, raw: dict[str, Any]) -> BatchState:
        """Read the server's answer."""
        names = ("id", "name", "kind", "state", "jobs", "counts", "verdicts", "causes")
        return cls(**{name: raw[name] for name in names}, raw=raw)

    @property
    def ended(self) -> bool:
        """Whether all of its jobs have ended or are gone."""
        return self.state == "ended"


@dataclass(frozen=True)
class BatchRow:
    """What came of one measurement of a batch.

    Attributes:
        measurement_id: The measurement.
        file: Name of its first file.
        job_id: The job; ``Client.job`` gives its whole result.
        state: Where the job stands; ``"deleted"``: it is gone.
        verdict: Verdict of a diagnosis; None until there is one.
        cause: Id of the strongest cause that is named; None where none is.
        confidence: Confidence in this cause.
        problem: Why there is no result; None where there is one, or may be.
        tested: Whether the data were enough to test the base model: without a test, the verdict
            ``"adequate"`` says nothing. None where there is no verdict.
    """

    measurement_id: str
    file: str | None
    job_id: str
    state: RowState
    verdict: str | None
    cause: str | None
    confidence: float | None
    problem: str | None
    tested: bool | None = None

    @classmethod
    def of(cls, raw: dict[str, Any]) -> BatchRow:
        """Read the server's answer."""
        return cls(**{name: raw[name] for name in cls.__dataclass_fields__ if name in raw})


def submit(body: dict[str, Any], key: str | None, give_up_after_s: float) -> Steps[BatchState]:
    """Queue a batch. Sent again, the request gives the same batch."""
    headers = {"Idempotency-Key": key or str(uuid4())}
    request = Request("POST", "/v1/batches", headers=headers, json=body, patience_s=60)
    return _state((yield from send(request, give_up_after_s)))


def look(batch_id: str, give_up_after_s: float) -> Steps[BatchState]:
    """Ask for a batch as it stands."""
    return _state((yield from send(Request("GET", _path(batch_id)), give_up_after_s)))


def cancel(batch_id: str, give_up_after_s: float) -> Steps[BatchState]:
    """Cancel what has not ended. Cancelling twice is no error."""
    request = Request("POST", f"{_path(batch_id)}/cancel", patience_s=60)
    return _state((yield from send(request, give_up_after_s)))


def wait(
    batch_id: str, timeout_s: float | None, progress: bool, give_up_after_s: float
) -> Steps[BatchState]:
    """Wait for the end of a batch, over interruptions of the connection."""
    begin = time.monotonic()
    with tqdm(unit="job", disable=not progress) as bar:
        while True:
            batch = yield from look(batch_id, give_up_after_s)
            left = batch.counts["queued"] + batch.counts["running"]
            bar.total = batch.jobs
            bar.update(batch.jobs - left - bar.n)
            if batch.ended:
                return batch
            if timeout_s is not None and time.monotonic() - begin >= timeout_s:
                raise WaitTimeout(batch_id, timeout_s, what="batch")
            yield Pause(_PAUSE_S)


def rows(batch_id: str, give_up_after_s: float) -> Steps[list[BatchRow]]:
    """Ask what came of each measurement so far, in the order in which they were given."""
    found: list[BatchRow] = []
    params = {"limit": str(_PAGE)}
    while True:
        request = Request("GET", f"{_path(batch_id)}/results", params=params)
        page = (yield from send(request, give_up_after_s)).json()
        found.extend(BatchRow.of(raw) for raw in page["items"])
        if page["next"] is None:
            return found
        params = {**params, "cursor": page["next"]}


def _path(batch_id: str) -> str:
    return f"/v1/batches/{quote(batch_id, safe='')}"


def _state(response: httpx.Response) -> BatchState:
    return BatchState.of(response.json())
