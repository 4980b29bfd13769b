//! The report of a team's run: the keys of a single run for the team as a whole, and each robot's
//! own report.

use serde::{Deserialize, Serialize};

use super::Report;
use crate::radio::Traffic;

/// A team's run, as in `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TeamReport {
    /// The team as a whole, with the keys of a single run.
    #[serde(flatten)]
    pub whole: Report,
    /// What only a team has.
    pub team: Team,
    /// The radio.
    pub radio: Radio,
    /// Each robot's own report, in the order of their numbers.
    pub robots: Vec<Robot>,
}

/// What only a team has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Team {
    /// Number of robots.
    pub robots: usize,
    /// `side-by-side` or `apart`.
    pub starts: String,
    /// Who left and joined, as in `leave 2@90`.
    pub timetable: Vec<String>,
    /// Share of the path of all robots that another robot had driven before.
    pub driven_after_another: f64,
    /// Share of the known ground that more than one robot measured.
    pub measured_twice: f64,
    /// Least distance between the hulls of two robots, metres; `null` from 1 m on.
    pub min_robot_gap_m: Option<f64>,
    /// True if the maps of all robots that are in the team at the end are equal, cell for cell;
    /// `null` if they do not talk.
    pub maps_equal: Option<bool>,
    /// Standard deviations of the starts that all robots but the first were told: metres, degrees;
    /// `null` if they were right.
    pub start_error: Option<[f64; 2]>,
    /// How well the robots' maps agree once their robots have met; `null` without a correction of
    /// odometry, and if none met another.
    pub agreement: Option<Agreement>,
}

/// The error of the motion between the maps of two robots, over all pairs and steps after they met.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Median of the distance, metres, at the place of the robot with the greater number.
    pub median_m: f64,
    /// Greatest distance.
    pub max_m: f64,
    /// Median of the angle, degrees.
    pub median_deg: f64,
    /// Greatest angle.
    pub max_deg: f64,
}

/// The radio of a team.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Radio {
    /// Its specification, as given to `--radio`; `off` if the robots do not talk.
    pub spec: String,
    /// What it did until the team had ended.
    #[serde(flatten)]
    pub traffic: Traffic,
}

/// One robot of a team.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// Its number, from 0.
    pub robot: usize,
    /// Its start in the world: x and y in metres, yaw in radians.
    pub start_pose: [f64; 3],
    /// Number of its sessions: 1 and one for each time that it joined again.
    pub boots: u16,
    /// Packets that it said.
    pub said: u64,
    /// Bytes of those packets in the air.
    pub said_bytes: u64,
    /// Packets that it heard.
    pub heard: u64,
    /// Share of the explorable ground on its own map at the end, what it heard included; `null` if
    /// the map could not be read.
    pub map_fraction: Option<f64>,
    /// Seconds after which its map lay in the team's coordinates; `null` if it never did, and
    /// without talking.
    pub met_s: Option<f64>,
    /// Its own report: what it measured, drove and touched itself.
    #[serde(flatten)]
    pub report: Report,
}

impl TeamReport {
    /// Returns the text of the file: indented JSON and a newline.
    #[must_use]
    pub fn to_json_pretty(&self) -> String {
        super::json_pretty(self)
    }

    /// Returns the report on one line, without a newline.
    #[must_use]
    pub fn to_json_line(&self) -> String {
        super::json_line(self)
    }

    /// Returns world, strategy, number of robots and seed on one line.
    #[must_use]
    pub fn headline(&self) -> String {
        let starts = self.team.starts.replace('-', " ");
        format!(
            "{} · {} robots {starts} · radio {}",
            self.whole.headline(),
            self.team.robots,
            self.radio.spec
        )
    }

    /// Returns the summary of the run, several lines.
    #[must_use]
    pub fn to_text(&self) -> String {
        let whole = self.whole.to_text();
        let (first, rest) = whole.split_once('\n').unwrap_or((&whole, ""));
        let contacts = self.whole.safety.robot_contacts.unwrap_or(0);
        let gap = match self.team.min_robot_gap_m {
            Some(gap_m) => format!("{gap_m:.3} m"),
            None => "1 m or more".into(),
        };
        let traffic = &self.radio.traffic;
        let equal = match self.team.maps_equal {
            Some(true) => "; maps equal at the end",
            Some(false) => "; maps differ at the end",
            None => "",
        };
        let mut lines = vec![
            first.to_owned(),
            format!(
                "  team      {} robots {}, {contacts} contacts, least gap {gap}; \
                 driven after another {:.0} %, measured twice {:.0} %",
                self.team.robots,
                self.team.starts.replace('-', " "),
                self.team.driven_after_another * 100.0,
                self.team.measured_twice * 100.0,
            ),
            format!(
                "  radio     {}: {} packets, {:.1} kB; {} lost, {} out of reach{equal}",
                self.radio.spec,
                traffic.sent,
                traffic.sent_bytes as f64 / 1e3,
                traffic.lost,
                traffic.out_of_reach,
            ),
            rest.to_owned(),
        ];
        if let Some(agreement) = &self.team.agreement {
            lines.push(format!(
                "  maps      {:.2} m and {:.1}° from each other in the median, {:.2} m and {:.1}° \
                 at most",
                agreement.median_m, agreement.median_deg, agreement.max_m, agreement.max_deg,
            ));
        }
        for robot in &self.robots {
            let left = match robot.report.outcome.status.as_str() {
                "finished" => robot.report.outcome.reason.clone(),
                status => format!("{status} ({})", robot.report.outcome.reason),
            };
            lines.push(format!(
                "  robot {}   {left} after {:.0} s and {:.1} m, measured {:.1} %",
                robot.robot,
                robot.report.sim_time_s,
                robot.report.path_length_m,
                robot.report.coverage.fraction * 100.0,
            ));
            if let Some(slam) = &robot.report.slam {
                lines.push(format!("    graph   {slam}"));
            }
        }
        lines.join("\n")
    }
}
