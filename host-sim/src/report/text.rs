//! The report as a few lines of text.

use fieldline_cycles::{CLOCK_HZ, milliseconds};

use super::{GivenUp, LoopClosing, Loops, Report};

/// Least share of the ground that an explored run has truly seen.
const LEAST_SEEN: f64 = 0.97;
/// Share of the walls by which the map may have less of them than of the floor. Corners and the far
/// sides of posts are not seen by every run.
const MISSING_WALLS: f64 = 0.15;

impl Report {
    /// Returns world, strategy, uneven ground and seed on one line.
    #[must_use]
    pub fn headline(&self) -> String {
        let ground = match self.ground.as_str() {
            "flat" => String::new(),
            ground => format!(" · {ground} ground"),
        };
        let (world, strategy, seed) = (&self.world, &self.strategy, self.seed);
        format!("{world} · {strategy}{ground} · seed {seed}")
    }

    /// Returns end, coverage, time and path length on one line.
    #[must_use]
    pub fn in_short(&self) -> String {
        format!(
            "{}, {:.1} % of {:.0} m² known after {} min and {:.1} m",
            self.ending(),
            self.coverage.fraction * 100.0,
            self.coverage.explorable_m2,
            minutes(self.sim_time_s),
            self.path_length_m,
        )
    }

    /// Returns the summary of the run, several lines.
    #[must_use]
    pub fn to_text(&self) -> String {
        let milestone = |name: &str, time_s: Option<f64>| match time_s {
            Some(time_s) => format!("{name} after {}", minutes(time_s)),
            None => format!("{name} never"),
        };
        let clearance = match self.safety.min_clearance_m {
            Some(m) => format!("{m:.3} m"),
            None => "not measured".into(),
        };
        let mut lines = vec![
            format!("{}: {}", self.headline(), self.in_short()),
            format!(
                "  coverage  {}, {}; driven again {:.0} %",
                milestone("90 %", self.coverage.t90_s),
                milestone("99 %", self.coverage.t99_s),
                self.path_overlap.unwrap_or(0.0) * 100.0,
            ),
            format!(
                "  safety    {} collisions, {} falls, {} tips; least clearance {clearance}",
                self.safety.collisions, self.safety.falls, self.safety.tips,
            ),
            format!("  planner   {}", self.cost()),
        ];
        lines.extend(self.chip());
        lines.extend(self.way());
        lines.extend(self.surroundings());
        if self.is_falsely_explored() {
            lines.push(String::from(
                "  false     calls itself explored, and saw less than 97 % of the ground",
            ));
        }
        for left in &self.outcome.residual_frontiers {
            lines.push(format!(
                "  left      {} cells at ({:.1}, {:.1}): {}",
                left.cells, left.x_m, left.y_m, left.reason
            ));
        }
        lines.join("\n")
    }

    /// Returns lines about loops, patrol, known map, fence and trips.
    fn way(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let Loops { islands, circled } = self.loops;
        if islands > 0 {
            lines.push(format!("  loops     {circled} of {islands} closed"));
        }
        lines.extend(self.loop_closing.as_ref().map(loop_closing));
        if let Some(patrol) = &self.patrol {
            lines.push(format!(
                "  patrol    oldest rail {:.0} s, mean age {:.0} s",
                patrol.max_rail_age_s, patrol.mean_rail_age_s
            ));
        }
        if let Some(known) = &self.known {
            lines.push(format!(
                "  known     {:.0} m2 in {} tiles before the first step, from {}",
                known.known_m2, known.tiles, known.file
            ));
        }
        if let Some(fence) = &self.fence {
            lines.push(format!(
                "  fence     {} polygons; the hull was {:.3} m beyond them at most",
                fence.bounds_m.len() + fence.no_go_m.len(),
                fence.deepest_m,
            ));
        }
        if !self.live_requests.is_empty() {
            lines.push(format!(
                "  live      {} requests of viewers: the command line does not make this run again",
                self.live_requests.len()
            ));
        }
        for trip in &self.trips {
            let [x, y] = trip.stands_m;
            let turned = trip.error_deg.map(|deg| format!(", {deg:.1} deg"));
            let why = trip.refused.as_ref().map(|why| format!("; {why}"));
            lines.push(format!(
                "  {:<9} {}: stands at ({x:.2}, {y:.2}), {:.2} m{} off, after {:.0} s{}",
                trip.to,
                if trip.reached {
                    "reached"
                } else {
                    "not reached"
                },
                trip.error_m,
                turned.unwrap_or_default(),
                trip.time_s,
                why.unwrap_or_default(),
            ));
        }
        lines
    }

