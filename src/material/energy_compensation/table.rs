//! A tabulated function of a direction's cosine, with smooth interpolation.

/// A tabulated function of the cosine in `[0, 1]`. Its nodes are dense near the horizon.
#[derive(Clone, Copy, Debug)]
pub(super) struct CosineTable<const NODES: usize> {
    values: [f32; NODES],
    /// Half of the nodes are dense at cosines below the first, half below the second.
    knees: [f64; 2],
}

impl<const NODES: usize> CosineTable<NODES> {
    /// Tabulates `f`, with nodes dense at cosines below each of `knees`.
    pub(super) fn new(knees: [f64; 2], f: impl Fn(f64) -> f64) -> Self {
        let node = |i: usize| f(table_cosine(i as f64 / (NODES - 1) as f64, knees)) as f32;
        Self { values: std::array::from_fn(node), knees }
    }

    /// Interpolates at a cosine: Catmull-Rom cubic, and beyond the first and the last node the
    /// parabola through the nearest three.
    pub(super) fn eval(&self, cos: f64) -> f64 {
        let last = NODES - 1;
        let coordinate = table_coordinate(cos.clamp(0.0, 1.0), self.knees) * last as f64;
        let index = (coordinate as usize).min(last - 1);
        let node = |i: usize| f64::from(self.values[i]);
        let (b, c) = (node(index), node(index + 1));
        let a = if index > 0 { node(index - 1) } else { 3.0 * b - 3.0 * c + node(index + 2) };
        let d = if index + 2 <= last { node(index + 2) } else { 3.0 * c - 3.0 * b + a };
        let t = coordinate - index as f64;
        let curvature = 2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a);
        b + 0.5 * t * (c - a + t * curvature)
    }
}

/// Maps a cosine to its table coordinate in `[0, 1]`: dense near 0, and denser for a narrow lobe.
fn table_coordinate(cos: f64, knees: [f64; 2]) -> f64 {
    let [a, b] = knees.map(|knee| (cos * (1.0 + knee) / (knee + cos)).sqrt());
    0.5 * (a + b)
}

/// The inverse of [`table_coordinate`].
fn table_cosine(coordinate: f64, knees: [f64; 2]) -> f64 {
    let square = coordinate * coordinate;
    let [a, b] = knees.map(|knee| (knee * square / (1.0 + knee - square)).min(1.0));
    // The root lies between the roots for each knee alone.
    let (mut low, mut high) = (a.min(b), a.max(b));
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if table_coordinate(middle, knees) < coordinate { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const BENDS: [f64; 2] = [0.01, 0.5];

    #[test]
    fn parabolas_of_the_place_are_kept_and_nodes_are_met() {
        let f = |cos: f64| {
            let coordinate = table_coordinate(cos, BENDS);
            1.0 + coordinate * (2.0 - 3.0 * coordinate)
        };
        let table = CosineTable::<8>::new(BENDS, f);
        for cos in [0.0, 1e-4, 0.03, 0.2, 0.5, 0.9, 0.99, 1.0] {
            assert_relative_eq!(table.eval(cos), f(cos), epsilon = 1e-6);
        }
    }
}
