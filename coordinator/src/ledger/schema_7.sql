-- Version 7: the secret by which chunks are drawn that are done twice. It is made with the ledger, and leaves it for
-- no message; whoever reads the ledger knows it.

ALTER TABLE ledger ADD COLUMN audit_secret TEXT;
