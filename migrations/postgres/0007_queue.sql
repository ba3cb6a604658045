-- Ended jobs are most of all jobs, and taking the next one is asked for all the time: it must not pass
-- over what is left of them. So what has not ended has a table of its own, which follows `jobs` in the
-- transaction that changes a job, whatever version of the program changes it. `jobs` decides, and is
-- always locked first: a row here is only written by whoever holds that of the job.

-- A process of the version before goes on without these, and sorts what waits by `jobs_by_status`. They
-- go first: with the lock that this takes, nobody reads the jobs now and writes them later.
DROP INDEX jobs_by_turn, jobs_by_submitter, jobs_by_priority, jobs_in_hand, jobs_alone;

-- Rows come and go: half a page is left for the next version of a row. Empty pages are kept, for a plan
-- that was made for a table without any reads all of it, however many jobs come next.
CREATE TABLE queue (
    job_id TEXT COLLATE "C" PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE,
    submitter TEXT COLLATE "C" NOT NULL,
    turn BIGINT NOT NULL,
    priority BIGINT NOT NULL,
    created_at_ms BIGINT NOT NULL,
    due_ms BIGINT NOT NULL,
    shared BIGINT NOT NULL,
    running BOOLEAN NOT NULL,                   -- or it waits
    worker TEXT COLLATE "C",
    started_at_ms BIGINT
) WITH (fillfactor = 50, vacuum_truncate = FALSE,
        autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 500);

CREATE INDEX queue_by_turn ON queue (turn, job_id) WHERE NOT running;
CREATE INDEX queue_by_submitter ON queue (submitter, turn) WHERE NOT running;
CREATE INDEX queue_in_hand ON queue (worker) WHERE running;

-- Asked for whenever a job is taken, and mostly hold none. The others have an entry for every job that
-- ran since the oldest transaction began, and would be preferred at times: the conditions are written
-- so that only these answer them.
CREATE INDEX queue_by_priority ON queue (submitter, priority DESC, created_at_ms, job_id)
    WHERE running::integer = 0;
CREATE INDEX queue_alone ON queue (worker) WHERE running::integer = 1 AND shared >= 3;

CREATE FUNCTION queue_follows() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF NEW.status IN ('queued', 'running') THEN
        INSERT INTO queue (job_id, submitter, turn, priority, created_at_ms, due_ms, shared, running,
                           worker, started_at_ms)
        VALUES (NEW.id, NEW.submitter, NEW.turn, NEW.priority, NEW.created_at_ms, NEW.due_ms,
                NEW.shared, NEW.status = 'running', NEW.worker, NEW.started_at_ms)
        ON CONFLICT (job_id) DO UPDATE
        SET turn = excluded.turn, priority = excluded.priority, due_ms = excluded.due_ms,
            shared = excluded.shared, running = excluded.running, worker = excluded.worker,
            started_at_ms = excluded.started_at_ms;
    ELSE
        DELETE FROM queue WHERE job_id = NEW.id;
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER queue_begins AFTER INSERT ON jobs
    FOR EACH ROW
    WHEN (NEW.status IN ('queued', 'running'))
    EXECUTE FUNCTION queue_follows();

-- Heartbeats change none of these.
CREATE TRIGGER queue_follows
    AFTER UPDATE OF status, turn, priority, due_ms, shared, worker, started_at_ms ON jobs
    FOR EACH ROW
    WHEN ((OLD.status, OLD.turn, OLD.priority, OLD.due_ms, OLD.shared, OLD.worker, OLD.started_at_ms)
          IS DISTINCT FROM
          (NEW.status, NEW.turn, NEW.priority, NEW.due_ms, NEW.shared, NEW.worker, NEW.started_at_ms))
    EXECUTE FUNCTION queue_follows();

INSERT INTO queue (job_id, submitter, turn, priority, created_at_ms, due_ms, shared, running, worker,
                   started_at_ms)
    SELECT id, submitter, turn, priority, created_at_ms, due_ms, shared, status = 'running', worker,
           started_at_ms
    FROM jobs WHERE status IN ('queued', 'running');

-- Until when a lease is good. While the database is away nobody can renew one: what was given before it
-- started is good for its whole length once more.
CREATE FUNCTION lease_ends_ms(lease_until_ms BIGINT, renewed_at_ms BIGINT) RETURNS BIGINT
    LANGUAGE sql STABLE
    RETURN greatest(lease_until_ms,
                    floor(extract(epoch FROM pg_postmaster_start_time()) * 1000)::bigint
                    + lease_until_ms - renewed_at_ms);
