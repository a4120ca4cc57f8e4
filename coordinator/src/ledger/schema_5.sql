-- Version 5: jobs can be deleted. A deleted job's id is never used again: what its objects were named
-- after stays unique, and a submission that is sent again makes no second job.

CREATE TABLE deleted_jobs (
    job TEXT PRIMARY KEY NOT NULL,
    deleted BIGINT NOT NULL
);

-- Name of the ledger, made with it: a folder of results belongs to one ledger, and nothing is removed
-- from that of another.
ALTER TABLE ledger ADD COLUMN identity TEXT;
