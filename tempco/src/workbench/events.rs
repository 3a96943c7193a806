//! News as it comes, as server-sent events: that the state has changed, and what work tells meanwhile.

use super::shared::Shared;
use axum::extract::State;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::unfold;
use serde_json::json;
use std::collections::HashMap;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;

/// News that come closer together are told together.
const TOGETHER: Duration = Duration::from_millis(60);

/// What one listener knows already.
struct Listener {
    shared: Arc<Shared>,
    bell: watch::Receiver<u64>,
    version: Option<u64>,
    /// Of each job so many reports.
    heard: HashMap<u64, usize>,
    /// Told one by one.
    waiting: Vec<Event>,
}

/// `GET /api/events`
pub async fn answer(State(shared): State<Arc<Shared>>) -> Response {
    let bell = shared.bell();
    let listener = Listener { shared, bell, version: None, heard: HashMap::new(), waiting: Vec::new() };
    let stream = unfold(listener, |mut listener| async move {
        let event = listener.next().await?;
        Some((Ok::<_, Infallible>(event), listener))
    });
    Sse::new(stream).keep_alive(KeepAlive::default()).into_response()
}

impl Listener {
    async fn next(&mut self) -> Option<Event> {
        loop {
            if let Some(event) = self.waiting.pop() {
                return Some(event);
            }
            self.listen();
            if self.waiting.is_empty() {
                self.bell.changed().await.ok()?;
                tokio::time::sleep(TOGETHER).await;
            }
        }
    }

    /// Collects what is new, the last thing to tell first.
    fn listen(&mut self) {
        self.bell.mark_unchanged();
        let (version, jobs) = {
            let session = self.shared.session();
            (session.version, session.told_by())
        };
        if self.version.replace(version) != Some(version) {
            self.waiting.push(Event::default().event("state").data(version.to_string()));
        }
        for job in jobs {
            let heard = self.heard.entry(job.number).or_default();
            let reports = job.reports(*heard);
            if !reports.is_empty() {
                let data = json!({ "job": job.number, "from": *heard, "reports": reports });
                *heard += reports.len();
                self.waiting.push(Event::default().event("reports").data(data.to_string()));
            }
        }
    }
}
