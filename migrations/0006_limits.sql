-- Which process holds a lease, and when it was last heard of.
ALTER TABLE jobs ADD COLUMN worker TEXT;
ALTER TABLE jobs ADD COLUMN renewed_at_ms INTEGER;

-- What speaks against a job whose lease expired: see the documentation of the store.
ALTER TABLE jobs ADD COLUMN charged INTEGER NOT NULL DEFAULT 0; -- alone, or while others went on
ALTER TABLE jobs ADD COLUMN shared INTEGER NOT NULL DEFAULT 0;  -- together with all others in hand
ALTER TABLE jobs ADD COLUMN due_ms INTEGER NOT NULL DEFAULT 0;  -- not leased before

-- Who queued it, and after which jobs of others it is due.
ALTER TABLE jobs ADD COLUMN submitter TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN turn INTEGER NOT NULL DEFAULT 0;

CREATE INDEX jobs_by_turn ON jobs (status, turn, id);
CREATE INDEX jobs_by_submitter ON jobs (submitter, turn) WHERE status = 'queued';

-- What computing with a measurement is estimated to take; NULL for those stored before.
ALTER TABLE measurements ADD COLUMN simulation_s REAL;
ALTER TABLE measurements ADD COLUMN diagnosis_s REAL;
