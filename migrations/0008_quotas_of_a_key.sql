-- What a key may have, where it is not what the server gives every key: a JSON object.
ALTER TABLE keys ADD COLUMN quotas TEXT NOT NULL DEFAULT '{}';
