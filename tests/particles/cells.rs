//! Cells: points and fractions, lengths and angles.

use photosphere::math::DVec3;
use photosphere::particles::{Cell, Column, ColumnData, Role};

#[test]
fn fractions_are_the_inverse_of_points() {
    let cell = Cell {
        origin: DVec3::new(1.0, -2.0, 0.5),
        vectors: [
            DVec3::new(4.0, 0.5, 0.0),
            DVec3::new(-1.0, 5.0, 0.25),
            DVec3::new(0.5, 1.0, 6.0),
        ],
        periodic: [true; 3],
    };
    for fractions in [[0.0; 3], [1.0, 0.0, 0.0], [0.25, -0.5, 2.0]] {
        let found = cell.fractions(cell.point(fractions));
        for (found, expected) in found.iter().zip(fractions) {
            assert!((found - expected).abs() < 1e-14);
        }
    }
    let cube = Cell::orthogonal(DVec3::ZERO, DVec3::splat(2.0));
    assert_eq!(cube.volume(), 8.0);
}

#[test]
fn right_angles_are_exact() {
    let cell = Cell::from_lengths_and_angles([2.0, 3.0, 4.0], [90.0; 3]);
    assert_eq!(cell.vectors, [DVec3::X * 2.0, DVec3::Y * 3.0, DVec3::Z * 4.0]);
    let cell = Cell::from_lengths_and_angles([2.0, 2.0, 4.0], [90.0, 90.0, 120.0]);
    let [a, b, _] = cell.vectors;
    assert!(
        (a.angle_between(b).to_degrees() - 120.0).abs() < 1e-12 && (b.length() - 2.0).abs() < 1e-15
    );
}

#[test]
fn roles_follow_names() {
    for (name, role) in [
        ("Radius", Some(Role::Radius)),
        ("diameter [mm]", Some(Role::Diameter)),
        ("species", Some(Role::Element)),
        ("type", Some(Role::Type)),
        ("r", None),
        ("c_pe", None),
    ] {
        assert_eq!(Role::of(name), role, "{name}");
    }
    let column = |data| Column { name: "a".to_owned(), data };
    assert_eq!(column(ColumnData::F32(vec![f32::NAN, 2.0, -1.0])).range(), Some([-1.0, 2.0]));
    assert_eq!(column(ColumnData::F64(vec![f64::NAN])).range(), None);
}
