-- Version 7: the secret that selects the chunks for audits. It is made with the ledger. No message contains
-- it. Readers of the ledger can read the secret.

ALTER TABLE ledger ADD COLUMN audit_secret TEXT;
