//! The server: one router, every request judged before it is looked at.

use super::guard::{Guard, seal};
use super::json::json;
use super::refusal::Refusal;
use super::shared::Shared;
use super::{First, Settings, assets, events, launch, places, samples, uploads, verb};
use crate::failure::Failure;
use crate::terminal::{remark, say};
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get, post};
use axum::{Router, serve as serve_http};
use serde::de::DeserializeOwned;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;

/// Serves until it is interrupted.
pub fn serve(settings: Settings) -> Result<(), Failure> {
    let Settings { folder, port, open, first } = settings;
    std::fs::create_dir_all(&folder).map_err(|error| Failure::io(&folder, &error))?;
    let listener = bind(port)?;
    let port = listener.local_addr().map_err(Failure::new)?.port();
    let guard = Guard::new(port)?;
    let _claim = places::claimed(&folder)?;
    let shared = Arc::new(Shared::new(folder));
    begin(&shared, first)?;
    say!("Workbench:  {}", guard.url())?;
    // Whoever has read the address may read no further: that ends nothing.
    remark!("Stop it with Ctrl-C.");
    let _opened = if open { launch::browser(&guard.url()) } else { None };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(Failure::new)?;
    runtime
        .block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            serve_http(listener, router(guard, shared)).await
        })
        .map_err(Failure::new)
}

/// On this computer's own address only.
fn bind(port: u16) -> Result<TcpListener, Failure> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| {
        Failure::new(format_args!("port {port}: {error}")).help("leave --port out to take any that is free")
    })?;
    listener.set_nonblocking(true).map_err(Failure::new)?;
    Ok(listener)
}

fn begin(shared: &Arc<Shared>, first: First) -> Result<(), Failure> {
    let started = match first {
        First::Data(data) => {
            // What is misspelt is said where it was typed.
            if data.files.iter().any(|file| !file.exists()) {
                data.read()?;
            }
            verb::load::start(shared, data)
        }
        First::Demo { seed } => verb::demo::run(shared, verb::demo::Request { seed: Some(seed) }),
    };
    started.map_err(|refusal| refusal.failure)
}

fn router(guard: Guard, shared: Arc<Shared>) -> Router {
    let mut router = Router::new()
        .route("/api/state", get(state))
        .route("/api/effects", get(verb::effects::answer))
        .route("/api/events", get(events::answer))
        .route("/api/samples", get(samples::answer))
        .route("/api/chosen", post(samples::chosen))
        .route("/api/download", get(verb::export::download))
        .route("/api/upload", post(uploads::receive).layer(DefaultBodyLimit::disable()))
        .route("/api/uploads", post(uploads::open))
        .route("/api/campaign", action(verb::campaign::run))
        .route("/api/load", action(verb::load::run))
        .route("/api/demo", action(verb::demo::run))
        .route("/api/split", action(verb::split::run))
        .route("/api/train", action(verb::train::run))
        .route("/api/stop", action(verb::stop::run))
        .route("/api/select", action(verb::select::run))
        .route("/api/diagnose", action(verb::diagnose::run))
        .route("/api/add", action(verb::change::add))
        .route("/api/remove", action(verb::change::remove))
        .route("/api/export", action(verb::export::run))
        .route("/api/verify", action(verb::verify::run))
        .route("/api/plan", action(verb::plan::run))
        .route("/api/reveal", action(verb::reveal::run));
    for (path, kind, text) in assets::ALL {
        router = router.route(path, get(|| async { ([(header::CONTENT_TYPE, *kind)], *text) }));
    }
    router.layer(from_fn_with_state(guard, judged)).with_state(shared)
}

/// Lets a request pass, or says why not; either way tells the browser what the answer may be used for.
async fn judged(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let mut response = match guard.judge(request.uri().path(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err((status, why)) => Refusal { status, failure: Failure::new(why) }.into_response(),
    };
    seal(response.headers_mut());
    response
}

async fn state(State(shared): State<Arc<Shared>>) -> Response {
    json(&super::view::state(&shared.session()))
}

/// A verb: its request as JSON, nothing but consent or refusal in return. What comes of it is in the state.
fn action<R>(run: fn(&Arc<Shared>, R) -> Result<(), Refusal>) -> MethodRouter<Arc<Shared>>
where
    R: DeserializeOwned + Send + 'static,
{
    post(move |State(shared): State<Arc<Shared>>, body: Bytes| async move {
        let acted = tokio::task::spawn_blocking(move || {
            let request = serde_json::from_slice(&body).map_err(|error| Refusal {
                status: StatusCode::BAD_REQUEST,
                failure: Failure::new(format_args!("not understood: {error}")),
            })?;
            run(&shared, request)
        });
        match acted.await {
            Ok(Ok(())) => StatusCode::NO_CONTENT.into_response(),
            Ok(Err(refusal)) => refusal.into_response(),
            Err(error) => {
                let failure = Failure::new(error);
                Refusal { status: StatusCode::INTERNAL_SERVER_ERROR, failure }.into_response()
            }
        }
    })
}
