//! Frame: one gRPC call as one message: where to, then the same bytes as over a connection.
//!
//! Request: length and name of the asker's bell, length and path of the call, body.
//! Response: a byte (answered or declined), length and lines of the headers, body.

use bytes::Bytes;
use http::{HeaderMap, HeaderName, HeaderValue};

/// A call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// The listener to wake when the answer is there.
    pub bell: String,
    /// `/package.Service/Method`.
    pub path: String,
    /// Messages as gRPC frames them.
    pub body: Bytes,
}

/// Answer to a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Response {
    /// The call was answered.
    Answered {
        /// The headers and, after them, the trailers, which hold the status.
        headers: HeaderMap,
        /// Messages as gRPC frames them.
        body: Bytes,
    },
    /// The call cannot be answered through shared memory, and why.
    Declined(String),
}

/// Bytes that are no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a message in shared memory is malformed")]
pub struct Malformed;

const ANSWERED: u8 = 0;
const DECLINED: u8 = 1;

impl Request {
    /// Encodes the request; `None` where a name is longer than 255 bytes.
    pub fn encode(&self) -> Option<Vec<u8>> {
        let mut bytes = Vec::with_capacity(2 + self.bell.len() + self.path.len() + self.body.len());
        for text in [&self.bell, &self.path] {
            bytes.push(u8::try_from(text.len()).ok()?);
            bytes.extend_from_slice(text.as_bytes());
        }
        bytes.extend_from_slice(&self.body);
        Some(bytes)
    }

    /// Decodes a request.
    pub fn decode(bytes: &[u8]) -> Result<Self, Malformed> {
        let (bell, rest) = short_text(bytes)?;
        let (path, body) = short_text(rest)?;
        Ok(Self {
            bell: bell.to_owned(),
            path: path.to_owned(),
            body: Bytes::copy_from_slice(body),
        })
    }
}

fn short_text(bytes: &[u8]) -> Result<(&str, &[u8]), Malformed> {
    let (length, rest) = bytes.split_first().ok_or(Malformed)?;
    let (text, rest) = rest
        .split_at_checked(usize::from(*length))
        .ok_or(Malformed)?;
    Ok((std::str::from_utf8(text).map_err(|_| Malformed)?, rest))
}

impl Response {
    /// Encodes the response.
    pub fn encode(&self) -> Vec<u8> {
        match self {
            Self::Answered { headers, body } => {
                let mut lines = Vec::new();
                for (name, value) in headers {
                    lines.extend_from_slice(name.as_str().as_bytes());
                    lines.push(b':');
                    lines.extend_from_slice(value.as_bytes());
                    lines.push(b'\n');
                }
                let length = u32::try_from(lines.len()).unwrap_or(u32::MAX);
                let mut bytes = Vec::with_capacity(5 + lines.len() + body.len());
                bytes.push(ANSWERED);
                bytes.extend_from_slice(&length.to_le_bytes());
                bytes.extend_from_slice(&lines);
                bytes.extend_from_slice(body);
                bytes
            }
            Self::Declined(why) => [&[DECLINED], why.as_bytes()].concat(),
        }
    }

    /// Decodes a response.
    pub fn decode(bytes: &[u8]) -> Result<Self, Malformed> {
        let (kind, rest) = bytes.split_first().ok_or(Malformed)?;
        match *kind {
            DECLINED => Ok(Self::Declined(String::from_utf8_lossy(rest).into_owned())),
            ANSWERED => {
                let (length, rest) = rest.split_first_chunk::<4>().ok_or(Malformed)?;
                let length = usize::try_from(u32::from_le_bytes(*length)).map_err(|_| Malformed)?;
                let (lines, body) = rest.split_at_checked(length).ok_or(Malformed)?;
                let mut headers = HeaderMap::new();
                for line in lines.split(|b| *b == b'\n').filter(|line| !line.is_empty()) {
                    let colon = line.iter().position(|b| *b == b':').ok_or(Malformed)?;
                    let name = HeaderName::from_bytes(&line[..colon]).map_err(|_| Malformed)?;
                    let value = HeaderValue::from_bytes(&line[colon + 1..]);
                    headers.append(name, value.map_err(|_| Malformed)?);
                }
                Ok(Self::Answered {
                    headers,
                    body: Bytes::copy_from_slice(body),
                })
            }
            _ => Err(Malformed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answered() -> Response {
        let mut headers = HeaderMap::new();
        headers.insert("grpc-status", HeaderValue::from_static("5"));
        headers.insert("grpc-message", HeaderValue::from_static("no: such%20stage"));
        Response::Answered {
            headers,
            body: Bytes::from_static(b"\0\n:body"),
        }
    }

    fn request() -> Request {
        Request {
            bell: "bell".into(),
            path: "/cognate.v1.WorkerApi/Pull".into(),
            body: Bytes::from_static(&[0, 0, 0, 0, 1, 7]),
        }
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(Request::decode(&request().encode().unwrap()), Ok(request()));
        for response in [answered(), Response::Declined("too large".into())] {
            assert_eq!(Response::decode(&response.encode()), Ok(response));
        }
        let long = Request {
            bell: "x".repeat(256),
            ..request()
        };
        assert_eq!(long.encode(), None);
    }

    #[test]
    fn what_is_cut_off_or_changed_is_refused_or_another_message() {
        let (asked, told) = (request().encode().unwrap(), answered().encode());
        let mut refused = 0;
        for end in 0..asked.len() {
            refused += usize::from(Request::decode(&asked[..end]).is_err());
        }
        assert_eq!(refused, 2 + request().bell.len() + request().path.len());
        for end in 0..told.len() {
            assert_ne!(Response::decode(&told[..end]), Ok(answered()));
        }
        for at in 0..told.len() {
            let mut changed = told.clone();
            // Another bit would only change the case of a header's name, which means nothing.
            changed[at] ^= 0x01;
            assert_ne!(Response::decode(&changed), Ok(answered()), "at {at}");
        }
    }
}
