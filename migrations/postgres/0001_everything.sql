-- Times are milliseconds since 1970-01-01 UTC by the database's clock, so that
-- leases do not depend on the clocks of the processes that share the database.
CREATE VIEW clock AS
    SELECT floor(extract(epoch FROM clock_timestamp()) * 1000)::bigint AS now_ms;

CREATE TABLE measurements (
    id TEXT COLLATE "C" PRIMARY KEY,            -- UUID version 7: sorts by time
    created_at_ms BIGINT NOT NULL,
    owner TEXT COLLATE "C" NOT NULL,            -- the key that made it; '': it was made without a key
    name TEXT COLLATE "C",
    machine TEXT COLLATE "C",
    axis TEXT COLLATE "C",
    operator TEXT COLLATE "C",
    measured_at TEXT COLLATE "C",               -- RFC 3339, as the upload says it
    measured_at_ms BIGINT,                      -- the same
    labels TEXT COLLATE "C" NOT NULL,           -- JSON object of strings
    sha256 TEXT COLLATE "C" NOT NULL,
    experiments BIGINT NOT NULL,
    highest_harmonic BIGINT NOT NULL,
    magnitude_min DOUBLE PRECISION NOT NULL,
    magnitude_max DOUBLE PRECISION NOT NULL,
    omega_min_rad_s DOUBLE PRECISION NOT NULL,
    omega_max_rad_s DOUBLE PRECISION NOT NULL,
    notes TEXT NOT NULL,                        -- JSON array of the reader's remarks
    quantities TEXT,                            -- JSON of what input and response are
    simulation_s DOUBLE PRECISION,              -- what computing with it is estimated to take
    diagnosis_s DOUBLE PRECISION
);

CREATE INDEX measurements_by_owner ON measurements (owner, id);
CREATE INDEX measurements_by_age ON measurements (created_at_ms);
CREATE INDEX measurements_by_machine ON measurements (machine, axis, id);

-- The bytes as they came: reading them again gives the same measurement.
CREATE TABLE measurement_files (
    measurement_id TEXT COLLATE "C" NOT NULL REFERENCES measurements (id) ON DELETE CASCADE,
    position BIGINT NOT NULL,
    name TEXT COLLATE "C" NOT NULL,
    content_type TEXT COLLATE "C" NOT NULL,
    bytes BYTEA NOT NULL,
    PRIMARY KEY (measurement_id, position)
);

