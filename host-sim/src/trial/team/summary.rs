//! The report of a team's run, put together from its robots.

use std::collections::BTreeMap;

use super::super::Record;
use super::super::mission::Mission;
use super::super::summary::{self, whole_cells_m2};
use super::TeamMission;
use super::agreement::agreement;
use super::member::{Member, Presence};
use crate::link::LinkStats;
use crate::link::digest::Digest;
use crate::metrics::{Coverage, TeamOverlap};
use crate::radio::Traffic;
use crate::report::grid_map::MapCell;
use crate::report::{self, Report, TeamReport, team};
use crate::robot::FARTHEST_M;
use crate::sim::Fleet;
use crate::world::Start;

/// What the report is made of.
pub(super) struct Whole<'a, 'm, 'w> {
    pub(super) team: &'a TeamMission,
    pub(super) missions: &'a [Mission],
    pub(super) starts: &'a [Start],
    pub(super) fleet: &'a Fleet<'w>,
    pub(super) members: &'a [Member<'m>],
    pub(super) coverage: &'a Coverage,
    pub(super) traffic: Traffic,
    pub(super) ended_ms: u32,
}

impl Whole<'_, '_, '_> {
    /// Returns the report.
    pub(super) fn report(&self) -> TeamReport {
        let robots: Vec<team::Robot> = (0..self.members.len()).map(|k| self.robot(k)).collect();
        let overlap = self.overlap();
        TeamReport {
            whole: self.whole(&robots, overlap.again()),
            team: team::Team {
                robots: self.members.len(),
                starts: if self.team.apart {
                    "apart".into()
                } else {
                    "side-by-side".into()
                },
                timetable: self.timetable(),
                driven_after_another: overlap.after_another(),
                measured_twice: self.measured_twice(),
                min_robot_gap_m: Some(self.fleet.min_gap_m()).filter(|gap_m| *gap_m < FARTHEST_M),
                maps_equal: self.team.radio.on.then(|| self.maps_equal()),
                start_error: self.start_error(),
                agreement: agreement(self.members),
            },
            radio: team::Radio {
                spec: self.team.radio.text.clone(),
                traffic: self.traffic,
            },
            robots,
        }
    }

    fn robot(&self, robot: usize) -> team::Robot {
        let (member, start) = (&self.members[robot], self.starts[robot]);
        let simulator = &self.fleet.robots()[robot];
        let mission = &self.missions[robot];
        let mut report = summary::report(mission, simulator, &member.account, &member.record);
        report.safety.robot_contacts = Some(self.fleet.contacts(robot));
        if self.team.radio.on {
            // The device's map also has what the robot heard.
            report.debug.map_matches_mirror = member.copy_matches();
        }
        report.slam = member.slam();
        team::Robot {
            robot,
            start_pose: [start.x_m, start.y_m, start.yaw_rad],
            boots: member.boots(),
            said: member.talk.said,
            said_bytes: member.talk.said_bytes,
            heard: member.talk.heard,
            map_fraction: self.map_fraction(&member.record),
            met_s: member.met_ms.map(|time_ms| f64::from(time_ms) / 1000.0),
            report,
        }
    }

    /// The team as one run: sums, extremes, and measures over all steps of all robots.
    fn whole(&self, robots: &[team::Robot], path_overlap: f64) -> Report {
        let first = &robots[0].report;
        let all = self.pooled();
        let sum = |of: fn(&Report) -> f64| robots.iter().map(|it| of(&it.report)).sum::<f64>();
        let mut links: Vec<&str> = self.team.links.iter().map(String::as_str).collect();
        links.dedup();
        Report {
            link: links.join(","),
            seed: self.team.mission.seed,
            outcome: self.outcome(robots),
            sim_time_s: f64::from(self.ended_ms) / 1000.0,
            path_length_m: sum(|report| report.path_length_m),
            path_overlap: Some(path_overlap),
            height_change_m: sum(|report| report.height_change_m),
            steps: all.steps.len() as u64,
            coverage: self.known(),
            loops: report::Loops {
                circled: most(robots, |report| report.loops.circled),
                ..first.loops
            },
            fence: fence(robots),
            loop_closing: None,
            patrol: None,
            safety: self.safety(robots),
            true_ground: None,
            localization: all.localization(),
            map: None,
            planner: all.planner(),
            field: all.field(),
            link_stats: link_stats(robots),
            input_faults: input_faults(robots),
            digest: self.digest(),
            debug: report::Debug {
                map_matches_mirror: all_true(robots, |report| report.debug.map_matches_mirror),
            },
            slam: None,
            particles: None,
            ..first.clone()
        }
    }

    /// All steps of all robots as one record, for measures over the steps.
    fn pooled(&self) -> Record {
        let mut pooled = Record::default();
        for member in self.members {
            let record = &member.record;
            pooled.steps.extend_from_slice(&record.steps);
            pooled.heading_errors_deg.extend(&record.heading_errors_deg);
        }
        pooled
    }

    /// The digest of the commands of all robots, one robot after another.
    fn digest(&self) -> String {
        let mut digest = Digest::new();
        for step in self.members.iter().flat_map(|member| &member.record.steps) {
            digest.add(&step.command);
        }
        digest.to_string()
    }

    /// `explored` if every robot that is in the team at the end explored everything; else the end
    /// of the first robot in the team that did not, or of the first robot if none is left.
    fn outcome(&self, robots: &[team::Robot]) -> report::Outcome {
        let mut here = (0..self.members.len()).filter(|k| self.members[*k].is_in_team());
        let failed = here.clone().find(|k| !self.members[*k].has_explored());
        let shown = failed.or_else(|| here.next()).unwrap_or(0);
        let mut outcome = robots[shown].report.outcome.clone();
        outcome.residual_frontiers.clear();
        for frontier in robots
            .iter()
            .flat_map(|it| &it.report.outcome.residual_frontiers)
        {
            if !outcome.residual_frontiers.contains(frontier) {
                outcome.residual_frontiers.push(frontier.clone());
            }
        }
        outcome
    }

    fn known(&self) -> report::Coverage {
        report::Coverage {
            fraction: self.coverage.fraction(),
            known_m2: whole_cells_m2(self.coverage.known_m2()),
            explorable_m2: whole_cells_m2(self.coverage.reachable_m2()),
            t90_s: self.coverage.t90_s(),
            t95_s: self.coverage.t95_s(),
            t99_s: self.coverage.t99_s(),
        }
    }

    fn safety(&self, robots: &[team::Robot]) -> report::Safety {
        let sum = |of: fn(&report::Safety) -> u32| {
            let counts = robots.iter().map(|robot| of(&robot.report.safety));
            counts.sum()
        };
        let clearances = robots
            .iter()
            .map(|robot| robot.report.safety.min_clearance_m);
        report::Safety {
            collisions: sum(|safety| safety.collisions),
            falls: sum(|safety| safety.falls),
            tips: sum(|safety| safety.tips),
            min_clearance_m: clearances.flatten().min_by(f64::total_cmp),
            robot_contacts: Some(self.fleet.meetings()),
            person_contacts: None,
            min_person_gap_m: None,
        }
    }

    /// The paths of all robots, in the order of time.
    fn overlap(&self) -> TeamOverlap {
        let mut places: Vec<(u32, usize, [f64; 2])> = Vec::new();
        for (robot, member) in self.members.iter().enumerate() {
            let steps = member.record.steps.iter().map(|step| step.truth);
            places.extend(steps.map(|truth| (truth.time_ms, robot, [truth.x_m, truth.y_m])));
        }
        places.sort_by_key(|(time_ms, robot, _)| (*time_ms, *robot));
        let mut overlap = TeamOverlap::new(self.members.len());
        for (_, robot, at_m) in places {
            overlap.add(robot, at_m);
        }
        overlap
    }

    /// Share of the cells that a robot measured that more than one measured.
    fn measured_twice(&self) -> f64 {
        let mut count: BTreeMap<(i32, i32), u32> = BTreeMap::new();
        for member in self.members {
            for cell in member.account.coverage.known() {
                *count.entry((cell.x, cell.y)).or_default() += 1;
            }
        }
        let twice = count.values().filter(|robots| **robots > 1).count();
        twice as f64 / count.len().max(1) as f64
    }

    fn map_fraction(&self, record: &Record) -> Option<f64> {
        let cells = self.coverage.cells();
        let known = cells
            .iter()
            .filter(|cell| record.map.get(cell.x, cell.y) != MapCell::Unknown);
        let fraction = known.count() as f64 / cells.len().max(1) as f64;
        (!record.tiles.is_empty()).then_some(fraction)
    }

    /// Returns true if all robots that are in the team have the same map.
    fn maps_equal(&self) -> bool {
        let here = self
            .members
            .iter()
            .filter(|member| matches!(member.presence, Presence::Exploring | Presence::Standing));
        let mut maps = here.map(|member| &member.record.map);
        let Some(first) = maps.next() else {
            return true;
        };
        maps.all(|map| map.known_cells().eq(first.known_cells()))
    }

    fn start_error(&self) -> Option<[f64; 2]> {
        let error = self.team.start_error;
        (error.sd_m > 0.0).then(|| [error.sd_m, error.sd_rad.to_degrees()])
    }

    fn timetable(&self) -> Vec<String> {
        let table = &self.team.timetable;
        let leave = table.leave.iter().map(|it| ("leave", it));
        let join = table.join.iter().map(|it| ("join", it));
        let mut events: Vec<_> = leave.chain(join).collect();
        events.sort_by_key(|(_, it)| **it);
        let seconds = |time_ms: u32| f64::from(time_ms) / 1000.0;
        let words = events.iter();
        words
            .map(|(what, it)| format!("{what} {}@{}", it.robot, seconds(it.time_ms)))
            .collect()
    }
}

