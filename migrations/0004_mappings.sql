-- What is given beside files of one layout, under a name.
CREATE TABLE mappings (
    name TEXT PRIMARY KEY NOT NULL,
    settings TEXT NOT NULL,                     -- JSON object of strings
    layout TEXT,                                -- of the files it is for, if they have column names
    updated_at_ms INTEGER NOT NULL
) STRICT;

CREATE INDEX mappings_by_layout ON mappings (layout, updated_at_ms) WHERE layout IS NOT NULL;

-- What input and response are, as JSON; NULL for measurements stored before this column.
ALTER TABLE measurements ADD COLUMN quantities TEXT;
