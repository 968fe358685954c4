//! The edges of a simulation cell as chains of small spheres.

use crate::math::DVec3;

/// Most spheres along one edge.
const MAX_PER_EDGE: usize = 4000;

/// Centres of spheres of this radius along the twelve edges of a parallelepiped, so dense that they
/// look like a line.
pub(super) fn cell_edges(origin: DVec3, [a, b, c]: [DVec3; 3], radius: f64) -> Vec<DVec3> {
    let starts_of = |u: DVec3, v: DVec3| [origin, origin + u, origin + v, origin + u + v];
    let edges = [(a, starts_of(b, c)), (b, starts_of(c, a)), (c, starts_of(a, b))];
    let mut centers = Vec::new();
    for (along, starts) in edges {
        let count = (along.length() / (0.5 * radius)).ceil().clamp(1.0, MAX_PER_EDGE as f64);
        for start in starts {
            let step = |i: usize| start + along * (i as f64 / count);
            centers.extend((1..count as usize).map(step));
        }
    }
    let corner = |i: usize| {
        let along = |edge: DVec3, bit: usize| if i >> bit & 1 == 1 { edge } else { DVec3::ZERO };
        origin + along(a, 0) + along(b, 1) + along(c, 2)
    };
    centers.extend((0..8).map(corner));
    centers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twelve_edges_join_eight_corners() {
        let centers = cell_edges(DVec3::ONE, [DVec3::X * 4.0, DVec3::Y * 2.0, DVec3::Z], 0.5);
        let at_corner = |corner: &DVec3| centers.iter().filter(|c| *c == corner).count();
        let corners = [DVec3::ONE, DVec3::new(5.0, 3.0, 2.0), DVec3::new(5.0, 1.0, 2.0)];
        assert_eq!(corners.map(|corner| at_corner(&corner)), [1; 3]);
        let is_on_edge = |c: &DVec3| {
            let at_end = [(c.x, 1.0, 5.0), (c.y, 1.0, 3.0), (c.z, 1.0, 2.0)];
            at_end.iter().filter(|(x, low, high)| x == low || x == high).count() >= 2
        };
        assert!(centers.iter().all(is_on_edge));
        assert_eq!(centers.len(), 4 * (15 + 7 + 3) + 8);
    }

    #[test]
    fn long_edges_do_not_take_all_memory() {
        let centers = cell_edges(DVec3::ZERO, [DVec3::X * 1e12, DVec3::Y, DVec3::Z], 1e-3);
        assert!(centers.len() < 12 * (MAX_PER_EDGE + 1) + 12);
    }
}
