-- 0, 2 and 4: low, normal, high. One more: it gave its turn to a job of the same submitter, and goes
-- before its equals.
ALTER TABLE jobs ADD COLUMN priority INTEGER NOT NULL DEFAULT 2;

CREATE INDEX jobs_by_priority ON jobs (submitter, priority DESC, created_at_ms, id)
    WHERE status = 'queued';
