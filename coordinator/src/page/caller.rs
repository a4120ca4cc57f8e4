//! Caller: the service for clients, called in this process with the token that a browser has shown.

use crate::api::admission::Admission;
use crate::api::middleware::Behind;
use crate::api::security::Guard;
use cognate_protocol::limits::MESSAGE_BYTES;
use cognate_protocol::v1::client_api_client::ClientApiClient;
use tonic::metadata::{Ascii, MetadataValue};
use tonic::service::interceptor::InterceptedService;
use tonic::service::{Interceptor, Routes};
use tonic::{Request, Status};

/// All services, behind their guard and their limits.
pub type Services = Behind<Guard, Behind<Admission, Routes>>;

/// A client of the service in this process.
pub type Calls = ClientApiClient<InterceptedService<Services, Shown>>;

/// The token that goes with each call, if one was shown.
#[derive(Clone, Debug)]
pub struct Shown(Option<MetadataValue<Ascii>>);

impl Interceptor for Shown {
    fn call(&mut self, mut request: Request<()>) -> Result<Request<()>, Status> {
        if let Some(token) = &self.0 {
            let metadata = request.metadata_mut();
            metadata.insert("authorization", token.clone());
        }
        Ok(request)
    }
}

/// A client that shows this token. One that no header can hold is no token of anybody.
pub fn calls(services: &Services, token: Option<&str>) -> Calls {
    let header = token.and_then(|token| format!("Bearer {token}").parse().ok());
    let limit = usize::try_from(MESSAGE_BYTES.value).unwrap_or(usize::MAX);
    ClientApiClient::with_interceptor(services.clone(), Shown(header))
        .max_decoding_message_size(limit)
        .max_encoding_message_size(limit)
}
