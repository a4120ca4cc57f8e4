-- Version 6: credentials. Names of workers are free; what tells them apart at audits is the token or the
-- certificate that they came with. Empty: from before this version.

ALTER TABLE workers ADD COLUMN credential TEXT NOT NULL DEFAULT '';
ALTER TABLE votes ADD COLUMN credential TEXT NOT NULL DEFAULT '';

-- Chunks for which workers found different things: few, and the coordinator decides about them.
CREATE INDEX chunks_disputed ON chunks (job, stage, first) WHERE state = 'ready' AND votes >= 2;
