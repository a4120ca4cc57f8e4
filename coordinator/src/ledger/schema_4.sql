-- Version 4: who accuses a chunk. Several failures of one worker say something about the worker;
-- suspicions of a chunk are those of different workers, while there are others that could do it.

CREATE TABLE accusations (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    first BIGINT NOT NULL,
    worker TEXT NOT NULL,
    times BIGINT NOT NULL,
    PRIMARY KEY (job, stage, first, worker)
);
