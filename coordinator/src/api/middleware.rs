//! Middleware: what a call passes before it comes to the services, each as one function.
//!
//! The rest of a tower layer is the same for all and stands here.

use futures::future::BoxFuture;
use std::convert::Infallible;
use std::task::{Context, Poll};
use tonic::body::Body;
use tower::{Layer, Service};

/// The answer to a call, as soon as it begins.
pub type Answer = BoxFuture<'static, Result<http::Response<Body>, Infallible>>;

/// Service that a middleware passes calls on to: the services, or another middleware.
pub trait Inner:
    Service<
        http::Request<Body>,
        Response = http::Response<Body>,
        Error = Infallible,
        Future: Send + 'static,
    > + Clone
    + Send
    + 'static
{
}

impl<S> Inner for S where
    S: Service<
            http::Request<Body>,
            Response = http::Response<Body>,
            Error = Infallible,
            Future: Send + 'static,
        > + Clone
        + Send
        + 'static
{
}

/// Answers a call by itself, or hands it on.
pub trait Middleware: Clone + Send + Sync + 'static {
    /// `inner` is ready for this call.
    fn answer<S: Inner>(&self, request: http::Request<Body>, inner: S) -> Answer;
}

/// A middleware as a layer before services.
#[derive(Clone, Debug)]
pub struct Before<M>(pub M);

impl<M: Middleware, S> Layer<S> for Before<M> {
    type Service = Behind<M, S>;

    fn layer(&self, inner: S) -> Behind<M, S> {
        Behind {
            middleware: self.0.clone(),
            inner,
        }
    }
}

/// Services behind a middleware.
#[derive(Clone, Debug)]
pub struct Behind<M, S> {
    middleware: M,
    inner: S,
}

impl<M: Middleware, S: Inner> Service<http::Request<Body>> for Behind<M, S> {
    type Response = http::Response<Body>;
    type Error = Infallible;
    type Future = Answer;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, request: http::Request<Body>) -> Answer {
        // The one that is ready answers; its clone is for the next call.
        let clone = self.inner.clone();
        let inner = std::mem::replace(&mut self.inner, clone);
        self.middleware.answer(request, inner)
    }
}
