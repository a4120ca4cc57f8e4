//! Page: a coordinator's jobs and workers in a browser, by HTTP on a listener of its own (`--page HOST:PORT`).
//!
//! One HTML file is the whole page. What it shows and does goes through the service for clients, in this process:
//! behind the same guard of tokens, the same limits and the same rules of tenants as calls of `cognate`.

mod access;
mod answers;
mod caller;
mod events;
pub mod mechanisms;
mod points;
mod request;
mod sessions;

use crate::api::admission::Admission;
use crate::api::middleware::Before;
use crate::api::security::{Guard, Security};
use crate::config::ListenAddress;
use crate::transport::introduction::{ConnectionLimits, Connections};
use crate::transport::{self, Callers, ListenError, tcp};
use access::Access;
use answers::Page;
use mechanisms::Mechanisms;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;
use tonic::service::Routes;
use tower::Layer;

/// Connections of browsers: a few for each of some people, and never those that workers need.
const CONNECTIONS: usize = 256;
/// Connections of one address: of some browsers behind one proxy, and a quarter of all, so that no single address
/// shuts the page.
const CONNECTIONS_OF_ONE_ADDRESS: usize = CONNECTIONS / 4;
/// A connection that does not answer a ping for so long is closed; one is sent after as long a silence.
const KEEP_ALIVE: Duration = Duration::from_secs(10);
/// A connection takes no new requests after this time, and is closed when those under way are answered: who only
/// answers pings has no place for ever. Browsers connect again by themselves.
const CONNECTION_AGE: Duration = Duration::from_secs(120);

/// The page's listener, which is bound, and who may come in.
#[derive(Debug)]
pub struct PageListener {
    listener: TcpListener,
    callers: Callers,
    /// The host as it was typed: browsers may name it so.
    host: String,
    asks_for_tokens: bool,
    tls: bool,
    mechanisms: Option<Arc<dyn Mechanisms>>,
}

impl PageListener {
    /// Binds the address. Without TLS and tokens, or certificates of callers, only this user on this machine
    /// comes in, unless `insecure`.
    pub async fn open(
        authority: &str,
        security: &Security,
        insecure: bool,
    ) -> Result<Self, ListenError> {
        let tls = security.tls.is_some();
        // A token in the clear would be one for everybody.
        let knows_callers = tls && security.knows_callers();
        let open_to_all = knows_callers || insecure;
        let bound = tcp::bind(authority, open_to_all).await;
        let listener = bound.map_err(|error| match error {
            ListenError::BeyondLoopback { .. } => ListenError::PageBeyondLoopback {
                address: authority.to_owned(),
            },
            other => other,
        })?;
        Ok(Self {
            listener,
            callers: match open_to_all {
                true => Callers::All,
                false => Callers::SameUser,
            },
            host: authority
                .rsplit_once(':')
                .map_or(authority, |(host, _)| host)
                .to_owned(),
            asks_for_tokens: knows_callers && security.tokens.is_some(),
            tls,
            mechanisms: None,
        })
    }

    /// Page that also answers questions about mechanisms.
    pub fn with_mechanisms(self, mechanisms: Option<Arc<dyn Mechanisms>>) -> Self {
        Self { mechanisms, ..self }
    }

    /// Where it is, as a browser takes it.
    pub fn url(&self) -> String {
        let address = self.listener.local_addr();
        let address = address.map_or_else(|e| e.to_string(), |address| address.to_string());
        let address = match self.tls {
            true => ListenAddress::Tls(address),
            false => ListenAddress::Tcp(address),
        };
        format!("{address}/")
    }

    /// Answers until the service stops.
    pub async fn serve(
        self,
        security: Security,
        admission: Admission,
        routes: Routes,
        stopping: CancellationToken,
    ) {
        let url = self.url();
        tracing::info!(%url, "the page is there");
        let tokens = security.tokens.filter(|_| self.asks_for_tokens);
        let guard = Guard {
            tokens,
            audit: security.audit,
        };
        let service = Before(guard).layer(Before(admission).layer(routes));
        let access = Access::new(&self.host, self.asks_for_tokens);
        let page = Arc::new(Page::new(
            access,
            service,
            self.mechanisms,
            stopping.clone(),
        ));
        let service = tower::service_fn(move |request| {
            let page = Arc::clone(&page);
            async move { Ok::<_, Infallible>(page.answer(request).await) }
        });
        let connections = Connections::new(ConnectionLimits {
            most: CONNECTIONS,
            most_of_one_address: Some(CONNECTIONS_OF_ONE_ADDRESS),
            ..ConnectionLimits::default()
        });
        let incoming = transport::tcp_connections(self.listener, self.callers, connections);
        let server = tonic::transport::Server::builder()
            .accept_http1(true)
            .http2_keepalive_interval(Some(KEEP_ALIVE))
            .http2_keepalive_timeout(Some(KEEP_ALIVE))
            .tcp_keepalive(Some(KEEP_ALIVE))
            .max_connection_age(CONNECTION_AGE);
        let server = match security.tls {
            Some(tls) => server.tls_config(tls.config()),
            None => Ok(server),
        };
        let served = match server {
            Ok(server) => {
                let stopped = stopping.cancelled_owned();
                server
                    .serve_with_incoming_shutdown(service, incoming, stopped)
                    .await
            }
            Err(error) => Err(error),
        };
        if let Err(error) = served {
            tracing::error!(%url, %error, "the page has closed");
        }
    }
}
