//! A team of processes on this machine: three robots over UDP, one killed and started again.

use core::time::Duration;
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::Value;

const KEY: &str = "a key for the test only";

/// Ports that are free at the moment.
fn ports() -> [u16; 3] {
    let sockets = [(); 3].map(|()| UdpSocket::bind("127.0.0.1:0").expect("a port"));
    sockets.map(|socket| socket.local_addr().expect("an address").port())
}

fn team(id: usize, ports: &[u16; 3], key: &Path) -> String {
    let others = (0..3).filter(|k| *k != id);
    let peers: Vec<String> = others.map(|k| format!("127.0.0.1:{}", ports[k])).collect();
    format!(
        "id={id},bind=127.0.0.1:{},peers={},key={},pace=6",
        ports[id],
        peers.join("+"),
        key.display()
    )
}

fn start(folder: &Path, world: &str, id: usize, spec: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .current_dir(folder)
        .args(["explore", world, "--json", "--link", "direct"])
        .args([
            "--time-limit",
            "300",
            "--team",
            spec,
            "--seed",
            &id.to_string(),
            // Each process has a world of its own; the robots keep off each other by beacons.
            "--start",
            &id.to_string(),
        ])
        .args(["--out", &format!("robot-{id}")])
        .args(recording(id))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

/// Two of the robots are recorded; a file of the one that is killed would be in its way.
fn recording(id: usize) -> Vec<String> {
    if cfg!(feature = "record") && id < 2 {
        return vec!["--record".into(), format!("robot-{id}.mcap")];
    }
    Vec::new()
}

/// A device does again what this robot's did, with all that the robot heard and said.
fn replays(folder: &Path, id: usize) {
    let Some(file) = recording(id).pop() else {
        return;
    };
    let mut replay = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    replay.current_dir(folder).args(["replay", &file, "--json"]);
    let output = replay.output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{told}");
}

fn report(child: Child) -> Value {
    let output = child.wait_with_output().expect("it ends");
    serde_json::from_slice(&output.stdout).expect("a report")
}

fn count(report: &Value, key: &str) -> u64 {
    report["network"][key].as_u64().expect(key)
}

#[test]
fn three_processes_are_a_team_and_one_is_killed_and_started_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, ports) = (folder.path(), ports());
    let key = folder.join("key");
    std::fs::write(&key, KEY).expect("written");
    let begin = |id: usize| start(folder, "office", id, &team(id, &ports, &key));
    let [zero, one, mut two] = [0, 1, 2].map(begin);
    std::thread::sleep(Duration::from_millis(4_000));
    two.kill().expect("killed");
    two.wait().expect("ended");
    // Strangers and garbage, while the robots drive.
    let stranger = UdpSocket::bind("127.0.0.1:0").expect("a port");
    for k in 0..200_u8 {
        let mut bytes = vec![b'F', b'L', 1, 0, 1];
        bytes.extend([k; 60]);
        for (port, length) in [
            (ports[0], 65),
            (ports[0], usize::from(k % 40)),
            (ports[1], 0),
        ] {
            let sent = stranger.send_to(&bytes[..length], ("127.0.0.1", port));
            sent.expect("sent");
        }
    }
    let two = begin(2);
    let reports = [zero, one, two].map(report);
    for report in &reports {
        let status = report["outcome"]["status"].as_str();
        assert!(
            matches!(status, Some("finished" | "time-limit")),
            "{report}"
        );
        assert_eq!(report["safety"]["collisions"], 0, "{report}");
        assert!(
            count(report, "said") > 100 && count(report, "heard") > 50,
            "{report}"
        );
        assert_eq!(
            count(report, "replayed") + count(report, "foreign"),
            0,
            "{report}"
        );
    }
    for id in [0, 1] {
        replays(folder, id);
    }
    assert!(count(&reports[0], "unauthentic") > 100, "{}", reports[0]);
    assert!(count(&reports[0], "malformed") > 100, "{}", reports[0]);
    assert!(count(&reports[1], "malformed") > 100, "{}", reports[1]);
    assert_eq!(count(&reports[2], "malformed"), 0, "{}", reports[2]);
}
