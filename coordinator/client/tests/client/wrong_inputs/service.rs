//! Wrong words to the service. Each is one mistake, with words of its refusal.

use super::mistake::Mistake;

pub const MISTAKES: &[Mistake] = &[
    (
        "cognate submit system.txt --coordinator nowhere",
        &["--coordinator", "`nowhere`", "http://host:port"],
        "--coordinator URL",
    ),
    (
        "cognate worker --coordinator h:1 --lane-width 3",
        &["--lane-width", "1, 8 or 16"],
        "--lane-width W",
    ),
    (
        "cognate worker",
        &["--coordinator"],
        "cognate worker --coordinator http://head:7654",
    ),
    (
        "cognate coordinator --ledger redis:x",
        &["--ledger", "`redis:x`", "sqlite:PATH"],
        "cognate coordinator",
    ),
    (
        "cognate coordinator --listen 0.0.0.0:0",
        &["--listen", "--token-file", "--insecure"],
        "cognate coordinator",
    ),
    (
        "cognate jobs --token-file missing",
        &["missing"],
        "cognate jobs --token-file FILE",
    ),
    (
        "cognate submit system.txt --loops 3",
        &["--loops", "--decompose"],
        "cognate submit",
    ),
    (
        "cognate submit system.txt --minimize x",
        &["'--minimize'"],
        "cognate submit",
    ),
    ("cognate watch", &["<JOB>"], "cognate watch JOB"),
    (
        "cognate fsck --ledger sqlite:none.db",
        &["--ledger", "none.db"],
        "--ledger sqlite:jobs.db",
    ),
    (
        "cognate backup set",
        &["--ledger", "cognate-data/ledger.db"],
        "--ledger sqlite:jobs.db",
    ),
];
