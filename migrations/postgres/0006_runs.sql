-- How long jobs of a key ran: a row for each lease that has ended, whatever became of the job. It stays
-- when the job is deleted, so that nobody computes more than a quota by deleting what was computed.
CREATE TABLE runs (
    job_id TEXT COLLATE "C" NOT NULL,
    attempt BIGINT NOT NULL,
    owner TEXT COLLATE "C" NOT NULL,            -- the key that made the job
    started_at_ms BIGINT NOT NULL,
    ended_at_ms BIGINT NOT NULL,                -- no later than its lease
    PRIMARY KEY (job_id, attempt)
);

CREATE INDEX runs_by_owner ON runs (owner, ended_at_ms);

-- A row is written, and two are removed that are older than seven days, longer than any quota looks
-- back: so there are never many more than of seven days. What another transaction removes at the same
-- time is passed over.
CREATE FUNCTION run_ends() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    INSERT INTO runs (job_id, attempt, owner, started_at_ms, ended_at_ms)
    SELECT OLD.id, OLD.attempt, OLD.owner, OLD.started_at_ms,
           greatest(OLD.started_at_ms, least(now_ms, OLD.lease_until_ms))
    FROM clock
    ON CONFLICT (job_id, attempt) DO NOTHING;
    DELETE FROM runs WHERE (job_id, attempt) IN (
        SELECT job_id, attempt FROM runs
        WHERE owner = OLD.owner AND ended_at_ms < (SELECT now_ms FROM clock) - 604800000
        ORDER BY ended_at_ms LIMIT 2 FOR UPDATE SKIP LOCKED);
    RETURN NULL;
END
$$;

CREATE TRIGGER run_ends AFTER UPDATE OF status ON jobs
    FOR EACH ROW
    WHEN (OLD.status = 'running' AND NEW.status <> 'running'
          AND OLD.owner <> '' AND OLD.started_at_ms IS NOT NULL)
    EXECUTE FUNCTION run_ends();

CREATE TRIGGER run_is_deleted AFTER DELETE ON jobs
    FOR EACH ROW
    WHEN (OLD.status = 'running' AND OLD.owner <> '' AND OLD.started_at_ms IS NOT NULL)
    EXECUTE FUNCTION run_ends();

INSERT INTO runs (job_id, attempt, owner, started_at_ms, ended_at_ms)
    SELECT id, attempt, owner, started_at_ms, finished_at_ms FROM jobs
    WHERE owner <> '' AND status IN ('succeeded', 'failed', 'cancelled')
      AND started_at_ms IS NOT NULL AND finished_at_ms >= started_at_ms;
