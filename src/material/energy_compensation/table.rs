//! A tabulated function of a direction's cosine, with smooth interpolation.

/// A tabulated function of the cosine in `[0, 1]`. Its nodes are dense near the horizon.
#[derive(Clone, Copy, Debug)]
pub(super) struct CosineTable<const NODES: usize> {
    values: [f32; NODES],
    /// Half of the nodes are dense at cosines below the first, half below the second.
    knees: [f64; 2],
}

impl<const NODES: usize> CosineTable<NODES> {
    /// Tabulates `f`, with nodes dense at cosines below each of `bends`.
    pub(super) fn new(bends: [f64; 2], f: impl Fn(f64) -> f64) -> Self {
        let node = |i: usize| f(table_cosine(i as f64 / (NODES - 1) as f64, bends)) as f32;
        Self { values: std::array::from_fn(node), knees: bends }
    }

    /// Interpolates at a cosine: Catmull-Rom cubic, and beyond the first and the last node the
    /// parabola through the nearest three.
    pub(super) fn eval(&self, cos: f64) -> f64 {
        let last = NODES - 1;
        let place = table_coordinate(cos.clamp(0.0, 1.0), self.knees) * last as f64;
        let below = (place as usize).min(last - 1);
        let node = |i: usize| f64::from(self.values[i]);
        let (b, c) = (node(below), node(below + 1));
        let a = if below > 0 { node(below - 1) } else { 3.0 * b - 3.0 * c + node(below + 2) };
        let d = if below + 2 <= last { node(below + 2) } else { 3.0 * c - 3.0 * b + a };
        let t = place - below as f64;
        let bent = 2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a);
        b + 0.5 * t * (c - a + t * bent)
    }
}

/// Maps a cosine to its table coordinate in `[0, 1]`: dense near 0, and denser for a narrow lobe.
fn table_coordinate(cos: f64, bends: [f64; 2]) -> f64 {
    let [a, b] = bends.map(|bend| (cos * (1.0 + bend) / (bend + cos)).sqrt());
    0.5 * (a + b)
}

/// The inverse of [`table_coordinate`].
fn table_cosine(place: f64, bends: [f64; 2]) -> f64 {
    let square = place * place;
    let [a, b] = bends.map(|bend| (bend * square / (1.0 + bend - square)).min(1.0));
    // The root lies between those of either bend alone.
    let (mut low, mut high) = (a.min(b), a.max(b));
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if table_coordinate(middle, bends) < place { low = middle } else { high = middle }
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
            let place = table_coordinate(cos, BENDS);
            1.0 + place * (2.0 - 3.0 * place)
        };
        let table = CosineTable::<8>::new(BENDS, f);
        for cos in [0.0, 1e-4, 0.03, 0.2, 0.5, 0.9, 0.99, 1.0] {
            assert_relative_eq!(table.eval(cos), f(cos), epsilon = 1e-6);
        }
    }
}
