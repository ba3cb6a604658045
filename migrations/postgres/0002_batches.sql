-- Many jobs that are made, watched and cancelled together.
CREATE TABLE batches (
    id TEXT COLLATE "C" PRIMARY KEY,            -- UUID version 7: sorts by time
    created_at_ms BIGINT NOT NULL,
    owner TEXT COLLATE "C" NOT NULL,            -- the key that made it; '': it was made without a key
    name TEXT,
    kind TEXT COLLATE "C" NOT NULL,             -- of its jobs
    request TEXT NOT NULL,                      -- JSON, every option in effect
    jobs BIGINT NOT NULL                        -- how many there were at first
);

CREATE INDEX batches_by_owner ON batches (owner, id);

-- The jobs that there were at first: a row stays when its job is deleted.
CREATE TABLE batch_members (
    batch_id TEXT COLLATE "C" NOT NULL REFERENCES batches (id) ON DELETE CASCADE,
    job_id TEXT COLLATE "C" NOT NULL,           -- sorts in the order of the request
    measurement_id TEXT COLLATE "C" NOT NULL,
    file TEXT,                                  -- name of the first file of the measurement
    PRIMARY KEY (batch_id, job_id)
);

ALTER TABLE jobs ADD COLUMN batch_id TEXT COLLATE "C" REFERENCES batches (id);

-- What stands out of a result, for tables of many; NULL for results of an earlier version.
ALTER TABLE jobs ADD COLUMN verdict TEXT COLLATE "C";
ALTER TABLE jobs ADD COLUMN cause TEXT COLLATE "C";     -- the strongest
ALTER TABLE jobs ADD COLUMN confidence DOUBLE PRECISION; -- in that cause

-- Has everything that is counted of a batch: the rows themselves, with their results, are not read.
CREATE INDEX jobs_by_batch ON jobs (batch_id, status, verdict, cause, started_at_ms, finished_at_ms)
    WHERE batch_id IS NOT NULL;
