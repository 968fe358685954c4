//! Which columns are the position, by their names.

use crate::particles::column::base_name;

/// Names of coordinates: `@` is `x`, `y` or `z`, and `#` is 0, 1 or 2.
const PATTERNS: [&str; 30] = [
    "@",
    "p@",
    "pos_@",
    "pos@",
    "pos.@",
    "position_@",
    "position.@",
    "position@",
    "positions_@",
    "@_pos",
    "@pos",
    "@_position",
    "points:#",
    "points_#",
    "position:#",
    "position_#",
    "coordinates:#",
    "coordinates_#",
    "coordinates_@",
    "coord_@",
    "coord@",
    "@_coord",
    "@coord",
    "@_coordinate",
    "center_@",
    "center@",
    "centre_@",
    "c@",
    "@c",
    "centroid_@",
];

/// The places of x, y and z among names; case and units in brackets do not matter.
pub(in crate::particles) fn axis_of(names: &[&str]) -> Option<[usize; 3]> {
    let lower: Vec<String> = names.iter().map(|n| base_name(n).to_ascii_lowercase()).collect();
    PATTERNS.iter().find_map(|pattern| {
        let place = |axis: usize| {
            let name = pattern.replace('@', ["x", "y", "z"][axis]);
            let name = name.replace('#', ["0", "1", "2"][axis]);
            lower.iter().position(|found| *found == name)
        };
        Some([place(0)?, place(1)?, place(2)?])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_found_by_their_usual_names() {
        assert_eq!(axis_of(&["id", "X", "y", "Z"]), Some([1, 2, 3]));
        assert_eq!(axis_of(&["Points:2", "Points:0", "Points:1"]), Some([1, 2, 0]));
        assert_eq!(axis_of(&["x [mm]", "y (mm)", "z [mm]"]), Some([0, 1, 2]));
        assert_eq!(axis_of(&["pos_x", "pos_y", "vel_z"]), None);
        assert_eq!(axis_of(&["vx", "vy", "vz", "Px", "Py", "Pz"]), Some([3, 4, 5]));
    }
}
