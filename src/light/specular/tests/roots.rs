//! The number of connections, against dense scans of the angle at the centre.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::math::DVec3;
use crate::sampling::safe_acos;

use super::super::{SpecularPath, Target};
use super::tracing::Configuration;

/// Points of a scan.
const POINTS: usize = 2000;
const CONFIGURATIONS: u32 = 2000;
/// A scan resolves no two roots between which it comes this close, in radians.
const UNRESOLVED: f64 = 1e-5;

/// The angle between x and y at the centre.
fn angle(center: DVec3, x: DVec3, y: Target) -> f64 {
    let y = match y {
        Target::Point(y) => (y - center).normalize(),
        Target::Direction(direction) => direction,
    };
    let x = (x - center).normalize();
    crate::sampling::atan2(x.cross(y).length(), x.dot(y))
}

fn inverse_distance(center: DVec3, radius: f64, y: Target) -> f64 {
    match y {
        Target::Point(y) => radius / y.distance(center),
        Target::Direction(_) => 0.0,
    }
}

fn asin(x: f64) -> f64 {
    FRAC_PI_2 - safe_acos(x)
}

/// Counts where `angle_at(s)`, with `s = sin v` from 0 to 1, is `theta` or `-theta` up to full
/// turns; `None` if two roots may lie between two points.
fn count_roots(theta: f64, angle_at: impl Fn(f64) -> f64) -> Option<usize> {
    let at = |i: usize| angle_at((FRAC_PI_2 * i as f64 / POINTS as f64).sin());
    let angles: Vec<f64> = (0..=POINTS).map(at).collect();
    let mut count = 0;
    for target in [theta, -theta] {
        let wrap = |angle: &f64| (angle - target + PI).rem_euclid(TAU) - PI;
        let off: Vec<f64> = angles.iter().map(wrap).collect();
        let crosses = |pair: &&[f64]| (pair[0] < 0.0) != (pair[1] < 0.0) && pair[0].abs() < 1.0;
        count += off.windows(2).filter(crosses).count();
        let touches = |three: &[f64]| {
            three.iter().any(|x| x.abs() < UNRESOLVED)
                && (three[1] - three[0]) * (three[2] - three[1]) < 0.0
        };
        if off.windows(3).any(touches) {
            return None;
        }
    }
    Some(count)
}

/// Compares counts and returns how often each was found.
fn compare(found: impl IntoIterator<Item = (usize, Option<usize>)>) -> [usize; 5] {
    let (mut counts, mut unresolved) = ([0; 5], 0);
    for (index, (found, scanned)) in found.into_iter().enumerate() {
        match scanned {
            Some(scanned) => assert_eq!(found, scanned, "{index}"),
            None => unresolved += 1,
        }
        counts[found] += 1;
    }
    assert!(unresolved <= 4, "{unresolved}");
    counts
}

fn configurations() -> impl Iterator<Item = (Configuration, Target)> {
    (0..CONFIGURATIONS).flat_map(|index| {
        let targets = Configuration::new(index).targets();
        targets.map(|y| (Configuration::new(index), y))
    })
}

#[test]
fn a_reflection_exists_where_the_straight_line_is_free() {
    let found = configurations().map(|(configuration, y)| {
        let Configuration { ball, outside: [x, _], .. } = configuration;
        let (to_y, far) = match y {
            Target::Point(y) => (y - x, 1.0),
            Target::Direction(direction) => (direction, f64::INFINITY),
        };
        let is_free = ball.first_root(x, to_y, 0.0, far).is_none();
        (
            usize::from(!SpecularPath::Reflection.connect(&ball, 1.0, x, y).is_empty()),
            Some(usize::from(is_free)),
        )
    });
    let counts = compare(found);
    assert!(counts[0] > 1000 && counts[1] > 1000, "{counts:?}");
}

#[test]
fn paths_through_are_as_many_as_a_scan_finds() {
    for (kind, k) in [(SpecularPath::Through, 1.0), (SpecularPath::ThroughReflected, 2.0)] {
        let found = configurations().map(|(configuration, y)| {
            let Configuration { ball, ior, outside: [x, _], .. } = configuration;
            let [c1, c2] =
                [Target::Point(x), y].map(|end| inverse_distance(ball.center, ball.radius, end));
            let scanned = count_roots(angle(ball.center, x, y), |s| {
                let h = s * ior.min(1.0);
                2.0 * asin(h) - asin(h * c1) - asin(h * c2) + k * (PI - 2.0 * asin(h / ior))
            });
            (kind.connect(&ball, ior, x, y).len(), scanned)
        });
        let counts = compare(found);

        assert!(counts[..4].iter().all(|&count| count > 10) && counts[4] == 0, "{counts:?}");
    }
}

#[test]
fn paths_across_a_boundary_are_as_many_as_a_scan_finds() {
    let found = configurations().map(|(configuration, y)| {
        let Configuration { ball, ior, inside: x, .. } = configuration;
        let d1 = x.distance(ball.center) / ball.radius;
        let c2 = inverse_distance(ball.center, ball.radius, y);
        let theta = angle(ball.center, x, y);
        let largest = (ior * d1).min(1.0);
        let [near, far] = [1.0, -1.0].map(|sign| {
            count_roots(theta, |s| {
                let h = s * largest;
                let gamma = asin(h / (ior * d1));
                let gamma = if sign > 0.0 { gamma } else { PI - gamma };
                gamma - asin(h / ior) + asin(h) - asin(h * c2)
            })
        });
        let found = SpecularPath::Outward.connect(&ball, ior, x, y).len();
        if ior * d1 <= 1.0 {
            assert_eq!(found, 1);
        }
        if let Target::Point(y) = y {
            let inward = SpecularPath::Inward.connect(&ball, ior, y, Target::Point(x));
            assert_eq!(inward.len(), found);
        }
        (found, near.zip(far).map(|(near, far)| near + far))
    });
    let counts = compare(found);

    assert!(counts[..4].iter().all(|&count| count > 10) && counts[4] == 0, "{counts:?}");
}
