//! Caller: who calls, as the listener found out before the call came in.
//!
//! A listener's guard puts it beside each request; services ask it whose jobs it may see and what it may use.

use crate::ledger::identity::{Credential, Tenant};
use cognate_worker::transport::tokens::Limits;
use tonic::Request;

/// Who calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caller {
    /// By what it is known, the same for all names that it gives itself.
    pub credential: Credential,
    /// What the operator calls it; its credential where he gave it no name.
    pub name: String,
    /// The tenant whose jobs it is for; `None`: those of all.
    pub tenant: Option<Tenant>,
    /// What it may have at once.
    pub limits: Limits,
    /// Address that it calls from, or the way by which it came.
    pub peer: String,
    /// Whether it may look only.
    pub reads_only: bool,
}

impl Caller {
    /// Somebody who was let in without a token: by this way, known by this credential.
    pub fn untold(credential: &str, peer: impl Into<String>) -> Self {
        Self {
            credential: Credential(credential.to_owned()),
            name: credential.to_owned(),
            tenant: None,
            limits: Limits::default(),
            peer: peer.into(),
            reads_only: false,
        }
    }

    /// Who sent this request. What comes without a guard's word comes from this machine's user: by shared memory,
    /// or from within the process.
    pub fn of<T>(request: &Request<T>) -> Self {
        let told = request.extensions().get::<Self>();
        told.cloned()
            .unwrap_or_else(|| Self::untold("local", "this host"))
    }

    /// Whether the jobs of a tenant are this caller's business.
    pub fn may_see(&self, tenant: &Tenant) -> bool {
        self.tenant
            .as_ref()
            .is_none_or(|caller_tenant| caller_tenant == tenant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenant_sees_its_own_and_others_see_all() {
        let tenant = |name: &str| Tenant::new(name).unwrap();
        let operator = Caller::untold("local", "here");
        let bound = Caller {
            tenant: Some(tenant("a")),
            ..operator.clone()
        };
        assert!(operator.may_see(&tenant("a")) && operator.may_see(&tenant("b")));
        assert!(bound.may_see(&tenant("a")) && !bound.may_see(&tenant("b")));
        assert_eq!(Caller::of(&Request::new(())).name, "local");
    }
}
