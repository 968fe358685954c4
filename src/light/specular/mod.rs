//! Specular connections: the light that reaches a point over one polished ball, computed instead of
//! found by chance.
//!
//! Two points x and y and a ball lie in one plane, and a reflection or refraction at a ball stays
//! in the plane through its centre. So a path from x over the ball to y is the root of an equation
//! in one unknown. All functions here are pure, in f64, and use neither angles nor transcendental
//! functions. They know nothing of lights and media: who calls them chooses y, and looks whether
//! anything is in the way.
//!
//! # Letters
//! Lengths are in radii of the ball, whose centre is the origin. x and y are at the distances `d1`
//! and `d2`, `theta` apart as seen from the centre, and `a` and `b` are the legs at x and y. A ray
//! meets the ball everywhere at the same angles: `i` from the normal outside, `t` inside, with
//! Snell's law `h = sin i = n sin t`, where `n` is the index of refraction inside over that outside
//! and `h` the distance of the outer ray from the centre. At x the ray is `alpha` from the axis
//! through x, at y it is `beta` from that through y: `sin alpha = h / d1`, `sin beta = h / d2`.
//!
//! # The equation
//! Going along the path, the angle at the centre grows by `i - alpha` on the leg at x, by
//! `pi - 2 t` on each chord, and by `i - beta` on the leg at y.
//!
//! 1. *Reflection off the outside* ([`SpecularPath::Reflection`]): `2 i - alpha - beta = theta`.
//!    The left side grows with `i`, because `cos i < d1 cos alpha`: their difference is the leg
//!    `a`. It ends where the ray grazes the ball, so there is one root if the segment misses the
//!    ball, and none if not.
//! 2. *Through the ball* ([`SpecularPath::Through`]) with `k` reflections on its inner side:
//!    `Phi(h) = 2 i - alpha - beta + (k + 1) (pi - 2 t) = +-theta + 2 pi m`. Multiplied by `cos i`,
//!    its derivative is `2 - A - B - C` with `A = sqrt((1 - h^2) / (d1^2 - h^2))`, `B` the same
//!    with `d2`, and `C = 2 (k + 1) sqrt((1 - h^2) / (n^2 - h^2))`. For `n > 1` all three fall with
//!    `h`: `Phi` has at most one stationary point, the fold, and each value at most two roots. For
//!    `n < 1`, where `h < n`, `C` exceeds 2, and `Phi` falls.
//! 3. *Across one boundary* ([`SpecularPath::Outward`], [`SpecularPath::Inward`]), with x inside,
//!    at the angle `gamma` from the outward axis: `sin t = d1 sin gamma`, and
//!    `G(gamma) = gamma - t + i - beta = theta`, up to the sign of `theta` and full turns. If
//!    `n d1 < 1`, no ray is reflected totally, `G` grows from 0 to pi, and there is one root. If
//!    not, `G` grows where `gamma < pi / 2` up to total reflection; beyond it, on the far side,
//!    `d G / d h` is again a constant minus three functions that fall, over `cos i`.
//!
//! There are 0 to 3 roots for `k = 0` and across a boundary, 0 to 4 for `k = 1` (4 only if both
//! points nearly touch the ball).
//!
//! # The spread
//! The density of a connection follows from the area `dA` across the ray at y that a solid angle
//! `dw` at x is spread over. Turned around the axis through x, `dw = sin alpha dalpha dphi` and `dA
//! = (d2 cos beta dtheta) (d2 sin theta dphi)`, so
//!
//! ```text
//! dA / dw = d2^2 cos(beta) |sin(theta) / sin(alpha)| |d theta / d alpha|
//! d theta / d alpha = d1 cos(alpha) Phi'(h)
//! ```
//!
//! and across a boundary with `gamma` and `G'(gamma)` instead of `alpha`. For a direction in place
//! of y, such as a point of the sun, `d2` is infinite, `beta` is 0 and the solid angle of y takes
//! the place of `dA / d2^2`. Reflection has a closed form with one sign only,
//! `dA / dw = (a + b + 2 a b / cos i) (a + b + 2 a b cos i)`, never below `(a + b)^2`. The spread
//! is 0 at two caustics: the fold, where `Phi' = 0`, and the axis `theta = 0` or `pi`, where the
//! roots away from `h = 0` form a ring. A bundle of rays between x and y is the same both ways,
//! `n_x^2 dA_x dw_x = n_y^2 dA_y dw_y`, which gives the spread from outside inward.
//!
//! Radiance is multiplied by the reflectance or transmittance of each point and, from a medium of
//! index `n_y` to one of `n_x`, by `(n_x / n_y)^2`.

mod boundary;
mod casters;
mod connection;
mod deflection;
mod emitter_view;
mod equation;
mod few_pairs;
mod focusing;
mod lanes;
mod pair;
mod pair_trees;
mod pairs;
mod path_kind;
mod phase;
mod plane;
mod reflection;
mod root;
mod spread;
mod through;
mod worth;

#[cfg(test)]
mod tests;

pub use casters::{Caster, CasterSurface, Casters};
pub use connection::{Connection, Connections, MAX_CONNECTIONS};
pub use emitter_view::{EmitterPoint, EmitterView};
pub use lanes::{EndLanes, RootFinder, RootLanes};
pub use pair::{CasterPair, ConnectedLight};
pub use pairs::{CasterPairs, MAX_PAIRS, PairSampler};
pub use path_kind::SpecularPath;
pub use plane::Target;
pub use worth::{PairWorth, is_accepted};
