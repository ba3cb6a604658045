-- Whom to tell what has happened, and what is still to be told.

CREATE TABLE webhooks (
    id TEXT PRIMARY KEY NOT NULL,               -- UUID version 7: sorts by time
    created_at_ms INTEGER NOT NULL,
    url TEXT NOT NULL,
    secret TEXT NOT NULL,                       -- whsec_…, needed for every signature
    events TEXT NOT NULL,                       -- JSON array of the types it is told
    disabled TEXT                               -- why it is told nothing more
) STRICT;

-- Ends of jobs that nobody has been told of. A trigger writes them, so that none
-- of the ways in which a job ends can do so unnoticed.
CREATE TABLE events (
    id INTEGER PRIMARY KEY NOT NULL,
    job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    at_ms INTEGER NOT NULL
) STRICT;

CREATE INDEX events_by_job ON events (job_id);

CREATE TRIGGER job_ends AFTER UPDATE OF status ON jobs
WHEN OLD.status IN ('queued', 'running') AND NEW.status IN ('succeeded', 'failed', 'cancelled')
BEGIN
    INSERT INTO events (job_id, at_ms) VALUES (NEW.id, NEW.finished_at_ms);
END;

-- One message to one receiver.
CREATE TABLE deliveries (
    id TEXT PRIMARY KEY NOT NULL,               -- msg_ and a UUID version 7: sorts by time
    webhook_id TEXT REFERENCES webhooks (id) ON DELETE CASCADE, -- NULL: the broker
    event TEXT NOT NULL,                        -- its type
    topic TEXT NOT NULL,                        -- for the broker
    body TEXT NOT NULL,                         -- JSON, the same at every attempt
    status TEXT NOT NULL CHECK (status IN ('waiting', 'delivered', 'given_up')),
    attempts INTEGER NOT NULL DEFAULT 0,        -- so far; every outcome names its own
    created_at_ms INTEGER NOT NULL,
    due_ms INTEGER NOT NULL,                    -- when it is tried next
    lease_until_ms INTEGER,                     -- it is being tried
    ended_at_ms INTEGER,
    answered INTEGER,                           -- status of the latest answer
    error TEXT                                  -- why the latest attempt failed
) STRICT;

CREATE INDEX deliveries_waiting ON deliveries (due_ms) WHERE status = 'waiting';
CREATE INDEX deliveries_by_webhook ON deliveries (webhook_id, id);
CREATE INDEX deliveries_by_age ON deliveries (created_at_ms);
