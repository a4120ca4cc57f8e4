-- Version 3: speculation. The last chunks of a stage may be given to a second worker. The chunk's row
-- then holds the second lease. This table holds the first, which may still report first.

CREATE TABLE elders (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    first BIGINT NOT NULL,
    epoch BIGINT NOT NULL,
    worker TEXT NOT NULL,
    leased_at BIGINT NOT NULL,
    -- NULL once the chunk is accepted.
    lease_until BIGINT,
    PRIMARY KEY (job, stage, first)
);
CREATE INDEX elders_leased ON elders (lease_until) WHERE lease_until IS NOT NULL;

-- Time at which the last lease began. NULL: no lease, or a lease before this version.
ALTER TABLE chunks ADD COLUMN leased_at BIGINT;
-- Time from lease to report, summed over the accepted chunks, in milliseconds; number of chunks that a
-- second worker got; number of these that it reported first.
ALTER TABLE stages ADD COLUMN held_ms BIGINT NOT NULL DEFAULT 0;
ALTER TABLE stages ADD COLUMN speculative_leases BIGINT NOT NULL DEFAULT 0;
ALTER TABLE stages ADD COLUMN speculative_won BIGINT NOT NULL DEFAULT 0;
