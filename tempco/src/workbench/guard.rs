//! Who may drive the workbench: the page that the terminal's own address opened, and nobody else.
//!
//! The address carries a random token behind `#`, where no server, log or referrer sees it; the page sends it back in a
//! header, which no other page can do. A cookie would not serve: cookies are shared by all ports of a host. The `Host`
//! must be ours, so that a foreign name that resolves to this computer gets nothing, and so must the `Origin`.

use crate::failure::Failure;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use std::fmt::Write;

/// The header that carries the token.
pub const TOKEN_HEADER: &str = "x-tempco-token";

/// Bytes of randomness in a token.
const TOKEN_BYTES: usize = 32;

/// What the page may do: load its own files, and talk to its own server.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Judges requests.
#[derive(Clone)]
pub struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// A guard of this port with a new token.
    pub fn new(port: u16) -> Result<Self, Failure> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes)
            .map_err(|error| Failure::new(format_args!("no randomness for a token: {error}")))?;
        let token = bytes.iter().fold(String::new(), |mut token, byte| {
            let _ = write!(token, "{byte:02x}");
            token
        });
        Ok(Self { token, port })
    }

    /// The address to open.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/#{}", self.port, self.token)
    }

    /// Whether a request may pass. The page's own files hold no secret, everything below `/api/` needs the token.
    pub fn judge(&self, path: &str, headers: &HeaderMap) -> Result<(), (StatusCode, &'static str)> {
        let text = |name: HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or_default());
        if !text(header::HOST).is_some_and(|host| self.is_own(host)) {
            return Err((StatusCode::MISDIRECTED_REQUEST, "this server answers to 127.0.0.1 only"));
        }
        let own_origin = |origin: &str| origin.strip_prefix("http://").is_some_and(|host| self.is_own(host));
        if text(header::ORIGIN).is_some_and(|origin| !own_origin(origin)) {
            return Err((StatusCode::FORBIDDEN, "another page may not ask this"));
        }
        let site = headers.get("sec-fetch-site").map(|site| site.to_str().unwrap_or_default());
        if path.starts_with("/api/") && site.is_some_and(|site| site != "same-origin") {
            return Err((StatusCode::FORBIDDEN, "another page may not ask this"));
        }
        let token = headers.get(TOKEN_HEADER).map_or(&[][..], HeaderValue::as_bytes);
        if path.starts_with("/api/") && !same(token, self.token.as_bytes()) {
            return Err((StatusCode::UNAUTHORIZED, "open the address that `tempco workbench` printed"));
        }
        Ok(())
    }

    fn is_own(&self, host: &str) -> bool {
        host.rsplit_once(':')
            .is_some_and(|(name, port)| (name == "127.0.0.1" || name == "localhost") && port.parse() == Ok(self.port))
    }
}

/// Compares in a time that doesn't tell where they differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

/// Tells the browser what the page may do, and to keep nothing.
pub fn seal(headers: &mut HeaderMap) {
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PORT: u16 = 4321;

    fn judged(path: &str, headers: &[(&str, &str)]) -> u16 {
        let guard = Guard { token: "secret".to_owned(), port: PORT };
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.insert(HeaderName::from_bytes(name.as_bytes()).expect("a name"), value.parse().expect("a value"));
        }
        guard.judge(path, &map).map_or_else(|(status, _)| status.as_u16(), |()| 200)
    }

    #[test]
    fn only_the_own_page_with_the_token_may_ask() {
        let (host, token) = (("host", "127.0.0.1:4321"), ("x-tempco-token", "secret"));
        for (path, headers, status) in [
            ("/", &[host][..], 200),
            ("/", &[("host", "localhost:4321")], 200),
            ("/", &[], 421),
            ("/", &[("host", "127.0.0.1:80")], 421),
            ("/", &[("host", "127.0.0.1")], 421),
            ("/", &[("host", "evil.example:4321")], 421),
            ("/", &[host, ("origin", "http://evil.example")], 403),
            ("/", &[host, ("origin", "null")], 403),
            ("/api/state", &[host], 401),
            ("/api/state", &[host, token], 200),
            ("/api/state", &[host, ("x-tempco-token", "secreu")], 401),
            ("/api/state", &[host, ("x-tempco-token", "secret2")], 401),
            ("/api/state", &[host, token, ("origin", "http://127.0.0.1:4321")], 200),
            ("/api/state", &[host, token, ("origin", "https://127.0.0.1:4321")], 403),
            ("/api/state", &[host, token, ("origin", "http://127.0.0.1:4322")], 403),
            ("/api/state", &[host, token, ("sec-fetch-site", "same-origin")], 200),
            ("/api/state", &[host, token, ("sec-fetch-site", "same-site")], 403),
            ("/api/state", &[("host", "evil.example"), token], 421),
        ] {
            assert_eq!(judged(path, headers), status, "{path} {headers:?}");
        }
    }

    #[test]
    fn no_two_tokens_are_alike() {
        let urls: Vec<String> = (0..3).map(|_| Guard::new(PORT).expect("randomness").url()).collect();
        assert!(urls[0] != urls[1] && urls[1] != urls[2] && urls[0].len() == "http://127.0.0.1:4321/#".len() + 64);
    }
}
