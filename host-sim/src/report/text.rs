//! A report in a few lines for a person.

use super::{Closures, GivenUp, Report};

impl Report {
    /// World, strategy and seed.
    #[must_use]
    pub fn headline(&self) -> String {
        format!("{} · {} · seed {}", self.world, self.strategy, self.seed)
    }

    /// How it ended, how much is known, how long and how far, on one line.
    #[must_use]
    pub fn in_short(&self) -> String {
        format!(
            "{}, {:.1} % of {:.0} m² known after {} min and {:.1} m",
            self.ending(),
            self.coverage.fraction * 100.0,
            self.coverage.reachable_m2,
            minutes(self.sim_time_s),
            self.path_length_m,
        )
    }

    /// The summary after a run.
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
                self.coverage.overlap.unwrap_or(0.0) * 100.0,
            ),
            format!(
                "  safety    {} collisions, {} falls, {} tips; least clearance {clearance}",
                self.safety.collisions, self.safety.falls, self.safety.tips,
            ),
            format!("  planner   {}", self.cost()),
        ];
        if self.loops.loops > 0 {
            let super::Loops {
                loops_closed,
                loops,
            } = self.loops;
            lines.push(format!("  loops     {loops_closed} of {loops} closed"));
        }
        lines.extend(self.closures.as_ref().map(closures));
        if let Some(patrol) = &self.patrol {
            lines.push(format!(
                "  patrol    oldest rail {:.0} s, mean age {:.0} s",
                patrol.oldest_rail_s, patrol.mean_age_s
            ));
        }
        if let Some(terrain) = &self.terrain {
            lines.push(format!(
                "  ground    {:.1} m up and down; steepest {:.1} deg along, {:.1} deg across; {:.1} s beyond {:.0} and {:.0} deg",
                self.climb_m,
                terrain.max_climb_deg,
                terrain.max_side_deg,
                terrain.over_limits_s,
                terrain.working.climb_deg,
                terrain.working.side_deg,
            ));
        }
        if let Some(error_m) = self.localization.max_error_m.filter(|m| *m > 1e-3) {
            let mean_m = self.localization.mean_error_m.unwrap_or(0.0);
            lines.push(format!(
                "  odometry  off by {mean_m:.2} m in the mean, {error_m:.2} m at most"
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

    /// `explored`, `boxed-in`, `fault (stuck)`, `time-limit` ...
    fn ending(&self) -> String {
        match self.outcome.status.as_str() {
            "finished" => self.outcome.reason.clone(),
            "fault" | "lost" => format!("{} ({})", self.outcome.status, self.outcome.reason),
            status => status.into(),
        }
    }

    fn cost(&self) -> String {
        let mut words = format!("{} steps", self.steps);
        if let Some(wall) = self.planner.wall_us {
            words += &format!(
                ", {:.2} ms each by {} (p99 {:.2})",
                wall.p50 / 1e3,
                self.link,
                wall.p99 / 1e3
            );
        }
        if let Some(count) = self.planner.instructions {
            words += &format!(
                ", {:.2} M instructions (max {:.2})",
                count.p50 / 1e6,
                count.max / 1e6
            );
        }
        if let Some(error_deg) = self.field.worst_heading_error_deg {
            words += &format!(", worst heading error {error_deg:.1} deg");
        }
        words
    }
}

/// What the device said of loops.
fn closures(said: &Closures) -> String {
    let mut line = format!(
        "  closing   {} closed by the robot's word, {} given up as not there; {:.0} s, {:.0} s of them in vain",
        said.closed,
        said.given_up.len(),
        said.closing_s,
        said.in_vain_s
    );
    for at in &said.given_up {
        let GivenUp { time_s, x_m, y_m } = at;
        line += &format!(
            "\n  given up  a loop after {}, at ({x_m:.1}, {y_m:.1})",
            minutes(*time_s)
        );
    }
    line
}

/// `5:07`.
fn minutes(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

#[cfg(test)]
mod tests {
    use crate::report::tests::sample;
    use crate::report::{Closures, GivenUp};

    #[test]
    fn the_summary_says_what_matters() {
        let report = sample();
        assert_eq!(report.headline(), "office · frontier · seed 1");
        assert_eq!(
            report.to_text(),
            "office · frontier · seed 1: explored, 99.1 % of 200 m² known after 5:12 min and 145.2 m\n\
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
        report.climb_m = 12.34;
        report.terrain = Some(crate::report::Terrain {
            max_climb_deg: 18.26,
            max_side_deg: 7.0,
            over_limits_s: 0.4,
            working: (&crate::robot::Limits::WORKING).into(),
            ..Default::default()
        });
        report.outcome.status = "lost".into();
        report.outcome.reason = "tipped".into();
        let text = report.to_text();
        assert!(text.contains("lost (tipped), "), "{text}");
        let line = "  ground    12.3 m up and down; steepest 18.3 deg along, 7.0 deg across; 0.4 s beyond 20 and 15 deg";
        assert!(text.lines().any(|l| l == line), "{text}");
    }

    #[test]
    fn a_loop_that_was_given_up_is_said() {
        let mut report = sample();
        let place = GivenUp {
            time_s: 125.4,
            x_m: 3.0,
            y_m: -1.24,
        };
        report.closures = Some(Closures {
            closed: 2,
            given_up: vec![place],
            closing_s: 210.4,
            in_vain_s: 30.0,
        });
        let text = report.to_text();
        let lines = "
  closing   2 closed by the robot's word, 1 given up as not there; 210 s, 30 s of them in vain
  given up  a loop after 2:05, at (3.0, -1.2)
";
        assert!(text.contains(lines), "{text}");
    }

    #[test]
    fn what_never_came_is_said() {
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