fn most(robots: &[team::Robot], of: fn(&Report) -> u32) -> u32 {
    let counts = robots.iter().map(|robot| of(&robot.report));
    counts.max().unwrap_or(0)
}

/// Returns the fence, with the depth of the hull that was deepest in what is forbidden.
fn fence(robots: &[team::Robot]) -> Option<report::Fence> {
    let fences = robots.iter().filter_map(|robot| robot.report.fence.clone());
    fences.max_by(|a, b| a.deepest_m.total_cmp(&b.deepest_m))
}

fn all_true(robots: &[team::Robot], of: fn(&Report) -> Option<bool>) -> Option<bool> {
    let mut answers = robots.iter().map(|robot| of(&robot.report));
    answers.try_fold(true, |all, answer| answer.map(|answer| all && answer))
}

fn input_faults(robots: &[team::Robot]) -> report::InputFaults {
    let counts = robots.iter().map(|robot| robot.report.input_faults);
    counts.fold(report::InputFaults::default(), |all, of| all + of)
}

fn link_stats(robots: &[team::Robot]) -> LinkStats {
    let mut all = LinkStats::default();
    for stats in robots.iter().map(|robot| robot.report.link_stats) {
        all.sent += stats.sent;
        all.received += stats.received;
        all.retries += stats.retries;
        all.dropped += stats.dropped;
        all.crc_errors += stats.crc_errors;
    }
    all
}