    /// Returns lines about the ground, the map and the inputs.
    fn surroundings(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(ground) = &self.true_ground {
            lines.push(format!(
                "  ground    {:.1} m up and down; pitch {:.1} deg, roll {:.1} deg at most; \
                 {:.1} s beyond {:.0} and {:.0} deg",
                self.height_change_m,
                ground.max_pitch_deg,
                ground.max_roll_deg,
                ground.over_limits_s,
                ground.working.climb_deg,
                ground.working.roll_deg,
            ));
        }
        if let Some(max_m) = self.localization.max_error_m.filter(|m| *m > 1e-3) {
            let mean_m = self.localization.mean_error_m.unwrap_or(0.0);
            lines.push(format!(
                "  position  wrong by {mean_m:.2} m on average, {max_m:.2} m at most"
            ));
        }
        lines.extend(self.walls());
        if let Some(slam) = &self.slam {
            lines.push(format!("  graph     {slam}"));
        }
        if let Some(particles) = &self.particles {
            lines.push(format!("  particles {particles}"));
        }
        lines.extend(self.input_faults.line());
        if let Some(network) = &self.network {
            let dropped = network.malformed + network.unauthentic + network.foreign;
            lines.push(format!(
                "  network   {} packets said, {} heard; {dropped} foreign or damaged, {} replayed",
                network.said, network.heard, network.replayed
            ));
        }
        lines
    }

    /// Returns a line if the map has far fewer of the walls than of the floor.
    fn walls(&self) -> Option<String> {
        let share = self.map?.walls_share?;
        (share < self.coverage.fraction - MISSING_WALLS).then(|| {
            format!(
                "  walls     only {:.0} % of the true walls are in the map; the laser does not see \
                 what is lower than its beam, or of glass",
                share * 100.0
            )
        })
    }

    /// Returns true if the run ended as explored with less than 97 % of the ground truly seen.
    /// Behind a fence nothing says how much may be seen.
    #[must_use]
    pub fn is_falsely_explored(&self) -> bool {
        self.fence.is_none()
            && self.outcome.reason == "explored"
            && self.coverage.fraction < LEAST_SEEN
    }

    /// Returns one word or two: `explored`, `boxed-in`, `fault (stuck)`, `time-limit` ...
    fn ending(&self) -> String {
        match self.outcome.status.as_str() {
            "finished" => self.outcome.reason.clone(),
            "fault" | "lost" => format!("{} ({})", self.outcome.status, self.outcome.reason),
            "frozen" if self.outcome.reason == "no-scan" => {
                "frozen (no scan from the lidar)".into()
            }
            status => status.into(),
        }
    }

    /// Returns two lines on what a step takes on the chip by the model, if it was counted.
    fn chip(&self) -> Vec<String> {
        let Some((cycles, ms)) = self.planner.cycles.zip(self.planner.ms) else {
            return Vec::new();
        };
        let stages = self.planner.stage_cycles.unwrap_or_default().by_name();
        let stages = stages.map(|(name, of)| {
            let [p50, most] = [of.p50, of.max].map(milliseconds);
            format!("{name} {p50:.1} ({most:.1})")
        });
        vec![
            format!(
                "  chip      {:.1} ms a step by the model (p99 {:.1}, max {:.1}): {:.2} M cycles \
                 at {} MHz",
                ms.p50,
                ms.p99,
                ms.max,
                cycles.p50 / 1e6,
                CLOCK_HZ / 1_000_000,
            ),
            format!("  by stage  {} ms", stages.join(", ")),
        ]
    }

    fn cost(&self) -> String {
        let mut words = format!("{} steps", self.steps);
        if let Some(us) = self.planner.round_trip_us {
            words += &format!(
                ", {:.2} ms each by {} (p99 {:.2})",
                us.p50 / 1e3,
                self.link,
                us.p99 / 1e3
            );
        }
        if let Some(count) = self.planner.instructions {
            words += &format!(
                ", {:.2} M instructions (max {:.2})",
                count.p50 / 1e6,
                count.max / 1e6
            );
        }
        if let Some(error_deg) = self.field.heading_error_deg {
            words += &format!(", worst heading error {:.1} deg", error_deg.max);
        }
        words
    }
}

/// Returns the loops that the device reported.
fn loop_closing(reported: &LoopClosing) -> String {
    let mut line = format!(
        "  closing   the robot reports {} closed, {} given up; {:.0} s, {:.0} s of them wasted",
        reported.closed,
        reported.given_up.len(),
        reported.closing_s,
        reported.wasted_s
    );
    for GivenUp { time_s, x_m, y_m } in &reported.given_up {
        line += &format!(
            "\n  given up  a loop after {}, at ({x_m:.1}, {y_m:.1})",
            minutes(*time_s)
        );
    }
    line
}

