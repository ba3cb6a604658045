-- Many jobs that are made, watched and cancelled together.
CREATE TABLE batches (
    id TEXT PRIMARY KEY NOT NULL,               -- UUID version 7: sorts by time
    created_at_ms INTEGER NOT NULL,
    owner TEXT NOT NULL,                        -- the key that made it; '': it was made without a key
    name TEXT,
    kind TEXT NOT NULL,                         -- of its jobs
    request TEXT NOT NULL,                      -- JSON, every option in effect
    jobs INTEGER NOT NULL                       -- how many there were at first
) STRICT;

CREATE INDEX batches_by_owner ON batches (owner, id);

-- The jobs that there were at first: a row stays when its job is deleted.
CREATE TABLE batch_members (
    batch_id TEXT NOT NULL REFERENCES batches (id) ON DELETE CASCADE,
    job_id TEXT NOT NULL,                       -- sorts in the order of the request
    measurement_id TEXT NOT NULL,
    file TEXT,                                  -- name of the first file of the measurement
    PRIMARY KEY (batch_id, job_id)
) STRICT, WITHOUT ROWID;

ALTER TABLE jobs ADD COLUMN batch_id TEXT REFERENCES batches (id);

-- What stands out of a result, for tables of many; NULL for results of an earlier version.
ALTER TABLE jobs ADD COLUMN verdict TEXT;
ALTER TABLE jobs ADD COLUMN cause TEXT;         -- the strongest
ALTER TABLE jobs ADD COLUMN confidence REAL;    -- in that cause

-- Has everything that is counted of a batch: the rows themselves, with their results, are not read.
CREATE INDEX jobs_by_batch ON jobs (batch_id, status, verdict, cause, started_at_ms, finished_at_ms)
    WHERE batch_id IS NOT NULL;
