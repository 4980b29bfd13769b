//! The page, as one HTML document: its parts are files of `page/`, put together when this is built.
//!
//! It asks for nothing but itself and its websocket, and its policy forbids the rest.

/// The page.
pub(super) const PAGE: &str = concat!(
    include_str!("page/head.html"),
    "<style>\n",
    include_str!("page/style.css"),
    "</style>\n</head>\n",
    include_str!("page/body.html"),
    "<script>\n\"use strict\";\n",
    include_str!("page/history.js"),
    include_str!("page/draw.js"),
    include_str!("page/panel.js"),
    include_str!("page/main.js"),
    "</script>\n</body>\n</html>\n",
);

/// Headers of the page: nothing from elsewhere, no frame of another page, no address told on.
pub(super) const HEADERS: &str = "Content-Type: text/html; charset=utf-8\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; \
    style-src 'unsafe-inline'; img-src data:; connect-src 'self'; base-uri 'none'; \
    form-action 'none'; frame-ancestors 'none'\r\n\
    X-Frame-Options: DENY\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n";

#[cfg(test)]
mod tests {
    use super::PAGE;

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        for foreign in ["http://", "https://", "src=\"", "@import", "url(", "fetch("] {
            assert!(!PAGE.contains(foreign), "{foreign}");
        }
    }
}
