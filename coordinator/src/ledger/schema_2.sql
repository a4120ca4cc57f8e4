-- Version 2: audits. An audited chunk is accepted when two executions agree. Until then the chunk is
-- ready again after each execution. `votes` stores each result's hash. An outvoted worker is evicted.

CREATE TABLE votes (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    first BIGINT NOT NULL,
    epoch BIGINT NOT NULL,
    worker TEXT NOT NULL,
    hash TEXT NOT NULL,
    PRIMARY KEY (job, stage, first, epoch)
);

-- Number of the chunk's votes.
ALTER TABLE chunks ADD COLUMN votes BIGINT NOT NULL DEFAULT 0;
ALTER TABLE workers ADD COLUMN evicted BIGINT NOT NULL DEFAULT 0;

-- Ready chunks of silent workers, by the worker's request. They are few among the ready chunks.
CREATE INDEX chunks_silent ON chunks (request) WHERE state = 'ready' AND request IS NOT NULL;
