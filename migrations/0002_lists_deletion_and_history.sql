-- What lists are filtered by and what is deleted together.

CREATE INDEX jobs_by_measurement ON jobs (measurement_id, id);
CREATE INDEX jobs_by_end ON jobs (finished_at_ms) WHERE finished_at_ms IS NOT NULL;
CREATE INDEX measurements_by_machine ON measurements (machine, axis, id);
CREATE INDEX measurements_by_age ON measurements (created_at_ms);
CREATE INDEX idempotency_keys_by_resource ON idempotency_keys (resource_id);

-- One row that is written to learn whether the file can be written.
CREATE TABLE probe (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    at_ms INTEGER NOT NULL
) STRICT;
