-- Version 5: jobs can be deleted. A deleted job's id is never used again. So the names of its objects
-- stay unique, and a submission that is sent twice makes no second job.

CREATE TABLE deleted_jobs (
    job TEXT PRIMARY KEY NOT NULL,
    deleted BIGINT NOT NULL
);

-- Name of the ledger, made with it. A folder of results belongs to one ledger. A ledger removes nothing
-- from the folder of another ledger.
ALTER TABLE ledger ADD COLUMN identity TEXT;
