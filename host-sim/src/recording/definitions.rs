//! The definitions of ROS 2's messages that a recording uses, as its schemas have them.
//!
//! A schema of MCAP with encoding `ros2msg` is the text of a message, followed by that of every
//! message in it, each below a line of `=` and its name.

use std::collections::BTreeSet;

/// A message: its package, its name, and its fields as in its `.msg` file.
type Definition = (&'static str, &'static str, &'static str);

/// The messages, in alphabetical order.
const ALL: [Definition; 21] = [
    ("builtin_interfaces", "Time", "int32 sec\nuint32 nanosec\n"),
    (
        "geometry_msgs",
        "Point",
        "float64 x\nfloat64 y\nfloat64 z\n",
    ),
    (
        "geometry_msgs",
        "Pose",
        "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    ),
    (
        "geometry_msgs",
        "PoseStamped",
        "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    ),
    (
        "geometry_msgs",
        "PoseWithCovariance",
        "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
    ),
    (
        "geometry_msgs",
        "Quaternion",
        "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    ),
    (
        "geometry_msgs",
        "Transform",
        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
    ),
    (
        "geometry_msgs",
        "TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    (
        "geometry_msgs",
        "Twist",
        "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    ),
    (
        "geometry_msgs",
        "TwistWithCovariance",
        "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
    ),
    (
        "geometry_msgs",
        "Vector3",
        "float64 x\nfloat64 y\nfloat64 z\n",
    ),
    (
        "nav_msgs",
        "MapMetaData",
        "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n\
         geometry_msgs/Pose origin\n",
    ),
    (
        "nav_msgs",
        "OccupancyGrid",
        "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
    ),
    (
        "nav_msgs",
        "Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
    ),
    (
        "nav_msgs",
        "Path",
        "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    ),
    (
        "rcl_interfaces",
        "Log",
        "byte DEBUG=10\nbyte INFO=20\nbyte WARN=30\nbyte ERROR=40\nbyte FATAL=50\n\
         builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n\
         string function\nuint32 line\n",
    ),
    (
        "sensor_msgs",
        "LaserScan",
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
         float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n\
         float32[] ranges\nfloat32[] intensities\n",
    ),
    ("std_msgs", "Float32", "float32 data\n"),
    (
        "std_msgs",
        "Header",
        "builtin_interfaces/Time stamp\nstring frame_id\n",
    ),
    ("std_msgs", "String", "string data\n"),
    (
        "tf2_msgs",
        "TFMessage",
        "geometry_msgs/TransformStamped[] transforms\n",
    ),
];

/// Returns the schema of a message, named as in `nav_msgs/msg/Path`; `None` for one that no
/// recording has.
pub(super) fn schema(name: &str) -> Option<String> {
    let (package, name) = name.split_once("/msg/")?;
    let fields = fields(package, name)?;
    let mut text = fields.to_owned();
    let (mut told, mut open) = (BTreeSet::new(), parts(fields));
    while let Some((package, name)) = open.pop() {
        let Some(fields) = fields_once(&mut told, package, name) else {
            continue;
        };
        let rule = "=".repeat(80);
        text.push_str(&format!("{rule}\nMSG: {package}/{name}\n{fields}"));
        open.extend(parts(fields));
    }
    Some(text)
}

fn fields(package: &str, name: &str) -> Option<&'static str> {
    let found = ALL.iter().find(|it| (it.0, it.1) == (package, name));
    found.map(|(_, _, fields)| *fields)
}

fn fields_once(
    told: &mut BTreeSet<(&'static str, &'static str)>,
    package: &'static str,
    name: &'static str,
) -> Option<&'static str> {
    told.insert((package, name))
        .then(|| fields(package, name))
        .flatten()
}

/// Returns the messages that fields have, as package and name.
fn parts(fields: &'static str) -> Vec<(&'static str, &'static str)> {
    let types = fields.lines().filter_map(|line| line.split(' ').next());
    let types = types.map(|of| of.split('[').next().unwrap_or(of));
    types.filter_map(|of| of.split_once('/')).collect()
}

#[cfg(test)]
mod tests {
    use super::{ALL, fields, parts, schema};

    #[test]
    fn every_part_of_a_message_is_defined() {
        for (_, name, text) in ALL {
            for (package, part) in parts(text) {
                assert!(fields(package, part).is_some(), "{part} in {name}");
            }
        }
    }

    #[test]
    fn a_schema_tells_each_part_once() {
        let text = schema("nav_msgs/msg/Odometry").expect("a schema");
        for part in ["Header", "Pose", "Twist", "Vector3", "Quaternion", "Time"] {
            let heads = text.lines().filter(|line| {
                line.strip_prefix("MSG: ")
                    .is_some_and(|it| it.ends_with(&format!("/{part}")))
            });
            assert_eq!(heads.count(), 1, "{part}");
        }
        assert!(text.starts_with("std_msgs/Header header\nstring child_frame_id\n"));
        assert_eq!(schema("nav_msgs/msg/Nothing"), None);
        assert_eq!(schema("Odometry"), None);
    }
}
