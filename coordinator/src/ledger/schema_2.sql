-- Version 2: audits. A chunk that is audited is accepted once two executions agree; until then it
-- is ready again after each, and this remembers what each found. A worker that was outvoted is evicted.

CREATE TABLE votes (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    first BIGINT NOT NULL,
    epoch BIGINT NOT NULL,
    worker TEXT NOT NULL,
    hash TEXT NOT NULL,
    PRIMARY KEY (job, stage, first, epoch)
);

-- How many of them there are.
ALTER TABLE chunks ADD COLUMN votes BIGINT NOT NULL DEFAULT 0;
ALTER TABLE workers ADD COLUMN evicted BIGINT NOT NULL DEFAULT 0;

-- Chunks whose worker fell silent, by its question: few among those that are ready.
CREATE INDEX chunks_silent ON chunks (request) WHERE state = 'ready' AND request IS NOT NULL;
