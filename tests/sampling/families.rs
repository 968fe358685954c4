//! Families of integrands over the pixel's square and the light's.

use photosphere::sampling::{Sampler, exp, sin_cos_2pi};

/// Two numbers for the position in the pixel, two for the direction to the light.
pub(crate) type Point = [f64; 4];

pub(crate) type Integrand = Box<dyn Fn(Point) -> f64>;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Family {
    /// An edge in the pixel, and an edge that hides part of the light.
    EdgeTimesEdge,
    /// An edge in the pixel, and a ball that hides part of the light.
    EdgeTimesDisc,
    /// A shadow's edge that moves over the light by up to the light's width within the pixel.
    Penumbra,
    /// Shading that varies over the pixel, and an edge that hides part of the light.
    ShadingTimesEdge,
    /// A function smooth in all four numbers.
    Smooth,
    /// A shadow's edge that moves by less than a fifth of the light's width within the pixel.
    WidePenumbra,
    /// An edge that hides part of the light, nothing else.
    EdgeAnywhere,
    /// A ball that hides part of the light, nothing else.
    DiscAnywhere,
    /// A disc of radius 0.4 in the middle of the light's square, nothing else.
    DiscInTheMiddle,
}

impl Family {
    pub(crate) const PIXEL_AND_LIGHT: [Self; 6] = [
        Self::EdgeTimesEdge,
        Self::EdgeTimesDisc,
        Self::Penumbra,
        Self::ShadingTimesEdge,
        Self::Smooth,
        Self::WidePenumbra,
    ];
}

/// Returns the members of a family: 64, with parameters at random.
pub(crate) fn draw(family: Family) -> Vec<Integrand> {
    (0..64)
        .map(|member| integrand(family, Numbers(Sampler::independent(1, 0, member), 0)))
        .collect()
}

/// The numbers that choose a member.
struct Numbers(Sampler, u32);

impl Numbers {
    fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.1 += 1;
        from + (to - from) * self.0.get(self.1)
    }
}

fn integrand(family: Family, mut numbers: Numbers) -> Integrand {
    let numbers = &mut numbers;
    match family {
        Family::EdgeTimesEdge => {
            let [pixel, light] = [edge(numbers), edge(numbers)];
            Box::new(move |p| pixel([p[0], p[1]]) * light([p[2], p[3]]))
        }
        Family::EdgeTimesDisc => {
            let (pixel, light) = (edge(numbers), disc(numbers));
            Box::new(move |p| pixel([p[0], p[1]]) * light([p[2], p[3]]))
        }
        Family::Penumbra => penumbra(numbers, 1.0),
        Family::WidePenumbra => penumbra(numbers, 0.2),
        Family::ShadingTimesEdge => {
            let slope = [numbers.uniform(0.0, 1.0), numbers.uniform(0.0, 1.0)];
            let light = edge(numbers);
            Box::new(move |p| (1.0 + slope[0] * p[0] + slope[1] * p[1]) * light([p[2], p[3]]))
        }
        Family::Smooth => {
            let rate = [(); 4].map(|()| numbers.uniform(-2.0, 2.0));
            Box::new(move |p| exp(p.iter().zip(rate).map(|(x, rate)| x * rate).sum()))
        }
        Family::EdgeAnywhere => {
            let light = edge(numbers);
            Box::new(move |p| light([p[2], p[3]]))
        }
        Family::DiscAnywhere => {
            let light = disc(numbers);
            Box::new(move |p| light([p[2], p[3]]))
        }
        Family::DiscInTheMiddle => {
            Box::new(|p| indicator((p[2] - 0.5).powi(2) + (p[3] - 0.5).powi(2) < 0.16))
        }
    }
}

fn indicator(inside: bool) -> f64 {
    f64::from(u8::from(inside))
}

/// Returns the position along a random direction, measured from the middle of the square.
fn along(numbers: &mut Numbers) -> impl Fn([f64; 2]) -> f64 + use<> {
    let (sin, cos) = sin_cos_2pi(numbers.uniform(0.0, 1.0));
    move |[x, y]| (x - 0.5) * cos + (y - 0.5) * sin
}

/// Returns a half-plane whose edge crosses the square.
fn edge(numbers: &mut Numbers) -> impl Fn([f64; 2]) -> f64 + use<> {
    let (along, offset) = (along(numbers), numbers.uniform(-0.5, 0.5));
    move |p| indicator(along(p) < offset)
}

fn disc(numbers: &mut Numbers) -> impl Fn([f64; 2]) -> f64 + use<> {
    let [x, y] = [(); 2].map(|()| numbers.uniform(0.0, 1.0));
    let radius = numbers.uniform(0.2, 0.6);
    move |p| indicator((p[0] - x).powi(2) + (p[1] - y).powi(2) < radius * radius)
}

/// Returns an edge over the light that moves with the position in the pixel.
fn penumbra(numbers: &mut Numbers, max_slope: f64) -> Integrand {
    let (pixel, light) = (along(numbers), along(numbers));
    let (slope, offset) = (numbers.uniform(0.0, max_slope), numbers.uniform(-0.4, 0.4));
    Box::new(move |p| indicator(light([p[2], p[3]]) < slope * pixel([p[0], p[1]]) + offset))
}
