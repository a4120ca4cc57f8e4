//! Request: the parts of a browser's request, read and checked; answers with the headers that every one has.

use bytes::Bytes;
use http::header::{
    CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName,
    HeaderValue, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use http::{Response, StatusCode};
use http_body_util::Full;
use serde_json::{Value, json};
use tonic::body::Body;
use tonic::{Code, Status};

/// Why a request has no answer but this.
#[derive(Debug)]
pub struct Fault {
    /// Status of the answer.
    pub status: StatusCode,
    /// One sentence for people.
    pub message: String,
}

impl Fault {
    /// A fault of the request.
    pub fn of_request(message: impl Into<String>) -> Self {
        Self {
            status: StatusCode::BAD_REQUEST,
            message: message.into(),
        }
    }

    /// Nothing is there.
    pub fn not_found() -> Self {
        Self {
            status: StatusCode::NOT_FOUND,
            message: "there is nothing at this address".to_owned(),
        }
    }
}

impl From<Status> for Fault {
    fn from(status: Status) -> Self {
        let code = match status.code() {
            Code::InvalidArgument | Code::OutOfRange => StatusCode::BAD_REQUEST,
            Code::NotFound => StatusCode::NOT_FOUND,
            Code::FailedPrecondition | Code::AlreadyExists => StatusCode::CONFLICT,
            Code::ResourceExhausted => StatusCode::PAYLOAD_TOO_LARGE,
            Code::Unauthenticated => StatusCode::UNAUTHORIZED,
            Code::PermissionDenied => StatusCode::FORBIDDEN,
            Code::Unimplemented => StatusCode::NOT_IMPLEMENTED,
            Code::Unavailable | Code::DeadlineExceeded => StatusCode::SERVICE_UNAVAILABLE,
            _ => StatusCode::INTERNAL_SERVER_ERROR,
        };
        Self {
            status: code,
            message: status.message().to_owned(),
        }
    }
}

/// Parameters after the question mark of an address.
#[derive(Debug)]
pub struct Query(Vec<(String, String)>);

impl Query {
    /// Reads it; what is no UTF-8 is a fault.
    pub fn read(text: Option<&str>) -> Result<Self, Fault> {
        let pairs = text.unwrap_or_default().split('&');
        let decoded = |text: &str| {
            let decoded = percent_encoding::percent_decode_str(text).decode_utf8();
            decoded.map(String::from).map_err(|_| {
                Fault::of_request("the address is malformed: expected UTF-8 behind `?`")
            })
        };
        let pair = |pair: &str| {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            Ok((decoded(name)?, decoded(value)?))
        };
        let pairs = pairs.filter(|pair| !pair.is_empty()).map(pair);
        Ok(Self(pairs.collect::<Result<_, Fault>>()?))
    }

    /// Refuses names that mean nothing here.
    pub fn only(self, names: &[&str]) -> Result<Self, Fault> {
        let unknown = self
            .0
            .iter()
            .find(|(name, _)| !names.contains(&name.as_str()));
        match unknown {
            None => Ok(self),
            Some((name, _)) => Err(Fault::of_request(format!(
                "`{name}` is no option here; expected {}",
                names.join(", ")
            ))),
        }
    }

    /// The value of a name, if it was given and is not empty.
    pub fn get(&self, name: &str) -> Option<&str> {
        let mut values = self.0.iter().filter(|(key, _)| key == name);
        let value = values.next().map(|(_, value)| value.as_str());
        value.filter(|value| !value.is_empty())
    }

    /// A whole number, or what it is where none was given.
    pub fn number<T: std::str::FromStr>(&self, name: &str) -> Result<Option<T>, Fault> {
        let read = |text: &str| {
            text.parse().map_err(|_| {
                Fault::of_request(format!("{name} is `{text}`; expected a whole number"))
            })
        };
        self.get(name).map(read).transpose()
    }

    /// A choice between yes and no.
    pub fn flag(&self, name: &str) -> Result<bool, Fault> {
        match self.get(name) {
            None | Some("false") => Ok(false),
            Some("true") => Ok(true),
            Some(other) => Err(Fault::of_request(format!(
                "{name} is `{other}`; expected true or false"
            ))),
        }
    }
}

/// An answer with the headers that every one has.
pub fn answer(status: StatusCode, kind: &'static str, body: Body) -> Response<Body> {
    let mut response = Response::new(body);
    *response.status_mut() = status;
    let headers = response.headers_mut();
    let fixed: [(HeaderName, &'static str); 7] = [
        (CONTENT_TYPE, kind),
        (CACHE_CONTROL, "no-store"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers.insert(
        CONTENT_SECURITY_POLICY,
        HeaderValue::from_static("default-src 'none'; frame-ancestors 'none'"),
    );
    response
}

/// A whole body.
pub fn full(bytes: impl Into<Bytes>) -> Body {
    Body::new(Full::new(bytes.into()))
}

/// A JSON object.
pub fn json_text(text: String) -> Response<Body> {
    answer(StatusCode::OK, "application/json", full(text))
}

/// A JSON object.
pub fn json_value(value: &Value) -> Response<Body> {
    json_text(value.to_string())
}

/// A fault as an answer.
pub fn fault(fault: &Fault) -> Response<Body> {
    let body = json!({ "error": fault.message }).to_string();
    answer(fault.status, "application/json", full(body))
}

/// An answer that browsers keep as a file.
pub fn download(name: &str, kind: &'static str, body: Body) -> Response<Body> {
    let mut response = answer(StatusCode::OK, kind, body);
    let disposition = format!("attachment; filename=\"{name}\"");
    if let Ok(value) = disposition.parse() {
        response.headers_mut().insert(CONTENT_DISPOSITION, value);
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_are_read_or_refused() {
        let query = Query::read(Some("name=a%20b%3Dc.txt&from=12&certify=true&empty=")).unwrap();
        assert_eq!(query.get("name"), Some("a b=c.txt"));
        assert_eq!(query.number::<u64>("from").unwrap(), Some(12));
        assert_eq!(query.number::<u64>("limit").unwrap(), None);
        assert!(query.flag("certify").unwrap() && !query.flag("empty").unwrap());
        let negative = query.number::<u64>("name").unwrap_err();
        assert_eq!(
            negative.message,
            "name is `a b=c.txt`; expected a whole number"
        );
        assert!(query.flag("name").is_err());
        assert!(Query::read(Some("a=%ff")).is_err());
        let unknown = query.only(&["name", "from"]).unwrap_err();
        assert_eq!(
            unknown.message,
            "`certify` is no option here; expected name, from"
        );
    }
}
