//! How rows are read from columns, by their names, and how values are bound: the same for every
//! engine.
//!
//! Written out rather than derived: the derive macros of `sqlx` compile SQLite a second time.

use std::time::Duration;

use sqlx::encode::IsNull;
use sqlx::error::BoxDynError;
use sqlx::{ColumnIndex, Database, Decode, Encode, FromRow, Row, Type};

use super::{
    AxisRow, BatchRow, ConvergencePoint, DeliveryRow, DueRow, EndedRow, EventRow, FailureRow,
    FileRow, JobRow, KeyRow, Lease, MappingRow, MeasurementRow, MemberRow, Millis, QueueState,
    Status, StoredResult, TallyRow, WebhookRow,
};

/// Reads each field from the column of its name; one with a type in brackets from a column of
/// that type.
macro_rules! from_columns {
    ($row:ident { $($field:ident $([$column:ty])?),* $(,)? }) => {
        impl<'r, R: Row> FromRow<'r, R> for $row
        where
            &'static str: ColumnIndex<R>,
            String: Decode<'r, R::Database> + Type<R::Database>,
            i64: Decode<'r, R::Database> + Type<R::Database>,
            f64: Decode<'r, R::Database> + Type<R::Database>,
            bool: Decode<'r, R::Database> + Type<R::Database>,
            Vec<u8>: Decode<'r, R::Database> + Type<R::Database>,
            Status: Decode<'r, R::Database> + Type<R::Database>,
        {
            fn from_row(row: &'r R) -> sqlx::Result<Self> {
                Ok(Self { $($field: from_columns!(@read row $field $($column)?)),* })
            }
        }
    };
    (@read $row:ident $field:ident) => { $row.try_get(stringify!($field))? };
    (@read $row:ident $field:ident $column:ty) => {
        narrowed(stringify!($field), $row.try_get::<$column, _>(stringify!($field))?)?
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
    failure,
    batch_id
});
from_columns!(BatchRow { id, created_at_ms, name, kind, request, jobs });
from_columns!(TallyRow { batch_id, status, verdict, cause, jobs, started_ms, finished_ms });
from_columns!(FailureRow { reason, jobs });
from_columns!(MemberRow {
    measurement_id,
    file,
    job_id,
    status,
    verdict,
    cause,
    confidence,
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
    quotas,
    now_ms
});
from_columns!(WebhookRow { id, created_at_ms, url, secret, events, disabled, owner });
from_columns!(EventRow { id, job_id, at_ms });
from_columns!(DueRow { id, attempt [i64], age_ms, webhook_id, url, secret, topic, body });
from_columns!(DeliveryRow {
    id,
    event,
    status,
    attempts [i64],
    created_at_ms,
    due_ms,
    ended_at_ms,
    answered [Option<i64>],
    error
});

/// A number of a column, which has one width, as the type of its field.
trait Narrowed<T> {
    fn narrowed(self) -> Result<T, BoxDynError>;
}

impl Narrowed<u32> for i64 {
    fn narrowed(self) -> Result<u32, BoxDynError> {
        Ok(u32::try_from(self)?)
    }
}

impl Narrowed<Option<u16>> for Option<i64> {
    fn narrowed(self) -> Result<Option<u16>, BoxDynError> {
        Ok(self.map(u16::try_from).transpose()?)
    }
}

fn narrowed<T>(column: &str, value: impl Narrowed<T>) -> sqlx::Result<T> {
    let wrong = |source| sqlx::Error::ColumnDecode { index: column.to_owned(), source };
    value.narrowed().map_err(wrong)
}

impl<DB: Database> Type<DB> for Status
where
    str: Type<DB>,
{
    fn type_info() -> DB::TypeInfo {
        <str as Type<DB>>::type_info()
    }

    fn compatible(of: &DB::TypeInfo) -> bool {
        <str as Type<DB>>::compatible(of)
    }
}

impl<'q, DB: Database> Encode<'q, DB> for Status
where
    &'static str: Encode<'q, DB>,
{
    fn encode_by_ref(&self, arguments: &mut DB::ArgumentBuffer) -> Result<IsNull, BoxDynError> {
        <&'static str as Encode<'q, DB>>::encode_by_ref(&self.name(), arguments)
    }
}

impl<'r, DB: Database> Decode<'r, DB> for Status
where
    &'r str: Decode<'r, DB>,
{
    fn decode(value: DB::ValueRef<'r>) -> Result<Self, BoxDynError> {
        let name = <&str as Decode<'r, DB>>::decode(value)?;
        let status = Status::ALL.into_iter().find(|status| status.name() == name);
        status.ok_or_else(|| format!("`{name}` is no status of a job").into())
    }
}

/// A duration as it is bound.
pub(super) fn millis(duration: Duration) -> Millis {
    Millis::try_from(duration.as_millis()).unwrap_or(Millis::MAX)
}

/// Labels as the JSON array of pairs that filters read.
pub(super) fn label_pairs(labels: &[(String, String)]) -> String {
    serde_json::json!(labels).to_string()
}
