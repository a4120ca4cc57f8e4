-- Version 4: the accusers of a chunk. Several failures of one worker may be the worker's fault. A chunk's
-- suspicions count different workers, as long as another worker could do the chunk.

CREATE TABLE accusations (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    first BIGINT NOT NULL,
    worker TEXT NOT NULL,
    times BIGINT NOT NULL,
    PRIMARY KEY (job, stage, first, worker)
);
