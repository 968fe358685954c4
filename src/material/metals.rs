//! Optical constants of metals in linear Rec. 709.
//!
//! Measured constants (n + ik over the wavelength) come from the refractiveindex.info database
//! (public domain): gold, silver and copper from Johnson and Christy (1972); iron, chromium, nickel
//! and titanium from Johnson and Christy (1974); aluminium from Rakic (1995); platinum and tungsten
//! from the Lorentz-Drude fits of Rakic et al. (1998); brass (70 % copper, 30 % zinc) from Querry
//! (1985).
//!
//! A metal has no n and k "of red". A renderer with three channels can only have the right
//! reflectance: for each channel, n and k are the pair whose reflectance at normal incidence and
//! whose mean reflectance over the hemisphere match the spectrum. Both are averaged over the
//! spectrum from 380 to 780 nm under illuminant D65 with the CIE 1931 observer (the fit of Wyman,
//! Sloan and Shirley 2013), converted to linear Rec. 709 and divided by the result for a perfect
//! mirror. Gold's red would be 1.035, outside Rec. 709 and more than the incoming light; its n and
//! k are those at 660 nm instead.

use serde::{Deserialize, Serialize};

use crate::color::Rgb;

/// Complex index of refraction in linear Rec. 709, relative to vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metal {
    /// The real part, n.
    pub ior: Rgb,
    /// The imaginary part, k.
    pub extinction: Rgb,
}

const fn metal(n: [f32; 3], k: [f32; 3]) -> Metal {
    Metal { ior: Rgb::from_array(n), extinction: Rgb::from_array(k) }
}

impl Metal {
    /// Every metal with its name in scene files.
    pub const NAMED: [(&'static str, Self); 12] = [
        ("gold", metal([0.1400, 0.4882, 1.4838], [3.6970, 2.2392, 1.7799])),
        ("silver", metal([0.0567, 0.0549, 0.0438], [4.4760, 3.5485, 2.6108])),
        ("copper", metal([0.2685, 1.0430, 1.2992], [3.6833, 2.6294, 2.3647])),
        ("aluminium", metal([1.4999, 0.9893, 0.6065], [7.6564, 6.5598, 5.3532])),
        ("aluminum", metal([1.4999, 0.9893, 0.6065], [7.6564, 6.5598, 5.3532])),
        ("iron", metal([2.9205, 2.9218, 2.5470], [3.0747, 2.9384, 2.7500])),
        ("chromium", metal([3.2404, 3.1208, 2.2871], [3.2853, 3.3372, 3.1177])),
        ("nickel", metal([2.0474, 1.9067, 1.7329], [4.2044, 3.5760, 2.8986])),
        ("titanium", metal([2.7578, 2.5085, 2.2442], [3.8434, 3.3994, 3.0159])),
        ("platinum", metal([2.3612, 2.0792, 1.8354], [4.2393, 3.6727, 3.0973])),
        ("tungsten", metal([3.6982, 3.4445, 3.3567], [2.9381, 2.7337, 2.5105])),
        ("brass", metal([0.5422, 0.523, 1.1318], [4.5904, 2.6793, 1.8148])),
    ];
}