-- Heartbeats write no column that is indexed: with room on its page a row stays where it is.
CREATE TABLE jobs (
    id TEXT COLLATE "C" PRIMARY KEY,            -- UUID version 7: sorts by time
    measurement_id TEXT COLLATE "C" NOT NULL REFERENCES measurements (id),
    owner TEXT COLLATE "C" NOT NULL,            -- the key that made it; '': it was made without a key
    submitter TEXT COLLATE "C" NOT NULL,        -- submitters take turns
    turn BIGINT NOT NULL,
    kind TEXT COLLATE "C" NOT NULL,
    request TEXT NOT NULL,                      -- JSON, every option in effect
    status TEXT COLLATE "C" NOT NULL
        CHECK (status IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
    progress TEXT,                              -- JSON
    attempt BIGINT NOT NULL DEFAULT 0,          -- leases so far; every write names its own
    handed_back BIGINT NOT NULL DEFAULT 0,      -- leases returned in good order
    charged BIGINT NOT NULL DEFAULT 0,          -- leases lost alone, or while others went on
    shared BIGINT NOT NULL DEFAULT 0,           -- leases lost together with all others in hand
    due_ms BIGINT NOT NULL DEFAULT 0,           -- not leased before
    worker TEXT COLLATE "C",                    -- the process that holds the lease
    lease_until_ms BIGINT,
    renewed_at_ms BIGINT,
    cancel_requested BOOLEAN NOT NULL DEFAULT FALSE,
    created_at_ms BIGINT NOT NULL,
    started_at_ms BIGINT,
    finished_at_ms BIGINT,
    failure TEXT,                               -- JSON, why it failed
    result TEXT                                 -- JSON, the answer
) WITH (fillfactor = 80, autovacuum_vacuum_scale_factor = 0.02, autovacuum_vacuum_threshold = 200);

-- Where the next job is looked for. While any transaction is held open, entries of the index stay
-- behind for every job that was taken since, and would all be passed over; a sequence has none.
CREATE SEQUENCE lowest_turn MINVALUE 0 START 0;

CREATE INDEX jobs_by_turn ON jobs (turn, id) WHERE status = 'queued';
CREATE INDEX jobs_by_submitter ON jobs (submitter, turn) WHERE status = 'queued';
CREATE INDEX jobs_in_hand ON jobs (worker) WHERE status = 'running';
CREATE INDEX jobs_alone ON jobs (worker) WHERE status = 'running' AND shared >= 2;
CREATE INDEX jobs_by_status ON jobs (status, id);
CREATE INDEX jobs_by_measurement ON jobs (measurement_id, id);
CREATE INDEX jobs_by_owner ON jobs (owner, id);
CREATE INDEX jobs_by_end ON jobs (finished_at_ms) WHERE finished_at_ms IS NOT NULL;

CREATE TABLE convergence (
    job_id TEXT COLLATE "C" NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    attempt BIGINT NOT NULL,
    seq BIGINT NOT NULL,
    stage TEXT NOT NULL,
    cycle BIGINT NOT NULL,
    evaluations BIGINT NOT NULL,
    best DOUBLE PRECISION NOT NULL,
    mean DOUBLE PRECISION,
    elapsed_s DOUBLE PRECISION NOT NULL,
    PRIMARY KEY (job_id, attempt, seq)
);

CREATE TABLE idempotency_keys (
    owner TEXT COLLATE "C" NOT NULL,
    scope TEXT COLLATE "C" NOT NULL,            -- what the request creates
    key TEXT COLLATE "C" NOT NULL,
    body_sha256 TEXT COLLATE "C" NOT NULL,
    resource_id TEXT COLLATE "C" NOT NULL,
    created_at_ms BIGINT NOT NULL,
    PRIMARY KEY (owner, scope, key)
);

CREATE INDEX idempotency_keys_by_resource ON idempotency_keys (resource_id);
CREATE INDEX idempotency_keys_by_age ON idempotency_keys (created_at_ms);

-- One row that is written to learn whether the database can be written.
CREATE TABLE probe (
    id BIGINT PRIMARY KEY CHECK (id = 1),
    at_ms BIGINT NOT NULL
);

-- What is given beside files of one layout, under a name.
CREATE TABLE mappings (
    owner TEXT COLLATE "C" NOT NULL,
    name TEXT COLLATE "C" NOT NULL,
    settings TEXT NOT NULL,                     -- JSON object of strings
    layout TEXT COLLATE "C",                    -- of the files it is for, if they have column names
    updated_at_ms BIGINT NOT NULL,
    PRIMARY KEY (owner, name)
);

-- Of a key only its digest is kept.
CREATE TABLE keys (
    id TEXT COLLATE "C" PRIMARY KEY,            -- the part of the key by which it is found
    name TEXT NOT NULL,                         -- for people
    scopes TEXT NOT NULL,                       -- JSON array of names
    sha256 TEXT NOT NULL,                       -- hexadecimal, of the whole key
    created_at_ms BIGINT NOT NULL,
    expires_at_ms BIGINT,                       -- NULL: never
    revoked_at_ms BIGINT,
    used_at_ms BIGINT                           -- the last time, to the minute
);

-- Browsers that are signed in with a key.
CREATE TABLE sessions (
    sha256 TEXT COLLATE "C" PRIMARY KEY,        -- hexadecimal, of what the cookie holds
    key_id TEXT COLLATE "C" NOT NULL REFERENCES keys (id) ON DELETE CASCADE,
    expires_at_ms BIGINT NOT NULL
);

CREATE INDEX sessions_by_key ON sessions (key_id);

-- Whom to tell what has happened, and what is still to be told.
CREATE TABLE webhooks (
    id TEXT COLLATE "C" PRIMARY KEY,            -- UUID version 7: sorts by time
    created_at_ms BIGINT NOT NULL,
    owner TEXT COLLATE "C" NOT NULL,
    url TEXT NOT NULL,
    secret TEXT NOT NULL,                       -- whsec_…, needed for every signature
    events TEXT NOT NULL,                       -- JSON array of the types it is told
    disabled TEXT                               -- why it is told nothing more
);

-- Ends of jobs that nobody has been told of.
CREATE TABLE events (
    id BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    job_id TEXT COLLATE "C" NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    at_ms BIGINT NOT NULL
);

CREATE INDEX events_by_job ON events (job_id);

-- One message to one receiver.
CREATE TABLE deliveries (
    id TEXT COLLATE "C" PRIMARY KEY,            -- msg_ and a UUID version 7: sorts by time
    webhook_id TEXT COLLATE "C" REFERENCES webhooks (id) ON DELETE CASCADE, -- NULL: the broker
    event TEXT NOT NULL,                        -- its type
    topic TEXT NOT NULL,                        -- for the broker
    body TEXT NOT NULL,                         -- JSON, the same at every attempt
    status TEXT COLLATE "C" NOT NULL CHECK (status IN ('waiting', 'delivered', 'given_up')),
    attempts BIGINT NOT NULL DEFAULT 0,         -- so far; every outcome names its own
    created_at_ms BIGINT NOT NULL,
    due_ms BIGINT NOT NULL,                     -- when it is tried next
    lease_until_ms BIGINT,                      -- it is being tried
    ended_at_ms BIGINT,
    answered BIGINT,                            -- status of the latest answer
    error TEXT                                  -- why the latest attempt failed
);

CREATE INDEX deliveries_waiting ON deliveries (due_ms) WHERE status = 'waiting';
CREATE INDEX deliveries_by_webhook ON deliveries (webhook_id, id);
CREATE INDEX deliveries_by_age ON deliveries (created_at_ms);

-- None of the ways in which a job ends can do so without an event, and none in which it changes
-- without word to the other processes: they hear of it once the transaction is committed.
CREATE FUNCTION job_changes() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF TG_OP = 'DELETE' THEN
        PERFORM pg_notify('servoscope', 'unwanted'), pg_notify('servoscope', 'ended');
    ELSIF NEW.status = 'queued' THEN
        PERFORM pg_notify('servoscope', 'queued');
    ELSIF NEW.status = 'running' THEN
        IF NEW.cancel_requested AND NOT OLD.cancel_requested THEN
            PERFORM pg_notify('servoscope', 'unwanted');
        END IF;
        PERFORM pg_notify('servoscope', 'changed');
    ELSE
        IF OLD.status IN ('queued', 'running') THEN
            INSERT INTO events (job_id, at_ms) VALUES (NEW.id, NEW.finished_at_ms);
        END IF;
        PERFORM pg_notify('servoscope', 'ended');
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER job_is_new AFTER INSERT ON jobs
    FOR EACH ROW EXECUTE FUNCTION job_changes();
CREATE TRIGGER job_is_deleted AFTER DELETE ON jobs
    FOR EACH ROW EXECUTE FUNCTION job_changes();
CREATE TRIGGER job_changes AFTER UPDATE ON jobs
    FOR EACH ROW
    WHEN (OLD.status <> NEW.status OR OLD.progress IS DISTINCT FROM NEW.progress
          OR OLD.cancel_requested <> NEW.cancel_requested)
    EXECUTE FUNCTION job_changes();

CREATE FUNCTION history_grows() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    PERFORM pg_notify('servoscope', 'changed');
    RETURN NULL;
END
$$;

CREATE TRIGGER history_grows AFTER INSERT ON convergence
    FOR EACH STATEMENT EXECUTE FUNCTION history_grows();
