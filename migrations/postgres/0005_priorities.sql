-- 0, 2 and 4: low, normal, high. One more: it gave its turn to a job of the same submitter, and goes
-- before its equals.
ALTER TABLE jobs ADD COLUMN priority BIGINT NOT NULL DEFAULT 2;

-- Asked for whenever a job is taken, and mostly holds none. An index on the queued ones of a submitter
-- would be preferred at times, and has an entry for every job that ran since the oldest transaction
-- began: the condition is written so that only this one answers it.
CREATE INDEX jobs_by_priority ON jobs (submitter, priority DESC, created_at_ms, id)
    WHERE status || '' = 'queued';
