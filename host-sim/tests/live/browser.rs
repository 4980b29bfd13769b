//! The page in a real browser: what is drawn, what a click does, a server that comes back.
//!
//! Needs Chromium, so it is ignored by default; `tests/run --full` installs it. The browser is
//! driven over its debugging port: a websocket too. Pictures go to the test's folder below
//! `target/tmp`, with `BLESS=1` also to `docs/`.

use core::time::Duration;
use std::io::{BufRead as _, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Instant;

use host_sim::link::loopback::loopback;
use host_sim::live::{About, Ask, Limits, Live};
use host_sim::report::Report;
use host_sim::trial::mission;
use host_sim::world::World;
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use crate::{client, mission as usual, open};

const PATIENCE: Duration = Duration::from_secs(120);
/// Colours of `draw.js`.
const FREE: [u8; 3] = [255, 255, 255];
const OBSTACLE: [u8; 3] = [29, 35, 43];
const UNKNOWN: [u8; 3] = [205, 211, 218];
const BELIEVED: [u8; 3] = [0, 103, 165];
const SKELETON: [u8; 3] = [111, 176, 216];

/// A browser with one page.
struct Browser {
    process: Child,
    socket: WebSocket<TcpStream>,
    number: u64,
    _profile: tempfile::TempDir,
}

impl Browser {
    fn open(url: &str) -> Self {
        let profile = tempfile::tempdir().expect("a folder");
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let mut started = names.iter().filter_map(|name| {
            Command::new(name)
                .args([
                    "--headless=new",
                    "--no-sandbox",
                    "--disable-gpu",
                    "--hide-scrollbars",
                ])
                .arg("--remote-debugging-port=0")
                .arg(format!("--user-data-dir={}", profile.path().display()))
                .arg("about:blank")
                .stderr(Stdio::piped())
                .stdout(Stdio::null())
                .spawn()
                .ok()
        });
        let mut process = started
            .next()
            .expect("install it: apt-get install -y chromium");
        let lines = BufReader::new(process.stderr.take().expect("stderr")).lines();
        let mut lines = lines.map_while(Result::ok);
        let at = lines.find_map(|line| {
            let at = line.strip_prefix("DevTools listening on ws://")?;
            Some(at.split_once('/')?.0.to_owned())
        });
        let at = at.expect("a debugging port").parse().expect("an address");
        // The rest of what it says must not fill the pipe.
        thread::spawn(move || lines.for_each(drop));
        let head = format!("GET /json/list HTTP/1.1\r\nHost: {at}\r\nConnection: close\r\n\r\n");
        let begun = Instant::now();
        let path = loop {
            assert!(begun.elapsed() < PATIENCE, "no page");
            let answer = client::say_whole(at, &head);
            let pages: Value = serde_json::from_str(&answer).unwrap_or_default();
            let mut pages = pages.as_array().into_iter().flatten();
            let page = pages.find(|page| page["type"] == "page");
            if let Some(url) = page.and_then(|page| page["webSocketDebuggerUrl"].as_str()) {
                break url.to_owned();
            }
            thread::sleep(Duration::from_millis(100));
        };
        let stream = TcpStream::connect(at).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let (socket, _) = tungstenite::client::client(client::request(&path, at, None), stream)
            .expect("a debugging socket");
        let mut browser = Self {
            process,
            socket,
            number: 0,
            _profile: profile,
        };
        browser.call("Page.navigate", json!({ "url": url }));
        browser.until("typeof history_ === 'object' && history_.steps.length > 0");
        browser
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.number += 1;
        let call = json!({ "id": self.number, "method": method, "params": params });
        self.socket
            .send(Message::text(call.to_string()))
            .expect("sent");
        loop {
            let message = self.socket.read().expect("an answer");
            let Message::Text(text) = message else {
                continue;
            };
            let answer: Value = serde_json::from_str(&text).expect("JSON");
            if answer["id"] == self.number {
                return answer["result"].clone();
            }
        }
    }

    fn ask(&mut self, script: &str) -> Value {
        let params = json!({ "expression": script, "returnByValue": true });
        self.call("Runtime.evaluate", params)["result"]["value"].clone()
    }

    fn until(&mut self, script: &str) {
        let begun = Instant::now();
        while self.ask(script) != json!(true) {
            assert!(begun.elapsed() < PATIENCE, "never: {script}");
            thread::sleep(Duration::from_millis(50));
        }
    }

    fn size(&mut self, width: u32, height: u32, scale: f64, mobile: bool) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": scale,
            "mobile": mobile });
        self.call("Emulation.setDeviceMetricsOverride", size);
        self.ask("isDirty = true");
        // Two frames: one may be under way.
        thread::sleep(Duration::from_millis(500));
    }

    /// Takes a picture, as bytes of a PNG.
    fn picture(&mut self, name: &str) -> Vec<u8> {
        let taken = self.call("Page.captureScreenshot", json!({}));
        let bytes = unpacked(taken["data"].as_str().expect("a picture"));
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("live");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join(name), &bytes).expect("written");
        bytes
    }

    fn click(&mut self, x: f64, y: f64) {
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Decodes base64.
fn unpacked(text: &str) -> Vec<u8> {
    let value = |byte: u8| match byte {
        b'A'..=b'Z' => Some(byte - b'A'),
        b'a'..=b'z' => Some(byte - b'a' + 26),
        b'0'..=b'9' => Some(byte - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let digits: Vec<u8> = text.bytes().filter_map(value).collect();
    let parts = digits.chunks(4).flat_map(|four| {
        let bits = four
            .iter()
            .fold(0u32, |sum, digit| sum << 6 | u32::from(*digit));
        let bits = bits << (6 * (4 - four.len()));
        let [_, a, b, c] = bits.to_be_bytes();
        [a, b, c].into_iter().take(four.len() - 1)
    });
    parts.collect()
}

/// Counts the pixels of a colour, within some levels of each channel.
fn pixels(picture: &[u8], colour: [u8; 3]) -> usize {
    let decoder = png::Decoder::new(std::io::Cursor::new(picture));
    let mut reader = decoder.read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a picture");
    let samples = info.color_type.samples();
    let near = |pixel: &&[u8]| pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= 6);
    bytes[..info.buffer_size()]
        .chunks_exact(samples)
        .filter(near)
        .count()
}

/// Makes a run of the office.
fn office(live: &Live) -> Report {
    let about = About {
        world: "office".into(),
        strategy: "frontier".into(),
        link: "loopback".into(),
        seed: 0,
    };
    let mut observer = live.observer(about, || false);
    let world = World::builtin("office").expect("a world");
    let run = mission::explore(&usual(), &world, &mut loopback(), &mut observer);
    let (report, _) = run.expect("a run");
    observer.end(&report);
    report
}

#[test]
#[ignore = "needs chromium"]
fn browser_shows_map_and_robot_at_the_end_and_back_in_time() {
    let live = open(Limits::default());
    office(&live);
    let mut browser = Browser::open(&live.url());
    browser.until("history_.end !== null");
    browser.size(1280, 800, 1.0, false);
    let whole = browser.picture("desktop.png");
    // Of 800 × 900 pixels of the map: rooms, walls, and the robot with its way.
    let [free, walls] = [FREE, OBSTACLE].map(|colour| pixels(&whole, colour));
    assert!(
        free > 300_000 && walls > 8_000,
        "{free} free, {walls} walls"
    );
    assert!(pixels(&whole, BELIEVED) > 200 && pixels(&whole, SKELETON) > 500);
    assert_eq!(
        browser.ask("$('status').textContent"),
        json!("finished: explored")
    );
    assert_eq!(browser.ask("$('known').textContent"), json!("99.9 %"));
    browser.ask("seek(Math.floor(history_.steps.length / 4))");
    thread::sleep(Duration::from_millis(500));
    let early = browser.picture("back-in-time.png");
    assert!(pixels(&early, UNKNOWN) > pixels(&whole, UNKNOWN) + 100_000);
    browser.ask("seek(history_.steps.length)");
    thread::sleep(Duration::from_millis(500));
    assert!(pixels(&browser.picture("desktop.png"), FREE).abs_diff(free) < 500);
    browser.size(390, 844, 2.0, true);
    let phone = browser.picture("phone.png");
    assert!(pixels(&phone, OBSTACLE) > 4_000);
    let fits = browser.ask("document.documentElement.scrollWidth <= window.innerWidth");
    assert_eq!(fits, json!(true), "nothing is wider than a phone");
    if std::env::var_os("BLESS").is_some() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/live.png");
        std::fs::write(docs, &whole).expect("written");
    }
}

#[test]
#[ignore = "needs chromium"]
fn browser_click_takes_the_robot_to_a_place() {
    let live = open(Limits::default());
    live.ask(Ask::Speed { factor: 2.0 }).expect("a pace");
    let report = thread::scope(|scope| {
        let run = scope.spawn(|| office(&live));
        let mut browser = Browser::open(&live.url());
        browser.size(1280, 800, 1.0, false);
        browser.until("history_.steps.length > 20");
        browser.picture("running.png");
        browser.ask("$('go-to').click()");
        let place = "(() => { const at = history_.steps[history_.at].believed, box = \
                     $('map').getBoundingClientRect(), to = view.spot(at[0] - 0.8, at[1]); \
                     return [box.left + to[0], box.top + to[1]]; })()";
        let place = browser.ask(place);
        browser.click(place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
        browser.until("history_.notes.some(note => note.request.startsWith('go to') && note.done)");
        browser.ask("setSpeed(1)");
        browser.until("history_.marks.some(mark => mark[1] === 'arrived(goal)')");
        thread::sleep(Duration::from_millis(300));
        browser.picture("arrived.png");
        // The server of a page that is asked to stop asks once more.
        browser.ask("$('stop').click()");
        browser.ask("$('stop').click()");
        run.join().expect("a run")
    });
    assert_eq!(report.outcome.reason, "stopped");
    assert!(
        report
            .live_requests
            .iter()
            .any(|it| it.request.starts_with("go to") && it.done)
    );
}

#[test]
#[ignore = "needs chromium"]
fn browser_keeps_the_history_and_comes_back() {
    let live = open(Limits::default());
    let address = live.address();
    let mut observer = live.observer(About::default(), || false);
    let world = World::builtin(crate::WORLD).expect("a world");
    let run = mission::explore(&usual(), &world, &mut loopback(), &mut observer);
    observer.end(&run.expect("a run").0);
    let mut browser = Browser::open(&live.url());
    browser.until("history_.end !== null");
    drop((observer, live));
    browser.until("$('link-state').textContent === 'not connected'");
    assert_eq!(browser.ask("history_.steps.length > 100"), json!(true));
    let again = Live::open(address, 0.0, Limits::default()).expect("the port");
    let mut observer = again.observer(About::default(), || false);
    observer.fail("another run");
    browser.until("history_.end !== null && history_.end.headline === 'another run'");
    assert_eq!(browser.ask("history_.steps.length"), json!(0));
}
