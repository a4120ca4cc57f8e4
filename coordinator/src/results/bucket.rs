//! Bucket: objects in S3, or in another service that speaks as S3 does.
//!
//! Keys, region, endpoint and authority come from the environment, by the names that Amazon's own tools read
//! (`AWS_ACCESS_KEY_ID`, `AWS_SECRET_ACCESS_KEY`, `AWS_SESSION_TOKEN`, `AWS_REGION`, `AWS_ENDPOINT_URL`,
//! `AWS_CA_BUNDLE`, and those of roles in containers and on their machines). HTTP is by the TLS that all other
//! connections have.

use super::place::BucketAddress;
use async_trait::async_trait;
use http_body_util::{BodyExt, Full};
use hyper_rustls::HttpsConnector;
use hyper_util::client::legacy::Client;
use hyper_util::client::legacy::connect::HttpConnector as Tcp;
use hyper_util::rt::{TokioExecutor, TokioTimer};
use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey, S3ConditionalPut};
use object_store::client::{
    ClientConfigKey, HttpClient, HttpConnector, HttpError, HttpErrorKind, HttpRequest,
    HttpRequestBody, HttpResponse, HttpResponseBody, HttpService,
};
use object_store::prefix::PrefixStore;
use object_store::{BackoffConfig, ClientOptions, ObjectStore, RetryConfig};
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::{ClientConfig, RootCertStore};
use std::error::Error;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::timeout;

/// A server that cannot be connected to within this time is not there. Instances ask for their role at an address
/// that is silent everywhere else.
const CONNECT: Duration = Duration::from_secs(2);
/// A request is answered within this time, with all bytes of its answer: an object of 600 MB at 10 MB/s.
const ANSWER: Duration = Duration::from_secs(60);
/// Connections that are not used are closed after this time, before servers do.
const IDLE: Duration = Duration::from_secs(15);

/// Requests that fail are sent again for some seconds. What lasts longer is told the caller, who asks again: workers
/// their reports, stewards their jobs, and health says it meanwhile.
fn retries() -> RetryConfig {
    RetryConfig {
        backoff: BackoffConfig {
            init_backoff: Duration::from_millis(100),
            max_backoff: Duration::from_secs(1),
            base: 2.0,
        },
        max_retries: 5,
        retry_timeout: Duration::from_secs(5),
    }
}

/// Objects in this bucket; an error says what the environment lacks. No request is sent yet.
pub fn open(address: &BucketAddress) -> Result<Arc<dyn ObjectStore>, String> {
    let mut builder = AmazonS3Builder::from_env()
        .with_bucket_name(&address.bucket)
        .with_conditional_put(S3ConditionalPut::ETagMatch)
        .with_retry(retries());
    let set = |builder: &AmazonS3Builder, key| builder.get_config_value(&key);
    let endpoint = set(&builder, AmazonS3ConfigKey::S3Endpoint)
        .or_else(|| set(&builder, AmazonS3ConfigKey::Endpoint));
    if let Some(url) = endpoint.filter(|url| url.starts_with("http://")) {
        let allow = AmazonS3ConfigKey::Client(ClientConfigKey::AllowHttp);
        if is_loopback(&url) {
            builder = builder.with_allow_http(true);
        } else if set(&builder, allow).as_deref() != Some("true") {
            return Err(format!(
                "its endpoint {url} is not encrypted; AWS_ALLOW_HTTP=true allows it"
            ));
        }
    }
    let has = |key| set(&builder, key).is_some();
    let has_identity = has(AmazonS3ConfigKey::AccessKeyId)
        || has(AmazonS3ConfigKey::WebIdentityTokenFile)
        || has(AmazonS3ConfigKey::ContainerCredentialsRelativeUri)
        || has(AmazonS3ConfigKey::ContainerCredentialsFullUri);
    let asks_machine = !std::env::var("AWS_EC2_METADATA_DISABLED")
        .is_ok_and(|value| value.eq_ignore_ascii_case("true"));
    if !has_identity && !asks_machine {
        return Err(
            "the environment has no keys (AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY)".to_owned(),
        );
    }
    let connections = Connections {
        tls: Arc::new(tls(authorities()?)?),
    };
    let bucket = builder.with_http_connector(connections).build();
    let bucket = bucket.map_err(|error| error.to_string())?;
    Ok(match address.prefix.is_root() {
        true => Arc::new(bucket),
        false => Arc::new(PrefixStore::new(bucket, address.prefix.clone())),
    })
}

