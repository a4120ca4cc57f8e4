//! Expressions as text, in the notation that the Bertini-classic and our JSON format share.
