"""Client of the servoscope server.

Uploads a measurement of a servo axis, has it diagnosed, and shows the result::

    import servoscope

    with servoscope.Client() as client:
        measurement = client.upload("axis.csv", response="velocity rad/s")
        result = client.diagnose(measurement).wait()
        print(result.verdict, [cause.effect for cause in result.causes])
        result.plot().savefig("axis.png")
"""

from .answers import (
    Cause,
    Fault,
    Fit,
    Gain,
    NextExperiment,
    Parameter,
    TransferFunction,
)
from .async_client import AsyncBatch, AsyncClient, AsyncJob
from .batches import BatchRow, BatchState
from .client import Batch, Client, Job
from .comparison import Comparison, Quantities
from .errors import (
    JobCancelled,
    JobFailed,
    ProblemError,
    ServerUnreachable,
    ServoscopeError,
    WaitTimeout,
)
from .jobs import JobState
from .measurements import Measurement
from .results import Diagnosis, Identification, Result
from .uploads import FrequencyResponse, TimeRecord, UploadSettings

__all__ = [
    "AsyncBatch",
    "AsyncClient",
    "AsyncJob",
    "Batch",
    "BatchRow",
    "BatchState",
    "Cause",
    "Client",
    "Comparison",
    "Diagnosis",
    "Fault",
    "Fit",
    "FrequencyResponse",
    "Gain",
    "Identification",
    "Job",
    "JobCancelled",
    "JobFailed",
    "JobState",
    "Measurement",
    "NextExperiment",
    "Parameter",
    "ProblemError",
    "Quantities",
    "Result",
    "ServerUnreachable",
    "ServoscopeError",
    "TimeRecord",
    "TransferFunction",
    "UploadSettings",
    "WaitTimeout",
]
