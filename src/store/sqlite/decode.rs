//! How rows are read from SQLite's columns, by their names.
//!
//! Written out rather than derived: the derive macros of `sqlx` compile SQLite a second time.

use sqlx::encode::IsNull;
use sqlx::error::BoxDynError;
use sqlx::sqlite::{SqliteArgumentsBuffer, SqliteRow, SqliteTypeInfo, SqliteValueRef};
use sqlx::{Decode, Encode, FromRow, Row, Sqlite, Type};

use crate::store::{
    AxisRow, ConvergencePoint, DeliveryRow, DueRow, EndedRow, EventRow, FileRow, JobRow, KeyRow,
    Lease, MappingRow, MeasurementRow, QueueState, Status, StoredResult, WebhookRow,
};

/// Reads each field from the column of its name.
macro_rules! from_columns {
    ($row:ident { $($field:ident),* $(,)? }) => {
        impl FromRow<'_, SqliteRow> for $row {
            fn from_row(row: &SqliteRow) -> sqlx::Result<Self> {
                Ok(Self { $($field: row.try_get(stringify!($field))?),* })
            }
        }
    };
}

from_columns!(FileRow { name, content_type, bytes });
from_columns!(MeasurementRow {
    id,
    created_at_ms,
    name,
    machine,
    axis,
    operator,
    measured_at,
    labels,
    sha256,
    experiments,
    highest_harmonic,
    magnitude_min,
    magnitude_max,
    omega_min_rad_s,
    omega_max_rad_s,
    notes,
    quantities,
    files,
    simulation_s,
    diagnosis_s
});
from_columns!(MappingRow { name, settings, layout, updated_at_ms });
from_columns!(JobRow {
    id,
    measurement_id,
    kind,
    request,
    status,
    progress,
    attempt,
    cancel_requested,
    created_at_ms,
    started_at_ms,
    finished_at_ms,
    failure
});
from_columns!(Lease { job_id, attempt, next_seq, measurement_id, kind, request });
from_columns!(ConvergencePoint { seq, stage, cycle, evaluations, best, mean, elapsed_s });
from_columns!(StoredResult { job_id, result, measurement_id, name, machine, axis, at_ms });
from_columns!(AxisRow { machine, axis, measurements, results, first_ms, last_ms });
from_columns!(QueueState { queued, running, oldest_wait_ms });
from_columns!(EndedRow { kind, status });
from_columns!(KeyRow {
    id,
    name,
    scopes,
    sha256,
    created_at_ms,
    expires_at_ms,
    revoked_at_ms,
    used_at_ms,
    now_ms
});
from_columns!(WebhookRow { id, created_at_ms, url, secret, events, disabled, owner });
from_columns!(EventRow { id, job_id, at_ms });
from_columns!(DueRow { id, attempt, age_ms, webhook_id, url, secret, topic, body });
from_columns!(DeliveryRow {
    id,
    event,
    status,
    attempts,
    created_at_ms,
    due_ms,
    ended_at_ms,
    answered,
    error
});

impl Type<Sqlite> for Status {
    fn type_info() -> SqliteTypeInfo {
        <str as Type<Sqlite>>::type_info()
    }
}

impl Encode<'_, Sqlite> for Status {
    fn encode_by_ref(&self, arguments: &mut SqliteArgumentsBuffer) -> Result<IsNull, BoxDynError> {
        self.name().encode_by_ref(arguments)
    }
}

impl Decode<'_, Sqlite> for Status {
    fn decode(value: SqliteValueRef<'_>) -> Result<Self, BoxDynError> {
        let name = <&str as Decode<'_, Sqlite>>::decode(value)?;
        let status = Status::ALL.into_iter().find(|status| status.name() == name);
        status.ok_or_else(|| format!("`{name}` is no status of a job").into())
    }
}