/// Whether an address leads to this machine and no other.
fn is_loopback(url: &str) -> bool {
    let Ok(url) = url.parse::<http::Uri>() else {
        return false;
    };
    let host = url.host().unwrap_or_default();
    let host = host.trim_start_matches('[').trim_end_matches(']');
    host == "localhost" || host.parse().is_ok_and(|ip: IpAddr| ip.is_loopback())
}

/// Authorities that are believed: those of the file that `AWS_CA_BUNDLE` names, else those that browsers believe.
fn authorities() -> Result<RootCertStore, String> {
    let mut roots = RootCertStore::empty();
    let Some(file) = std::env::var_os("AWS_CA_BUNDLE").filter(|file| !file.is_empty()) else {
        roots.extend(webpki_roots::TLS_SERVER_ROOTS.iter().cloned());
        return Ok(roots);
    };
    let name = file.display().to_string();
    let wrong = |error: &dyn Error| format!("the file {name} of AWS_CA_BUNDLE: {error}");
    for certificate in CertificateDer::pem_file_iter(&file).map_err(|error| wrong(&error))? {
        let certificate = certificate.map_err(|error| wrong(&error))?;
        // Bundles of systems hold some that this library cannot read.
        let _ = roots.add(certificate);
    }
    match roots.is_empty() {
        true => Err(wrong(&rustls::Error::General("it has no authority".into()))),
        false => Ok(roots),
    }
}

fn tls(roots: RootCertStore) -> Result<ClientConfig, String> {
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let versions =
        ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let config = versions.map_err(|error| error.to_string())?;
    Ok(config.with_root_certificates(roots).with_no_client_auth())
}

/// Makes clients of HTTP.
#[derive(Debug)]
struct Connections {
    tls: Arc<ClientConfig>,
}

impl HttpConnector for Connections {
    fn connect(&self, options: &ClientOptions) -> object_store::Result<HttpClient> {
        let allow_http = options.get_config_value(&ClientConfigKey::AllowHttp);
        let mut tcp = Tcp::new();
        tcp.enforce_http(false);
        tcp.set_connect_timeout(Some(CONNECT));
        tcp.set_nodelay(true);
        let encrypted =
            hyper_rustls::HttpsConnectorBuilder::new().with_tls_config((*self.tls).clone());
        let encrypted = match allow_http.as_deref() == Some("true") {
            true => encrypted.https_or_http(),
            false => encrypted.https_only(),
        };
        let client = Client::builder(TokioExecutor::new())
            .pool_timer(TokioTimer::new())
            .pool_idle_timeout(IDLE)
            .build(encrypted.enable_http1().wrap_connector(tcp));
        Ok(HttpClient::new(Requests { client }))
    }
}

/// Sends requests and takes their whole answers.
#[derive(Debug)]
struct Requests {
    client: Client<HttpsConnector<Tcp>, HttpRequestBody>,
}

impl Requests {
    async fn answer(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        let answer = self.client.request(request).await.map_err(|error| {
            // Nothing is written twice: objects are created or are there already.
            let kind = match error.is_connect() {
                true => HttpErrorKind::Connect,
                false => HttpErrorKind::Request,
            };
            HttpError::new(kind, error)
        })?;
        let (head, body) = answer.into_parts();
        let body = body.collect().await;
        let body = body.map_err(|error| HttpError::new(HttpErrorKind::Interrupted, error))?;
        let body = Full::new(body.to_bytes()).map_err(|never| match never {});
        Ok(HttpResponse::from_parts(head, HttpResponseBody::new(body)))
    }
}

