//! Caller: the identity of a caller, as the listener found it out before the call came in.
//!
//! The guard of a listener adds the caller to each request. Services read from it the tenant and the limits.

use crate::ledger::identity::{Credential, Tenant};
use cognate_worker::transport::tokens::Limits;
use tonic::Request;

/// Identity, tenant and limits of a caller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caller {
    /// Credential of the caller, the same for all names that the caller gives itself.
    pub credential: Credential,
    /// Name that the operator gave to the caller; its credential where there is no name.
    pub name: String,
    /// Tenant whose jobs the caller may see; `None`: the jobs of all tenants.
    pub tenant: Option<Tenant>,
    /// Limits on what the caller may have at once.
    pub limits: Limits,
    /// Address of the caller, or the transport by which the call came.
    pub peer: String,
    /// Whether the caller may only read.
    pub reads_only: bool,
}

impl Caller {
    /// A caller without a token, known by this credential and this address.
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

    /// Caller of this request. A request that passed no guard comes from the user of this machine: by shared memory,
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
