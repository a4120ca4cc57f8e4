-- The ledger, version 1: one schema for SQLite and PostgreSQL. Times are milliseconds since 1970
-- by the ledger's clock, digests and ids hexadecimal text, truth 0 or 1. This file is never
-- changed once released: a change is a migration that follows it.

CREATE TABLE ledger (
    schema_version BIGINT NOT NULL
);

-- Who uses the workers, and how much: microseconds of CPU that were used or are in use.
CREATE TABLE tenants (
    tenant TEXT PRIMARY KEY NOT NULL,
    virtual_time BIGINT NOT NULL
);

CREATE TABLE jobs (
    job TEXT PRIMARY KEY NOT NULL,
    number BIGINT NOT NULL UNIQUE,
    request TEXT NOT NULL UNIQUE,
    tenant TEXT NOT NULL,
    label TEXT NOT NULL,
    problem TEXT NOT NULL,
    options TEXT NOT NULL,
    numerics_revision BIGINT NOT NULL,
    state TEXT NOT NULL,
    reason TEXT,
    submitted BIGINT NOT NULL,
    started BIGINT,
    ended BIGINT,
    steward TEXT,
    steward_epoch BIGINT NOT NULL,
    steward_until BIGINT NOT NULL,
    snapshot TEXT,
    solutions TEXT,
    summary TEXT,
    virtual_time BIGINT NOT NULL,
    leased_chunks BIGINT NOT NULL
);
CREATE INDEX jobs_unfinished ON jobs (number) WHERE ended IS NULL;

-- The counts are those of the stage's chunks, kept in the same transactions.
CREATE TABLE stages (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    definition TEXT NOT NULL,
    items BIGINT NOT NULL,
    closed BIGINT NOT NULL,
    ready_items BIGINT NOT NULL,
    ready_chunks BIGINT NOT NULL,
    leased_items BIGINT NOT NULL,
    leased_chunks BIGINT NOT NULL,
    accepted_items BIGINT NOT NULL,
    accepted_chunks BIGINT NOT NULL,
    failed_items BIGINT NOT NULL,
    failed_chunks BIGINT NOT NULL,
    cpu_micros BIGINT NOT NULL,
    paths_regular BIGINT NOT NULL,
    paths_singular BIGINT NOT NULL,
    paths_failed BIGINT NOT NULL,
    PRIMARY KEY (job, stage)
);

-- A chunk is the items first..last of a stage. Ready, leased, accepted or failed.
CREATE TABLE chunks (
    job TEXT NOT NULL,
    stage BIGINT NOT NULL,
    first BIGINT NOT NULL,
    last BIGINT NOT NULL,
    state TEXT NOT NULL,
    epoch BIGINT NOT NULL,
    suspicions BIGINT NOT NULL,
    alone BIGINT NOT NULL,
    worker TEXT,
    lease_until BIGINT,
    request TEXT,
    charged BIGINT NOT NULL,
    address TEXT,
    hash TEXT,
    cpu_micros BIGINT,
    paths_regular BIGINT,
    paths_singular BIGINT,
    paths_failed BIGINT,
    PRIMARY KEY (job, stage, first)
);
CREATE INDEX chunks_ready ON chunks (job, stage, first) WHERE state = 'ready';
CREATE INDEX chunks_leased ON chunks (worker, lease_until) WHERE state = 'leased';

CREATE TABLE workers (
    worker TEXT PRIMARY KEY NOT NULL,
    version TEXT NOT NULL,
    numerics_revision BIGINT NOT NULL,
    instruction_set TEXT NOT NULL,
    threads BIGINT NOT NULL,
    lane_width BIGINT NOT NULL,
    host TEXT NOT NULL,
    transport TEXT NOT NULL,
    draining BIGINT NOT NULL,
    first_seen BIGINT NOT NULL,
    last_seen BIGINT NOT NULL,
    items_done BIGINT NOT NULL,
    chunks_done BIGINT NOT NULL
);
CREATE INDEX workers_seen ON workers (last_seen);
