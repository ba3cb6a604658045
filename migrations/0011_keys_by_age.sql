-- Keys that nobody repeats any more are looked for with every hundred rows that retention removes.
CREATE INDEX idempotency_keys_by_age ON idempotency_keys (created_at_ms);
