-- Version 3: speculation. The last chunks of a stage may be given to a second worker; the chunk's row
-- is then the second one's, and the lease before it stands here: it may still report first.

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

-- When the last lease began; NULL: never, or before this version.
ALTER TABLE chunks ADD COLUMN leased_at BIGINT;
-- How long the accepted chunks were with the workers that reported them, in milliseconds; how many
-- were given to a second worker, and how many of these it reported first.
ALTER TABLE stages ADD COLUMN held_ms BIGINT NOT NULL DEFAULT 0;
ALTER TABLE stages ADD COLUMN speculative_leases BIGINT NOT NULL DEFAULT 0;
ALTER TABLE stages ADD COLUMN speculative_won BIGINT NOT NULL DEFAULT 0;
