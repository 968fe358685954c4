//! How often lamps, dome and sun are aimed at from a point: by the irradiance to be expected of each.
//! What may be in the way is not known, so a share goes to each alike.

use super::background::Background;
use super::choice::Choice;
use super::receiver::Receiver;

/// The share of choices that treats alike all that may shine on a point.
const UNIFORM_SHARE: f64 = 0.2;

/// What there is to aim at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Lamps,
    Dome,
    Sun,
}

/// The probability of each kind, in the order of the enum.
pub(super) struct Shares {
    shares: [f64; 3],
}

impl Shares {
    /// `None` where nothing can be aimed at.
    pub(super) fn new(
        choice: &Choice,
        has_lamps: bool,
        background: &Background,
        from: &Receiver,
    ) -> Option<Self> {
        if !background.is_aimed_at() {
            return has_lamps.then_some(Self { shares: [1.0, 0.0, 0.0] });
        }
        let sun = background.sun().map_or(0.0, |sun| sun.importance(from));
        let dome = background.importance(from);
        // A scene with lamps alone is the common case, and they need not be weighed there.
        let lamps = match sun > 0.0 || dome > 0.0 {
            true => choice.importance(from),
            false => f64::from(u8::from(has_lamps)),
        };
        let importance = [lamps, dome, sun];
        let total: f64 = importance.iter().sum();
        let count = importance.iter().filter(|&&importance| importance > 0.0).count() as f64;
        let share = |importance| match importance > 0.0 {
            true => UNIFORM_SHARE / count + (1.0 - UNIFORM_SHARE) * importance / total,
            false => 0.0,
        };
        (total > 0.0).then(|| Self { shares: importance.map(share) })
    }

    /// The probability of a kind.
    pub(super) fn of(&self, kind: Kind) -> f64 {
        self.shares[kind as usize]
    }

    /// The kind chosen by `u` in `[0, 1)`, its probability, and what is left of `u`: again uniform.
    pub(super) fn choose(&self, mut u: f64) -> (Kind, f64, f64) {
        let mut last = (Kind::Lamps, self.shares[0], u);
        for kind in [Kind::Lamps, Kind::Dome, Kind::Sun] {
            let share = self.of(kind);
            if share > 0.0 {
                last = (kind, share, (u / share).min(1.0 - f64::EPSILON));
                if u < share {
                    break;
                }
                u -= share;
            }
        }
        last
    }
}
