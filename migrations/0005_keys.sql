-- Who may do what, and whose a row is.

-- Of a key only its digest is kept.
CREATE TABLE keys (
    id TEXT PRIMARY KEY NOT NULL,               -- the part of the key by which it is found
    name TEXT NOT NULL,                         -- for people
    scopes TEXT NOT NULL,                       -- JSON array of names
    sha256 TEXT NOT NULL,                       -- hexadecimal, of the whole key
    created_at_ms INTEGER NOT NULL,
    expires_at_ms INTEGER,                      -- NULL: never
    revoked_at_ms INTEGER,
    used_at_ms INTEGER                          -- the last time, to the minute
) STRICT;

-- Browsers that are signed in with a key.
CREATE TABLE sessions (
    sha256 TEXT PRIMARY KEY NOT NULL,           -- hexadecimal, of what the cookie holds
    key_id TEXT NOT NULL REFERENCES keys (id) ON DELETE CASCADE,
    expires_at_ms INTEGER NOT NULL
) STRICT;

CREATE INDEX sessions_by_key ON sessions (key_id);

-- The owner of a row is the key that made it; '': it was made without a key.
ALTER TABLE measurements ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE webhooks ADD COLUMN owner TEXT NOT NULL DEFAULT '';

CREATE INDEX measurements_by_owner ON measurements (owner, id);
CREATE INDEX jobs_by_owner ON jobs (owner, id);

-- Each owner has names and idempotency keys of its own.
CREATE TABLE owned_mappings (
    owner TEXT NOT NULL,
    name TEXT NOT NULL,
    settings TEXT NOT NULL,                     -- JSON object of strings
    layout TEXT,                                -- of the files it is for, if they have column names
    updated_at_ms INTEGER NOT NULL,
    PRIMARY KEY (owner, name)
) STRICT;

INSERT INTO owned_mappings (owner, name, settings, layout, updated_at_ms)
    SELECT '', name, settings, layout, updated_at_ms FROM mappings;
DROP TABLE mappings;
ALTER TABLE owned_mappings RENAME TO mappings;
CREATE INDEX mappings_by_layout ON mappings (layout, updated_at_ms) WHERE layout IS NOT NULL;

CREATE TABLE owned_idempotency_keys (
    owner TEXT NOT NULL,
    scope TEXT NOT NULL,                        -- what the request creates
    key TEXT NOT NULL,
    body_sha256 TEXT NOT NULL,
    resource_id TEXT NOT NULL,
    created_at_ms INTEGER NOT NULL,
    PRIMARY KEY (owner, scope, key)
) STRICT;

INSERT INTO owned_idempotency_keys (owner, scope, key, body_sha256, resource_id, created_at_ms)
    SELECT '', scope, key, body_sha256, resource_id, created_at_ms FROM idempotency_keys;
DROP TABLE idempotency_keys;
ALTER TABLE owned_idempotency_keys RENAME TO idempotency_keys;
CREATE INDEX idempotency_keys_by_resource ON idempotency_keys (resource_id);
