//! Access: which requests of a browser are answered at all.
//!
//! A browser carries requests of any page that somebody has open. So the name by which this machine was asked must be
//! one of its own (otherwise a foreign name was bound to its address: DNS rebinding), and a request that another page
//! has made is refused: by what browsers say of its origin, and by a header that no foreign page can send without
//! being asked for permission, which nobody gives.

use http::header::{COOKIE, HOST, HeaderMap, ORIGIN};
use http::{Method, StatusCode, Uri};
use std::net::IpAddr;

/// A header of the page's own requests that change something.
pub const OWN_HEADER: &str = "x-cognate";
/// The cookie that holds the name of a session. Browsers send a cookie with this beginning over TLS only, to this host only.
pub const COOKIE_NAME: &str = "__Host-cognate";
/// Where Linux says the name of this machine.
const HOST_NAME: &str = "/proc/sys/kernel/hostname";

/// Why a request is not answered.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The request names a host that is not this machine.
    #[error(
        "this page is not at the host `{0}`: ask for it by its address, or start it with --page NAME:PORT"
    )]
    Host(String),
    /// Another page has made the request.
    #[error("requests that other pages make are refused ({0})")]
    OtherPage(String),
    /// A change without the page's own header.
    #[error("a request that changes something has the header `X-Cognate: page`")]
    NoHeader,
    /// The request has no token.
    #[error("this page asks for a token of this coordinator")]
    NoToken,
}

impl Refusal {
    /// The status of the answer.
    pub fn status(&self) -> StatusCode {
        match self {
            // RFC 9110, section 15.5.20: the server does not answer for this host.
            Self::Host(_) => StatusCode::MISDIRECTED_REQUEST,
            Self::OtherPage(_) | Self::NoHeader => StatusCode::FORBIDDEN,
            Self::NoToken => StatusCode::UNAUTHORIZED,
        }
    }
}

/// Rules by which the page accepts requests.
#[derive(Clone, Debug)]
pub struct Access {
    /// Names of this machine, in small letters.
    names: Vec<String>,
    asks_for_tokens: bool,
}

impl Access {
    /// Rules for a page at this host, as somebody typed it.
    pub fn new(host: &str, asks_for_tokens: bool) -> Self {
        let machine_name = std::fs::read_to_string(HOST_NAME).unwrap_or_default();
        let names = ["localhost", host, machine_name.trim()].into_iter();
        Self {
            names: names
                .filter(|name| !name.is_empty())
                .map(str::to_ascii_lowercase)
                .collect(),
            asks_for_tokens,
        }
    }

    /// Whether requests must have a token.
    pub fn asks_for_tokens(&self) -> bool {
        self.asks_for_tokens
    }

    /// Whether a request to this path is answered, before anybody looks what it wants.
    pub fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = host(uri, headers).ok_or_else(|| Refusal::Host(String::new()))?;
        let name = without_port(&host).to_ascii_lowercase();
        let bare = name.trim_start_matches('[').trim_end_matches(']');
        // A name can be bound to any address; an address is what it is.
        if bare.parse::<IpAddr>().is_err() && !self.names.contains(&name) {
            return Err(Refusal::Host(host.chars().take(80).collect()));
        }
        let reads = matches!(*method, Method::GET | Method::HEAD);
        // Links from elsewhere lead to the page itself.
        if reads && uri.path() == "/" {
            return Ok(());
        }
        own_page(&host, headers)?;
        match reads || headers.get(OWN_HEADER).is_some_and(|is| is == "page") {
            true => Ok(()),
            false => Err(Refusal::NoHeader),
        }
    }
}

/// Whether what the browser says of a request's origin is this page.
fn own_page(host: &str, headers: &HeaderMap) -> Result<(), Refusal> {
    let site = headers.get("sec-fetch-site");
    if let Some(site) = site
        && site != "same-origin"
        && site != "none"
    {
        let site = String::from_utf8_lossy(site.as_bytes());
        return Err(Refusal::OtherPage(format!("Sec-Fetch-Site: {site}")));
    }
    let Some(origin) = headers.get(ORIGIN) else {
        return Ok(());
    };
    let origin = String::from_utf8_lossy(origin.as_bytes());
    let at = origin.split_once("://").map(|(_, authority)| authority);
    match at.is_some_and(|at| at.eq_ignore_ascii_case(host)) {
        true => Ok(()),
        false => Err(Refusal::OtherPage(format!("Origin: {origin}"))),
    }
}

/// The host that was asked: of the address in HTTP/2, and of its header, of which there is one.
fn host(uri: &Uri, headers: &HeaderMap) -> Option<String> {
    let mut named = headers.get_all(HOST).iter();
    let header = named.next().and_then(|host| host.to_str().ok());
    if named.next().is_some() {
        return None;
    }
    match (uri.authority(), header) {
        (Some(authority), Some(header)) if authority.as_str() != header => None,
        (Some(authority), _) => Some(authority.as_str().to_owned()),
        (None, header) => header.map(str::to_owned),
    }
}

fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    }
}

/// Credentials of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shown {
    /// A token, in the header for programs.
    Token(String),
    /// The name of a session, in the cookie of browsers.
    Session(String),
}