#[async_trait]
impl HttpService for Requests {
    async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        match timeout(ANSWER, self.answer(request)).await {
            Ok(answer) => answer,
            Err(late) => Err(HttpError::new(HttpErrorKind::Timeout, late)),
        }
    }
}

/// Why a request failed, without how long it took and what it was numbered: the innermost cause, or the service's own
/// words.
pub fn cause(error: &object_store::Error) -> String {
    let mut cause: &dyn Error = error;
    while let Some(inner) = cause.source() {
        cause = inner;
    }
    said(&cause.to_string())
}

/// Code and message of an answer in XML; else the text itself.
fn said(text: &str) -> String {
    let between = |name: &str| {
        let (_, rest) = text.split_once(&format!("<{name}>"))?;
        Some(rest.split_once(&format!("</{name}>"))?.0)
    };
    match (between("Code"), between("Message")) {
        (Some(code), Some(message)) => format!("{code}: {message}"),
        (Some(code), None) => code.to_owned(),
        (None, _) => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A server that answers every request with two bytes, and who believes it: its own authority.
    async fn secure_server() -> (std::net::SocketAddr, RootCertStore) {
        use tokio::io::{AsyncReadExt, AsyncWriteExt};
        let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
        let certificate = made.cert.der().clone();
        let key = rustls::pki_types::PrivateKeyDer::try_from(made.signing_key.serialize_der());
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = rustls::ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .unwrap()
            .with_no_client_auth()
            .with_single_cert(vec![certificate.clone()], key.unwrap())
            .unwrap();
        let acceptor = tokio_rustls::TlsAcceptor::from(Arc::new(config));
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        tokio::spawn(async move {
            while let Ok((connection, _)) = listener.accept().await {
                let Ok(mut connection) = acceptor.accept(connection).await else {
                    continue;
                };
                let mut request = [0; 4096];
                let _ = connection.read(&mut request).await;
                let answer = b"HTTP/1.1 200 OK\r\ncontent-length: 2\r\n\r\nok";
                let _ = connection.write_all(answer).await;
            }
        });
        let mut roots = RootCertStore::empty();
        roots.add(certificate).unwrap();
        (address, roots)
    }

    #[tokio::test]
    async fn servers_are_believed_by_their_authority_and_only_encrypted() {
        let (address, roots) = secure_server().await;
        let ask = async |scheme: &str, roots: RootCertStore| {
            let connections = Connections {
                tls: Arc::new(tls(roots).unwrap()),
            };
            let client = connections.connect(&ClientOptions::new()).unwrap();
            let url = format!("{scheme}://localhost:{}/", address.port());
            let request = http::Request::get(url).body(HttpRequestBody::empty());
            client.execute(request.unwrap()).await
        };
        let answer = ask("https", roots.clone()).await.unwrap();
        let body = answer.into_body().bytes().await.unwrap();
        assert_eq!(&body[..], b"ok");
        let others = RootCertStore::from_iter(webpki_roots::TLS_SERVER_ROOTS.iter().cloned());
        assert!(ask("https", others).await.is_err());
        assert!(ask("http", roots).await.is_err());
    }

    #[test]
    fn services_are_quoted_without_their_markup() {
        let answer = "404 Not Found: <?xml version=\"1.0\"?><Error><Code>NoSuchBucket</Code>\
                      <Message>There is none</Message><RequestId>7</RequestId></Error>";
        assert_eq!(said(answer), "NoSuchBucket: There is none");
        assert_eq!(said("Connection refused"), "Connection refused");
    }

    #[test]
    fn unencrypted_endpoints_are_told_from_those_of_this_machine() {
        for url in [
            "http://127.0.0.1:9000",
            "http://localhost:9000/",
            "http://[::1]:9000",
        ] {
            assert!(is_loopback(url), "{url}");
        }
        for url in [
            "http://10.0.0.1:9000",
            "http://localhost.example:9000",
            "http://127.0.0.1.example",
            "http://127.0.0.1@example",
            "",
        ] {
            assert!(!is_loopback(url), "{url}");
        }
    }
}
