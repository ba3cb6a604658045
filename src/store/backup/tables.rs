//! Every table and column that is kept, whatever the engine.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::store) enum Kind {
    Integer,
    Real,
    Text,
    Bytes,
    /// Yes or no; in SQLite 1 or 0.
    Flag,
}

/// A column by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::store) struct Column {
    pub(in crate::store) name: &'static str,
    pub(in crate::store) kind: Kind,
}

/// A table by its name.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::store) struct Table {
    pub(in crate::store) name: &'static str,
    /// Columns of its key, by which its rows are sorted.
    pub(in crate::store) key: &'static str,
    pub(in crate::store) columns: &'static [Column],
}

impl Table {
    /// Reads every column of every row, by the key.
    pub(in crate::store) fn select(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|column| column.name).collect();
        format!("SELECT {} FROM {} ORDER BY {}", names.join(", "), self.name, self.key)
    }
}

const fn integer(name: &'static str) -> Column {
    Column { name, kind: Kind::Integer }
}

const fn real(name: &'static str) -> Column {
    Column { name, kind: Kind::Real }
}

const fn text(name: &'static str) -> Column {
    Column { name, kind: Kind::Text }
}

const fn bytes(name: &'static str) -> Column {
    Column { name, kind: Kind::Bytes }
}

const fn flag(name: &'static str) -> Column {
    Column { name, kind: Kind::Flag }
}

/// Every table, after those that its rows refer to. `queue` of Postgres follows from `jobs`.
pub(in crate::store) const TABLES: &[Table] = &[
    Table {
        name: "measurements",
        key: "id",
        columns: &[
            text("id"),
            integer("created_at_ms"),
            text("owner"),
            text("name"),
            text("machine"),
            text("axis"),
            text("operator"),
            text("measured_at"),
            text("labels"),
            text("sha256"),
            integer("experiments"),
            integer("highest_harmonic"),
            real("magnitude_min"),
            real("magnitude_max"),
            real("omega_min_rad_s"),
            real("omega_max_rad_s"),
            text("notes"),
            text("quantities"),
            real("simulation_s"),
            real("diagnosis_s"),
        ],
    },
    Table {
        name: "measurement_files",
        key: "measurement_id, position",
        columns: &[
            text("measurement_id"),
            integer("position"),
            text("name"),
            text("content_type"),
            bytes("bytes"),
        ],
    },
    Table {
        name: "batches",
        key: "id",
        columns: &[
            text("id"),
            integer("created_at_ms"),
            text("owner"),
            text("name"),
            text("kind"),
            text("request"),
            integer("jobs"),
        ],
    },
    Table {
        name: "batch_members",
        key: "batch_id, job_id",
        columns: &[text("batch_id"), text("job_id"), text("measurement_id"), text("file")],
    },
    Table {
        name: "jobs",
        key: "id",
        columns: &[
            text("id"),
            text("measurement_id"),
            text("owner"),
            text("submitter"),
            integer("turn"),
            text("kind"),
            text("request"),
            text("status"),
            text("progress"),
            integer("attempt"),
            integer("handed_back"),
            integer("charged"),
            integer("shared"),
            integer("due_ms"),
            text("worker"),
            integer("lease_until_ms"),
            integer("renewed_at_ms"),
            flag("cancel_requested"),
            integer("created_at_ms"),
            integer("started_at_ms"),
            integer("finished_at_ms"),
            text("failure"),
            text("result"),
            text("batch_id"),
            text("verdict"),
            text("cause"),
            real("confidence"),
            integer("priority"),
        ],
    },
    Table {
        name: "runs",
        key: "job_id, attempt",
        columns: &[
            text("job_id"),
            integer("attempt"),
            text("owner"),
            integer("started_at_ms"),
            integer("ended_at_ms"),
        ],
    },
    Table {
        name: "convergence",
        key: "job_id, attempt, seq",
        columns: &[
            text("job_id"),
            integer("attempt"),
            integer("seq"),
            text("stage"),
            integer("cycle"),
            integer("evaluations"),
            real("best"),
            real("mean"),
            real("elapsed_s"),
        ],
    },
    Table {
        name: "idempotency_keys",
        key: "owner, scope, key",
        columns: &[
            text("owner"),
            text("scope"),
            text("key"),
            text("body_sha256"),
            text("resource_id"),
            integer("created_at_ms"),
        ],
    },
    Table {
        name: "mappings",
        key: "owner, name",
        columns: &[
            text("owner"),
            text("name"),
            text("settings"),
            text("layout"),
            integer("updated_at_ms"),
        ],
    },
    Table {
        name: "keys",
        key: "id",
        columns: &[
            text("id"),
            text("name"),
            text("scopes"),
            text("sha256"),
            integer("created_at_ms"),
            integer("expires_at_ms"),
            integer("revoked_at_ms"),
            integer("used_at_ms"),
            text("quotas"),
        ],
    },
    Table {
        name: "sessions",
        key: "sha256",
        columns: &[text("sha256"), text("key_id"), integer("expires_at_ms")],
    },
    Table {
        name: "webhooks",
        key: "id",
        columns: &[
            text("id"),
            integer("created_at_ms"),
            text("owner"),
            text("url"),
            text("secret"),
            text("events"),
            text("disabled"),
        ],
    },
    Table {
        name: "events",
        key: "id",
        columns: &[integer("id"), text("job_id"), integer("at_ms")],
    },
    Table {
        name: "deliveries",
        key: "id",
        columns: &[
            text("id"),
            text("webhook_id"),
            text("event"),
            text("topic"),
            text("body"),
            text("status"),
            integer("attempts"),
            integer("created_at_ms"),
            integer("due_ms"),
            integer("lease_until_ms"),
            integer("ended_at_ms"),
            integer("answered"),
            text("error"),
        ],
    },
];
