-- Version 6: credentials. A worker chooses its name freely. Audits tell workers apart by their token or
-- certificate. Empty: the row is older than this version.

ALTER TABLE workers ADD COLUMN credential TEXT NOT NULL DEFAULT '';
ALTER TABLE votes ADD COLUMN credential TEXT NOT NULL DEFAULT '';

-- Chunks for which workers reported different results. They are few. The coordinator decides about them.
CREATE INDEX chunks_disputed ON chunks (job, stage, first) WHERE state = 'ready' AND votes >= 2;
