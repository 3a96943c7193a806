//! Nobody but the page that the terminal's own address opened may drive the workbench.

use super::served::Served;
use std::net::TcpStream;

#[test]
fn strangers_get_nothing() {
    let served = Served::small();
    let port = served.port;
    let (host, token) = (format!("Host: 127.0.0.1:{port}\r\n"), served.token_header());
    let wrong = format!("x-tempco-token: {}\r\n", "0".repeat(64));
    let foreign = "Host: evil.example\r\n";
    let other_page = "Origin: http://evil.example\r\n";
    let other_port = "Origin: http://127.0.0.1:1\r\n";
    let own_page = format!("Origin: http://127.0.0.1:{port}\r\n");
    for (headers, status) in [
        (format!("{host}{token}"), 200),
        (format!("{host}{token}{own_page}"), 200),
        (host.clone(), 401),
        (format!("{host}{wrong}"), 401),
        (format!("{foreign}{token}"), 421),
        (format!("{host}{token}{other_page}"), 403),
        (format!("{host}{token}{other_port}"), 403),
        (format!("{host}{token}Sec-Fetch-Site: same-site\r\n"), 403),
    ] {
        let answer = served.say("GET", "/api/state", &headers, b"");
        assert_eq!(answer.status, status, "{headers}");
        if status != 200 {
            let text = String::from_utf8_lossy(&answer.body).into_owned();
            assert!(text.contains("message") && !text.contains("campaign"), "{text}");
        }
    }
    // A verb is as closed as a look, and a question before it is not answered with leave.
    assert_eq!(served.say("POST", "/api/train", &host, b"{}").status, 401);
    let preflight = format!("{host}{other_page}Access-Control-Request-Method: POST\r\n");
    let answer = served.say("OPTIONS", "/api/train", &preflight, b"");
    assert_eq!(answer.status, 403);
    assert!(!answer.head.contains("access-control"), "{}", answer.head);
    assert_eq!(served.state()["models"].as_array().map(Vec::len), Some(0));
}

#[test]
fn it_listens_on_one_address_of_this_computer_only() {
    let served = Served::small();
    assert!(TcpStream::connect(("127.0.0.1", served.port)).is_ok());
    assert!(TcpStream::connect(("127.0.0.2", served.port)).is_err());
}

#[test]
fn every_answer_says_what_the_page_may_do() {
    let served = Served::small();
    let host = format!("Host: 127.0.0.1:{}\r\n", served.port);
    for path in ["/", "/app.js", "/charts.js", "/style.css", "/steps/train.js", "/api/state", "/nowhere"] {
        let answer = served.say("GET", path, &host, b"");
        for header in [
            "content-security-policy: default-src 'none'; script-src 'self'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-store",
        ] {
            assert!(answer.head.contains(header), "{path}: {}", answer.head);
        }
        assert!(!answer.head.contains("access-control-allow"), "{path}: {}", answer.head);
        assert!(!answer.head.contains("set-cookie"), "{path}: {}", answer.head);
    }
}
