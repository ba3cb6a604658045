-- Times are milliseconds since 1970-01-01 UTC by the database's clock, so that
-- leases do not depend on the clocks of the processes that share the database.

CREATE TABLE measurements (
    id TEXT PRIMARY KEY NOT NULL,               -- UUID version 7: sorts by time
    created_at_ms INTEGER NOT NULL,
    name TEXT,
    machine TEXT,
    axis TEXT,
    operator TEXT,
    measured_at TEXT,                           -- RFC 3339, as the upload says it
    labels TEXT NOT NULL,                       -- JSON object of strings
    sha256 TEXT NOT NULL,
    experiments INTEGER NOT NULL,
    highest_harmonic INTEGER NOT NULL,
    magnitude_min REAL NOT NULL,
    magnitude_max REAL NOT NULL,
    omega_min_rad_s REAL NOT NULL,
    omega_max_rad_s REAL NOT NULL,
    notes TEXT NOT NULL                         -- JSON array of the reader's remarks
) STRICT;

-- The bytes as they came: reading them again gives the same measurement.
CREATE TABLE measurement_files (
    measurement_id TEXT NOT NULL REFERENCES measurements (id) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    name TEXT NOT NULL,
    content_type TEXT NOT NULL,
    bytes BLOB NOT NULL,
    PRIMARY KEY (measurement_id, position)
) STRICT;

CREATE TABLE jobs (
    id TEXT PRIMARY KEY NOT NULL,               -- UUID version 7: sorts by time
    measurement_id TEXT NOT NULL REFERENCES measurements (id),
    kind TEXT NOT NULL,
    request TEXT NOT NULL,                      -- JSON, every option in effect
    status TEXT NOT NULL
        CHECK (status IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
    progress TEXT,                              -- JSON
    attempt INTEGER NOT NULL DEFAULT 0,         -- leases so far; every write names its own
    handed_back INTEGER NOT NULL DEFAULT 0,     -- leases returned in good order
    lease_until_ms INTEGER,
    cancel_requested INTEGER NOT NULL DEFAULT 0,
    created_at_ms INTEGER NOT NULL,
    started_at_ms INTEGER,
    finished_at_ms INTEGER,
    failure TEXT,                               -- JSON, why it failed
    result TEXT                                 -- JSON, the answer
) STRICT;

CREATE INDEX jobs_by_status ON jobs (status, id);

CREATE TABLE convergence (
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    attempt INTEGER NOT NULL,
    seq INTEGER NOT NULL,
    stage TEXT NOT NULL,
    cycle INTEGER NOT NULL,
    evaluations INTEGER NOT NULL,
    best REAL NOT NULL,
    mean REAL,
    elapsed_s REAL NOT NULL,
    PRIMARY KEY (job_id, attempt, seq)
) STRICT, WITHOUT ROWID;

CREATE TABLE idempotency_keys (
    scope TEXT NOT NULL,                        -- what the request creates
    key TEXT NOT NULL,
    body_sha256 TEXT NOT NULL,
    resource_id TEXT NOT NULL,
    created_at_ms INTEGER NOT NULL,
    PRIMARY KEY (scope, key)
) STRICT;

CREATE VIEW clock AS
    SELECT CAST(round(unixepoch('subsec') * 1000) AS INTEGER) AS now_ms;
