//! Robots by name. A preset is a robot file that the program carries.

/// A robot that is known by name.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// One line about it.
    pub description: &'static str,
    /// Its robot file.
    pub yaml: &'static str,
}

/// Name of the usual robot.
pub const DEFAULT: &str = "pioneer-3at";

/// The presets; the usual robot comes first.
pub const PRESETS: [Preset; 5] = [
    Preset {
        name: DEFAULT,
        description: "Pioneer 3-AT, two scanners of 180°, 181 beams, 12 m; the default",
        yaml: include_str!("presets/pioneer-3at.yaml"),
    },
    Preset {
        name: "pioneer-3dx",
        description: "Pioneer 3-DX with a SICK LMS 200, 180°, 181 beams, 8 m: the papers' robot",
        yaml: include_str!("presets/pioneer-3dx.yaml"),
    },
    Preset {
        name: "turtlebot3-burger",
        description: "TurtleBot3 Burger, LDS-01 all round, 360 beams, 3.5 m",
        yaml: include_str!("presets/turtlebot3-burger.yaml"),
    },
    Preset {
        name: "round-0.35",
        description: "a disc of 0.35 m, a clockwise lidar all round, 450 beams, 12 m",
        yaml: include_str!("presets/round-0.35.yaml"),
    },
    Preset {
        name: "wide-0.8x1.1",
        description: "0.8 m long and 1.1 m wide, a scanner of 270°, 541 beams, 12 m",
        yaml: include_str!("presets/wide-0.8x1.1.yaml"),
    },
];

/// Returns the preset of this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// Returns the names of all presets.
#[must_use]
pub fn names() -> Vec<&'static str> {
    PRESETS.iter().map(|preset| preset.name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::RobotSpec;

    #[test]
    fn every_preset_is_a_robot() {
        for preset in &PRESETS {
            let robot = RobotSpec::open(preset.name).expect(preset.name);
            assert_eq!(robot.name, preset.name);
            assert!(robot.sectors().all(|sectors| sectors.laser().beams <= 181));
        }
    }

    #[test]
    fn the_default_preset_is_the_default_robot_bit_for_bit() {
        let preset = RobotSpec::open(DEFAULT).expect("a preset");
        let usual = RobotSpec::default();
        let lasers = |robot: &RobotSpec| robot.sectors().map(|it| *it.laser()).collect::<Vec<_>>();
        assert_eq!(lasers(&preset), lasers(&usual));
        assert_eq!(preset.hull, usual.hull);
        assert_eq!(preset.radius_m, usual.radius_m);
        assert_eq!(preset.drive, usual.drive);
        assert_eq!(preset.odometry, usual.odometry);
        for (preset, usual) in preset.lidars.iter().zip(&usual.lidars) {
            assert_eq!((preset.noise, preset.most_m), (usual.noise, usual.most_m));
            assert_eq!(preset.ignores_hull, usual.ignores_hull);
            assert_eq!(preset.least_m, usual.least_m);
        }
    }
}