/// Credentials of a request; `None` where it has none.
pub fn shown(headers: &HeaderMap) -> Option<Shown> {
    let header = headers.get(http::header::AUTHORIZATION);
    let bearer = header
        .and_then(|value| value.to_str().ok())
        .and_then(|value| value.strip_prefix("Bearer "));
    if let Some(token) = bearer {
        return Some(Shown::Token(token.to_owned()));
    }
    session(headers).map(Shown::Session)
}

/// The name of a session in the cookies of a request.
pub fn session(headers: &HeaderMap) -> Option<String> {
    let cookies = headers.get_all(COOKIE).iter();
    let mut pairs = cookies
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(';'))
        .filter_map(|pair| pair.trim().split_once('='));
    let (_, value) = pairs.find(|(name, _)| *name == COOKIE_NAME)?;
    (!value.is_empty()).then(|| value.to_owned())
}

/// The cookie that keeps the name of a session until the browser is closed; without one, the cookie that makes the
/// browser forget it.
pub fn cookie(session: Option<&str>) -> String {
    let value = session.unwrap_or_default();
    let end = match session {
        Some(_) => "",
        None => "; Max-Age=0",
    };
    format!("{COOKIE_NAME}={value}; Path=/; Secure; HttpOnly; SameSite=Strict{end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(*name, value.parse().unwrap());
        }
        headers
    }

    fn check(method: Method, path: &str, pairs: &[(&'static str, &str)]) -> Result<(), StatusCode> {
        let access = Access::new("head.example", false);
        let uri = path.parse().unwrap();
        let checked = access.check(&method, &uri, &headers(pairs));
        checked.map_err(|refusal| refusal.status())
    }

    #[test]
    fn a_name_that_is_not_this_machine_s_is_refused() {
        for host in [
            "127.0.0.1:7655",
            "localhost:7655",
            "LOCALHOST",
            "[::1]:7655",
            "10.0.0.7",
            "head.example:7655",
        ] {
            let asked = check(Method::GET, "/api/jobs", &[("host", host)]);
            assert_eq!(asked, Ok(()), "{host}");
        }
        let refused = Err(StatusCode::MISDIRECTED_REQUEST);
        for host in [
            "evil.example",
            "127.0.0.1.evil.example:7655",
            "localhost.evil.example",
            "head.example.evil.example",
            "",
        ] {
            for path in ["/", "/api/jobs"] {
                assert_eq!(check(Method::GET, path, &[("host", host)]), refused);
            }
        }
        assert_eq!(check(Method::GET, "/", &[]), refused);
        let twice = [("host", "localhost"), ("host", "evil.example")];
        assert_eq!(check(Method::GET, "/", &twice), refused);
        // HTTP/2 has the host in the address; both must agree.
        let two = check(
            Method::GET,
            "https://localhost/",
            &[("host", "evil.example")],
        );
        assert_eq!(two, refused);
        assert_eq!(check(Method::GET, "https://evil.example/", &[]), refused);
    }

    #[test]
    fn what_another_page_asks_for_is_refused() {
        let with = |method: Method, more: &[(&'static str, &str)]| {
            let mut pairs = vec![("host", "localhost:7655")];
            pairs.extend_from_slice(more);
            check(method, "/api/jobs", &pairs)
        };
        let refused = Err(StatusCode::FORBIDDEN);
        for site in ["cross-site", "same-site"] {
            let site = [("sec-fetch-site", site), ("x-cognate", "page")];
            assert_eq!(with(Method::GET, &site), refused);
            assert_eq!(with(Method::POST, &site), refused);
        }
        for origin in [
            "http://evil.example",
            "null",
            "http://localhost:80",
            "http://localhost:7655.evil.example",
        ] {
            let origin = [("origin", origin), ("x-cognate", "page")];
            assert_eq!(with(Method::POST, &origin), refused);
            assert_eq!(with(Method::GET, &origin), refused);
        }
        let same_origin = [
            ("origin", "http://localhost:7655"),
            ("sec-fetch-site", "same-origin"),
        ];
        assert_eq!(with(Method::GET, &same_origin), Ok(()));
        // A form of another page, from a browser that says nothing of its origin.
        for method in [Method::POST, Method::DELETE, Method::OPTIONS, Method::PUT] {
            assert_eq!(with(method, &same_origin), refused);
        }
        let header = [("x-cognate", "page"), same_origin[0], same_origin[1]];
        assert_eq!(with(Method::DELETE, &header), Ok(()));
        // A link from elsewhere leads to the page.
        let link = [("host", "localhost"), ("sec-fetch-site", "cross-site")];
        assert_eq!(check(Method::GET, "/", &link), Ok(()));
    }

    #[test]
    fn a_session_comes_back_from_its_cookie() {
        let session_of = |cookie: &str| session(&headers(&[("cookie", cookie)]));
        let set = cookie(Some("0123abcd"));
        let pair = set.split(';').next().unwrap();
        assert_eq!(
            session_of(&format!("a=b; {pair}; c")).as_deref(),
            Some("0123abcd")
        );
        for other in ["", "a=b", "__Host-cognate="] {
            assert_eq!(session_of(other), None, "{other}");
        }
        assert!(cookie(None).contains("Max-Age=0"));
        let bearer = headers(&[("authorization", "Bearer t"), ("cookie", pair)]);
        assert_eq!(shown(&bearer), Some(Shown::Token("t".to_owned())));
    }
}