/// Formats as `5:07`.
fn minutes(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use crate::report::tests::sample;
    use crate::report::{GivenUp, LoopClosing, MapErrors, Percentiles, Stages, TrueGround};

    #[test]
    fn the_summary_has_all_parts_in_order() {
        let report = sample();
        assert_eq!(report.headline(), "office · frontier · seed 1");
        assert_eq!(
            report.to_text(),
            "office · frontier · seed 1: \
             explored, 99.1 % of 200 m² known after 5:12 min and 145.2 m\n\
             \x20 coverage  90 % after 3:21, 99 % after 5:00; driven again 31 %\n\
             \x20 safety    0 collisions, 0 falls, 0 tips; least clearance 0.080 m\n\
             \x20 planner   3125 steps, 0.41 ms each by loopback (p99 1.20)\n\
             \x20 loops     1 of 2 closed\n\
             \x20 left      4 cells at (3.0, -1.2): unreachable"
        );
    }

    #[test]
    fn uneven_ground_has_a_line_of_its_own() {
        let mut report = sample();
        report.height_change_m = 12.34;
        report.ground = "uneven".into();
        report.true_ground = Some(TrueGround {
            max_pitch_deg: 18.26,
            max_roll_deg: 7.0,
            over_limits_s: 0.4,
            working: (&crate::robot::Limits::WORKING).into(),
            ..Default::default()
        });
        report.outcome.status = "lost".into();
        report.outcome.reason = "tipped".into();
        let text = report.to_text();
        assert!(text.contains("lost (tipped), "), "{text}");
        assert!(
            text.starts_with("office · frontier · uneven ground · seed 1: "),
            "{text}"
        );
        let line = "  ground    12.3 m up and down; pitch 18.3 deg, roll 7.0 deg at most; \
                    0.4 s beyond 20 and 15 deg";
        assert!(text.lines().any(|l| l == line), "{text}");
    }

    #[test]
    fn a_loop_that_was_given_up_has_a_line() {
        let mut report = sample();
        let place = GivenUp {
            time_s: 125.4,
            x_m: 3.0,
            y_m: -1.24,
        };
        report.loop_closing = Some(LoopClosing {
            closed: 2,
            given_up: vec![place],
            closing_s: 210.4,
            wasted_s: 30.0,
        });
        let text = report.to_text();
        let lines = "
  closing   the robot reports 2 closed, 1 given up; 210 s, 30 s of them wasted
  given up  a loop after 2:05, at (3.0, -1.2)
";
        assert!(text.contains(lines), "{text}");
    }

    #[test]
    fn observations_that_were_wrong_have_a_line() {
        let mut report = sample();
        assert!(!report.to_text().contains("  input "));
        report.input_faults.refused = 2;
        report.input_faults.jumps = 1;
        let line = "  input     2 observations refused, 1 jumps of odometry, 0 times out of order";
        assert!(report.to_text().lines().any(|it| it == line));
    }

    #[test]
    fn a_map_without_its_walls_says_so() {
        let mut report = sample();
        let with_share = |walls_share| {
            Some(MapErrors {
                walls_share,
                ..MapErrors::default()
            })
        };
        for share in [None, Some(0.95)] {
            report.map = with_share(share);
            assert!(!report.to_text().contains("  walls "));
        }
        report.map = with_share(Some(0.034));
        let line = "  walls     only 3 % of the true walls are in the map; ";
        assert!(report.to_text().lines().any(|it| it.starts_with(line)));
    }

    #[test]
    fn milliseconds_are_said_to_be_by_the_model() {
        let mut report = sample();
        assert!(!report.to_text().contains("model"));
        let of = |p50, max| Percentiles { p50, p99: max, max };
        report.planner.cycles = Some(of(3.36e6, 6.72e6));
        report.planner.ms = Some(of(20.0, 40.0));
        report.planner.stage_cycles = Some(Stages {
            solve: of(1.68e6, 3.36e6),
            ..Stages::default()
        });
        let text = report.to_text();
        let lines = "
  chip      20.0 ms a step by the model (p99 40.0, max 40.0): 3.36 M cycles at 168 MHz
  by stage  session 0.0 (0.0), sense 0.0 (0.0), topology 0.0 (0.0), plan 0.0 (0.0), \
                     window 0.0 (0.0), solve 10.0 (20.0), drive 0.0 (0.0) ms
";
        assert!(text.contains(lines), "{text}");
    }

    #[test]
    fn a_milestone_that_was_never_reached_is_shown() {
        let mut report = sample();
        report.coverage.t99_s = None;
        report.outcome.status = "fault".into();
        report.outcome.reason = "link-silent".into();
        let text = report.to_text();
        assert!(
            text.contains("fault (link-silent), ") && text.contains("99 % never"),
            "{text}"
        );
    }
}
