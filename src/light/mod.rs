//! The lamps of a scene: emissive spheres, and the choice among them.

use crate::color::{Rgb, luminance};
use crate::geometry::{Cone, Side, Sphere, SphereSet, SurfaceHit};
use crate::math::{DVec3, Frame};
use crate::sampling::{Discrete, Hemisphere};

/// The share of choices that treats all lamps alike. The rest goes by power, which alone would
/// starve a small lamp that happens to be near.
const UNIFORM_SHARE: f64 = 0.5;

/// An emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// The sphere's id.
    pub id: u32,
    /// The radiance it sends out.
    pub emission: Rgb,
}

/// All lamps of a scene.
#[derive(Debug, Default)]
pub struct Lights {
    /// Sorted by id.
    lamps: Vec<Lamp>,
    choice: Option<Discrete>,
}

/// A direction towards a lamp.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Which lamp.
    pub lamp: Lamp,
    /// Unit direction.
    pub direction: DVec3,
    /// Distance to the lamp's surface in that direction.
    pub distance: f64,
    /// Probability of the lamp times the density of the direction per solid angle.
    pub pdf: f64,
}

impl Lights {
    /// The lamps among `spheres`.
    pub fn new(mut lamps: Vec<Lamp>, spheres: &SphereSet) -> Self {
        lamps.sort_unstable_by_key(|lamp| lamp.id);
        let power = |lamp: &Lamp| {
            let radius = spheres.sphere(lamp.id).radius;
            f64::from(luminance(lamp.emission)) * radius * radius
        };
        let total: f64 = lamps.iter().map(power).sum();
        let uniform = UNIFORM_SHARE / lamps.len().max(1) as f64;
        let share = |lamp: &Lamp| uniform + (1.0 - UNIFORM_SHARE) * power(lamp) / total;
        let choice = Discrete::new(lamps.iter().map(share));
        Self { lamps, choice }
    }

    /// Number of lamps.
    pub fn len(&self) -> usize {
        self.lamps.len()
    }

    /// Whether the scene has no lamp.
    pub fn is_empty(&self) -> bool {
        self.lamps.is_empty()
    }

    /// All lamps, sorted by id.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// A direction from a point on a surface to a lamp; `None` where the chosen lamp cannot be
    /// seen from there.
    pub fn sample(
        &self,
        spheres: &SphereSet,
        from: &SurfaceHit,
        choose: f64,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let choice = self.choice.as_ref()?;
        let index = choice.sample(choose);
        let lamp = self.lamps[index];
        let view = View::new(from, lamp.id, &spheres.sphere(lamp.id))?;
        let (direction, distance, pdf) = view.sample(u);
        let pdf = pdf * choice.pmf(index);
        (pdf > 0.0).then_some(LightSample { lamp, direction, distance, pdf })
    }

    /// The density with which [`Self::sample`] draws this direction towards this lamp; 0 for a
    /// sphere that is not a lamp.
    pub fn pdf(&self, spheres: &SphereSet, from: &SurfaceHit, id: u32, direction: DVec3) -> f64 {
        let Some(choice) = &self.choice else { return 0.0 };
        let Ok(index) = self.lamps.binary_search_by_key(&id, |lamp| lamp.id) else { return 0.0 };
        let view = View::new(from, id, &spheres.sphere(id));
        view.map_or(0.0, |view| view.pdf(direction) * choice.pmf(index))
    }
}

/// How a lamp is seen from a point on a surface.
enum View {
    /// From outside: the cone that the lamp fills.
    Outside(Cone),
    /// From inside the lamp, where every direction meets it: the hemisphere above the surface,
    /// by the cosine.
    Inside { frame: Frame, point: DVec3, lamp: Sphere },
}

impl View {
    fn new(from: &SurfaceHit, id: u32, lamp: &Sphere) -> Option<Self> {
        let is_own = from.id == id;
        let is_inside = if is_own { from.side == Side::Inside } else { lamp.contains(from.point) };
        if is_inside {
            let frame = Frame::around(from.facing_normal());
            return Some(Self::Inside { frame, point: from.point, lamp: *lamp });
        }
        let outside = (!is_own).then(|| Cone::seen_from(from.point, lamp)).flatten();
        outside.map(Self::Outside)
    }

    /// Direction, distance and density.
    fn sample(&self, u: [f64; 2]) -> (DVec3, f64, f64) {
        match self {
            Self::Outside(cone) => {
                let sample = cone.sample(u);
                (sample.direction, sample.distance, sample.pdf)
            }
            Self::Inside { frame, point, lamp } => {
                let local = Hemisphere::Cosine.sample(u);
                let direction = frame.to_world(local).normalize();
                let distance = lamp.roots(*point, direction).map_or(0.0, |roots| roots.far);
                (direction, distance, Hemisphere::Cosine.pdf(local.z))
            }
        }
    }

    fn pdf(&self, direction: DVec3) -> f64 {
        match self {
            Self::Outside(cone) => cone.pdf(),
            Self::Inside { frame, .. } => Hemisphere::Cosine.pdf(direction.dot(frame.z).max(0.0)),
        }
    }
}
