//! Which errors of a pixel show on a screen.
//!
//! A picture is looked at through a tone curve, in 8 bits. An error of a tenth is plain in the
//! middle greys, and cannot be seen in a dark gap or in burnt white. A target in displayed values
//! therefore stops where the eye is content, where a target relative to the brightness goes on.

use crate::color::{Rgb, ViewTransform};

/// The numbers between which thresholds are interpolated: powers of two, so many for each factor of
/// two.
const STEPS_PER_STOP: f64 = 16.0;
/// Binary logarithms of the darkest and the brightest number. Below the first all is black on any
/// screen; above the second all is white.
const STOPS: (f64, f64) = (-20.0, 12.0);

/// The error of a linear value that changes its displayed value by a certain amount.
#[derive(Debug)]
pub(super) struct DisplayScale {
    /// For a value of 0, and for each of the numbers; divided by the amount.
    thresholds: Vec<f64>,
}

impl DisplayScale {
    /// The scale for errors up to `error`, of pictures seen through this view transform.
    pub(super) fn new(view: ViewTransform, error: f64) -> Self {
        let display = |x: f64| f64::from(view.to_display(Rgb::splat(x as f32))[1]);
        let count = ((STOPS.1 - STOPS.0) * STEPS_PER_STOP) as usize;
        let numbers = (0..=count + 1).map(number);
        let threshold = |x: f64| threshold(&display, x, error) / error;
        Self { thresholds: numbers.map(threshold).collect() }
    }

    /// The brightness to which an error of this value is relative, so that an error as large as the
    /// target's changes the displayed value by so much.
    pub(super) fn brightness(&self, value: f64) -> f64 {
        let last = self.thresholds.len() - 1;
        let stops = libm::log2(value.max(f64::MIN_POSITIVE));
        let step =
            (1.0 + (stops - STOPS.0) * STEPS_PER_STOP).clamp(0.0, (last - 1) as f64) as usize;
        // Between the numbers the threshold is nearly linear, and for burnt white exactly.
        let [below, above] = [step, step + 1].map(number);
        let share = ((value - below) / (above - below)).clamp(0.0, 1.0);
        self.thresholds[step] * (1.0 - share) + self.thresholds[step + 1] * share
    }
}

/// The first number is 0, the others are powers of two.
fn number(step: usize) -> f64 {
    match step {
        0 => 0.0,
        _ => libm::exp2(STOPS.0 + (step - 1) as f64 / STEPS_PER_STOP),
    }
}

/// How far a value may be from `x` until it is shown `amount` away, in the direction in which that
/// is less far.
fn threshold(display: &impl Fn(f64) -> f64, x: f64, amount: f64) -> f64 {
    let shown = display(x);
    let distance = |is_wrong: &dyn Fn(f64) -> bool, mut near: f64, mut far: f64| {
        // Forty halvings are more than f32 can tell apart.
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            if is_wrong(middle) { far = middle } else { near = middle }
        }
        (far - x).abs()
    };
    let most = 2.0 * x + libm::exp2(STOPS.1);
    let below = (shown - amount >= display(0.0))
        .then(|| distance(&|y| display(y) <= shown - amount, x, 0.0));
    let above = (shown + amount <= display(most))
        .then(|| distance(&|y| display(y) >= shown + amount, x, most));
    below.into_iter().chain(above).fold(f64::INFINITY, f64::min).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::ToneCurve;
    use crate::job::{NoiseTarget, Quality};
    use proptest::prelude::*;

    fn shown(view: ViewTransform, x: f64) -> f64 {
        f64::from(view.to_display(Rgb::splat(x as f32))[1])
    }

    proptest! {
        #[test]
        fn an_error_of_one_threshold_shows_as_the_amount(
            stops in -9.0..4.0f64, exposure in -2.0..2.0f32, curve in 0..3usize, quality in 0..3usize,
        ) {
            let view = ViewTransform { exposure, tone: ToneCurve::NAMES[curve].1, dither: false };
            let target = Quality::NAMES[quality].1.target(view);
            let scale = NoiseTarget::display_scale(&target).expect("a target in displayed values");
            let x = stops.exp2();
            let error = target.error * scale.brightness(x);
            let changes = [x - error, x + error].map(|y| (shown(view, y.max(0.0)) - shown(view, x)).abs());
            let largest = changes[0].max(changes[1]);
            // The steps between the numbers are interpolated.
            let is_white = shown(view, x) > 0.999;
            prop_assert!(largest < 1.1 * target.error, "{x}: {changes:?} of {}", target.error);
            prop_assert!(is_white || largest > 0.9 * target.error, "{x}: {changes:?}");
        }
    }

    #[test]
    fn what_cannot_be_seen_may_be_far_off() {
        let target = Quality::Good.target(ViewTransform::default());
        let scale = NoiseTarget::display_scale(&target).expect("a target in displayed values");
        // Relative to the value: a dark gap, a middle grey, and a lamp.
        let relative = [0.0005, 0.2, 20.0].map(|x| target.error * scale.brightness(x) / x);
        assert!(relative[0] > 1.0 && relative[1] < 0.1 && relative[2] > 0.9, "{relative:?}");
        assert!(scale.brightness(-1.0) > 0.0 && scale.brightness(f64::MAX).is_finite());
        assert!(NoiseTarget::new(0.01).display_scale().is_none());
    }
}
