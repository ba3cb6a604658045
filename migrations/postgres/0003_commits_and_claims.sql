-- A transaction that notifies holds a lock of the whole cluster until it is on the disk, so that no
-- two of them are written together. Processes say what they did once it is committed instead.
DROP TRIGGER history_grows ON convergence;
DROP FUNCTION history_grows;
DROP TRIGGER job_is_new ON jobs;
DROP TRIGGER job_is_deleted ON jobs;
DROP TRIGGER job_changes ON jobs;
DROP FUNCTION job_changes;

-- None of the ways in which a job ends can do so without an event.
CREATE FUNCTION job_ends() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    INSERT INTO events (job_id, at_ms) VALUES (NEW.id, NEW.finished_at_ms);
    RETURN NULL;
END
$$;

CREATE TRIGGER job_ends AFTER UPDATE OF status ON jobs
    FOR EACH ROW
    WHEN (OLD.status IN ('queued', 'running')
          AND NEW.status IN ('succeeded', 'failed', 'cancelled'))
    EXECUTE FUNCTION job_ends();

-- Asked for whenever a job is taken. An index on the status would be preferred for its order, and has
-- an entry for every job that ran since the oldest transaction began.
DROP INDEX jobs_alone;
CREATE INDEX jobs_alone ON jobs (worker) WHERE status || '' = 'running' AND shared >= 2;
