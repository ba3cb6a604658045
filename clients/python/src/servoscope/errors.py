"""What can go wrong, as exceptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import httpx

if TYPE_CHECKING:
    from .jobs import JobState


class ServoscopeError(Exception):
    """Base class of every exception of this package."""


class ServerUnreachable(ServoscopeError):
    """The server did not answer, and repeating the request did not help."""


class ProblemError(ServoscopeError):
    """The server refused a request and said why (a problem document, RFC 9457).

    Attributes:
        status: HTTP status code.
        title: The kind of problem in words.
        detail: What is wrong with this request, and what would be right.
        type: Identifies the kind of problem.
        file: Uploaded file that is wrong, if it is one.
        line: Line of that file, counted from 1. In an uploaded table of columns,
            line 1 has the names, and row ``i`` (from 0) is line ``i + 2``.
        column: Column that is wrong: its name, or its position counted from 1.
        member: Member of the request that is wrong, with dots where it is nested.
        reference: What to look for in the server's log.
    """

    def __init__(self, status: int, document: dict[str, Any]) -> None:
        self.status = status
        self.title: str = str(document.get("title") or f"HTTP status {status}")
        self.detail: str = str(document.get("detail") or "")
        self.type: str = str(document.get("type") or "about:blank")
        self.file: str | None = document.get("file")
        self.line: int | None = document.get("line")
        self.column: str | int | None = document.get("column")
        self.member: str | None = document.get("member")
        self.reference: str | None = document.get("reference")
        super().__init__(f"{self.title}: {self.detail}" if self.detail else self.title)


class JobFailed(ServoscopeError):
    """A job ended without a result; ``job`` is its last state."""

    def __init__(self, job: JobState) -> None:
        self.job = job
        super().__init__(f"job {job.id} failed: {job.failure or 'no reason was given'}")


class JobCancelled(ServoscopeError):
    """A job was cancelled; ``job`` is its last state."""

    def __init__(self, job: JobState) -> None:
        self.job = job
        super().__init__(f"job {job.id} was cancelled")


class WaitTimeout(ServoscopeError, TimeoutError):
    """A job or batch had not ended when the time to wait was over. It goes on computing."""

    def __init__(self, of_id: str, seconds: float, what: str = "job") -> None:
        super().__init__(f"{what} {of_id} has not ended within {seconds:g} s")


def raise_for_problem(response: httpx.Response) -> None:
    """Raise ``ProblemError`` for an answer that is an error."""
    if response.status_code < 400:
        return
    try:
        document = response.json()
    except ValueError:
        document = None
    if not isinstance(document, dict):
        document = {"title": f"HTTP status {response.status_code}", "detail": response.text[:300]}
    raise ProblemError(response.status_code, document)
