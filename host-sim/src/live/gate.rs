//! Who may come in: the request line and headers of a connection, judged.
//!
//! | check | against | else |
//! | --- | --- | --- |
//! | the path is `/` or `/ws` | | 404 |
//! | the token, on another address than loopback | strangers in the network | 403 |
//! | `Host` is an IP address or `localhost`, or there is a token | DNS rebinding | 403 |
//! | `Origin` of a websocket is `http://` and the `Host` | scripts of foreign pages | 403 |

use core::net::IpAddr;

use sha2::{Digest as _, Sha256};
use tungstenite::handshake::server::Request;
use tungstenite::http::StatusCode;
use tungstenite::http::header::{HOST, HeaderName, ORIGIN};

/// What a visitor may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// The page.
    Page,
    /// A websocket.
    Socket,
}

/// Judges a request. `token` is what its address must hold; `None` on loopback.
///
/// # Errors
/// The status of the refusal.
pub(super) fn judge(request: &Request, token: Option<&str>) -> Result<Pass, StatusCode> {
    let pass = match request.uri().path() {
        "/" => Pass::Page,
        "/ws" => Pass::Socket,
        _ => return Err(StatusCode::NOT_FOUND),
    };
    if token.is_some_and(|token| !has_token(request, token)) {
        return Err(StatusCode::FORBIDDEN);
    }
    let host = header(request, &HOST).ok_or(StatusCode::BAD_REQUEST)?;
    if token.is_none() && !is_address(host) {
        return Err(StatusCode::FORBIDDEN);
    }
    let own = format!("http://{host}");
    if pass == Pass::Socket && header(request, &ORIGIN) != Some(own.as_str()) {
        return Err(StatusCode::FORBIDDEN);
    }
    Ok(pass)
}

/// Returns the text of a header that comes once.
fn header<'a>(request: &'a Request, name: &HeaderName) -> Option<&'a str> {
    let mut all = request.headers().get_all(name).iter();
    let first = all.next()?.to_str().ok()?;
    all.next().is_none().then_some(first)
}

/// Returns true if the address has the token. Its digests are compared, so the time tells nothing.
fn has_token(request: &Request, token: &str) -> bool {
    let query = request.uri().query().unwrap_or_default();
    let given = query
        .split('&')
        .find_map(|part| part.strip_prefix("token="));
    given.is_some_and(|given| Sha256::digest(given) == Sha256::digest(token))
}

/// Returns true if a host, with or without a port, is an IP address or `localhost`.
fn is_address(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let inner = name.strip_prefix('[').and_then(|it| it.strip_suffix(']'));
    name == "localhost" || inner.unwrap_or(name).parse::<IpAddr>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tungstenite::handshake::machine::TryParse as _;

    fn judged(text: &str, token: Option<&str>) -> Result<Pass, u16> {
        let (_, request) = Request::try_parse(format!("{text}\r\n\r\n").as_bytes())
            .expect("a request")
            .expect("whole");
        judge(&request, token).map_err(|status| status.as_u16())
    }

    #[test]
    fn the_page_is_for_whoever_comes_by_its_address() {
        let page = "GET / HTTP/1.1\r\nHost: 127.0.0.1:8047";
        assert_eq!(judged(page, None), Ok(Pass::Page));
        assert_eq!(
            judged("GET / HTTP/1.1\r\nHost: [::1]:80", None),
            Ok(Pass::Page)
        );
        assert_eq!(
            judged("GET / HTTP/1.1\r\nHost: localhost", None),
            Ok(Pass::Page)
        );
        assert_eq!(judged("GET /x HTTP/1.1\r\nHost: localhost", None), Err(404));
        assert_eq!(judged("GET / HTTP/1.1", None), Err(400));
        let twice = "GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example";
        assert_eq!(judged(twice, None), Err(400));
    }

    #[test]
    fn a_foreign_name_for_this_address_is_refused() {
        let bound = "GET /ws HTTP/1.1\r\nHost: evil.example:8047\r\n\
                     Origin: http://evil.example:8047";
        assert_eq!(judged(bound, None), Err(403));
    }

    #[test]
    fn a_socket_is_for_the_own_page_only() {
        let socket = |origin: &str| {
            let text = format!("GET /ws HTTP/1.1\r\nHost: 127.0.0.1:8047{origin}");
            judged(&text, None)
        };
        assert_eq!(
            socket("\r\nOrigin: http://127.0.0.1:8047"),
            Ok(Pass::Socket)
        );
        for origin in [
            "http://127.0.0.1:80",
            "https://127.0.0.1:8047",
            "null",
            "http://a.b",
        ] {
            assert_eq!(
                socket(&format!("\r\nOrigin: {origin}")),
                Err(403),
                "{origin}"
            );
        }
        assert_eq!(socket(""), Err(403));
    }

    #[test]
    fn a_token_must_be_whole() {
        let page = |query: &str| {
            let text = format!("GET /{query} HTTP/1.1\r\nHost: lab.example:8047");
            judged(&text, Some("secret"))
        };
        assert_eq!(page("?token=secret"), Ok(Pass::Page));
        assert_eq!(page("?a=b&token=secret"), Ok(Pass::Page));
        for bad in [
            "",
            "?token=",
            "?token=secre",
            "?token=secrets",
            "?tokens=secret",
        ] {
            assert_eq!(page(bad), Err(403), "{bad}");
        }
    }
}
