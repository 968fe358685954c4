//! Indices of refraction of glasses, crystals and liquids.
//!
//! One number each, at the sodium D line (589.3 nm), relative to vacuum or air, which differ by
//! 0.0003. The underlying dispersion formulas and tables are in the refractiveindex.info database
//! (public domain).

/// Every named glass, crystal and liquid: its name in scene files, and its index of refraction.
pub const NAMED_IORS: [(&str, f64); 21] = [
    // Edlen (1966) and later: dry air at 15 degrees.
    ("air", 1.00028),
    // Warren and Brandt (2008), at -7 degrees.
    ("ice", 1.3097),
    // Daimon and Masumura (2007), at 20 degrees.
    ("water", 1.3334),
    // Kedenburg et al. (2012).
    ("ethanol", 1.3615),
    // Rheims, Koeser and Wriedt (1997).
    ("glycerol", 1.4722),
    // Malitson (1963): calcium fluoride.
    ("fluorite", 1.4338),
    // Malitson (1965).
    ("fused-silica", 1.4584),
    // Sultanova, Kasarova and Nikolov (2009): PMMA.
    ("acrylic", 1.4905),
    // Sultanova, Kasarova and Nikolov (2009).
    ("polycarbonate", 1.5846),
    // Schott's catalogue: N-BK7, the usual optical crown glass.
    ("bk7", 1.5167),
    // Schott: N-BAK4.
    ("bak4", 1.5687),
    // Schott: F2, flint glass as in lead crystal.
    ("f2", 1.6199),
    // Schott: SF10.
    ("sf10", 1.7281),
    // Schott: SF11.
    ("sf11", 1.7845),
    // Rubin (1985): window glass.
    ("soda-lime", 1.5233),
    // Ghosh (1999), the ordinary ray.
    ("quartz", 1.5442),
    // Li (1976): sodium chloride.
    ("salt", 1.5441),
    // Malitson and Dodge (1972), the ordinary ray; ruby has the same index.
    ("sapphire", 1.7681),
    // Wood and Nassau (1982).
    ("cubic-zirconia", 2.1585),
    // Peter (1923).
    ("diamond", 2.4173),
    // Devore (1951), the ordinary ray of titanium dioxide.
    ("rutile", 2.6129),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Square of the D line's wavelength in micrometres.
    const SQUARED: f64 = 0.5893 * 0.5893;

    /// Sellmeier's formula, `n^2 = first + terms b l^2 / (l^2 - c)`.
    fn sellmeier(first: f64, terms: &[(f64, f64)]) -> f64 {
        let term = |(b, c): &(f64, f64)| b * SQUARED / (SQUARED - c);
        (first + terms.iter().map(term).sum::<f64>()).sqrt()
    }

    /// Sellmeier's formula, given resonance wavelengths instead of their squares.
    fn resonances(first: f64, terms: &[(f64, f64)]) -> f64 {
        let squared: Vec<_> = terms.iter().map(|(b, l)| (*b, l * l)).collect();
        sellmeier(first, &squared)
    }

    #[rustfmt::skip]
    fn published() -> [(&'static str, f64); 18] {
        [
            ("ethanol", sellmeier(1.0, &[(0.83189, 0.00930), (-0.15582, -49.45200)])),
            ("water", sellmeier(1.0, &[(0.5684027565, 5.101829712e-3), (0.1726177391, 1.821153936e-2), (2.086189578e-2, 2.620722293e-2), (0.1130748688, 10.69792721)])),
            ("glycerol", 1.45797 + 0.00598 / SQUARED - 0.00036 / (SQUARED * SQUARED)),
            ("fluorite", resonances(1.0, &[(0.5675888, 0.050263605), (0.4710914, 0.1003909), (3.8484723, 34.649040)])),
            ("fused-silica", resonances(1.0, &[(0.6961663, 0.0684043), (0.4079426, 0.1162414), (0.8974794, 9.896161)])),
            ("acrylic", sellmeier(1.0, &[(1.1819, 0.011313)])),
            ("polycarbonate", sellmeier(1.0, &[(1.4182, 0.021304)])),
            ("bk7", sellmeier(1.0, &[(1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)])),
            ("bak4", sellmeier(1.0, &[(1.28834642, 0.00779980626), (0.132817724, 0.0315631177), (0.945395373, 105.965875)])),
            ("f2", sellmeier(1.0, &[(1.34533359, 0.00997743871), (0.209073176, 0.0470450767), (0.937357162, 111.886764)])),
            ("sf10", sellmeier(1.0, &[(1.62153902, 0.0122241457), (0.256287842, 0.0595736775), (1.64447552, 147.468793)])),
            ("sf11", sellmeier(1.0, &[(1.73759695, 0.013188707), (0.313747346, 0.0623068142), (1.89878101, 155.23629)])),
            ("quartz", sellmeier(1.28604141, &[(1.07044083, 0.0100585997), (1.10202242, 100.0)])),
            ("salt", resonances(1.00055, &[(0.198, 0.05), (0.48398, 0.1), (0.38696, 0.128), (0.25998, 0.158), (0.08796, 40.5), (3.17064, 60.98), (0.30038, 120.34)])),
            ("sapphire", resonances(1.0, &[(1.4313493, 0.0726631), (0.65054713, 0.1193242), (5.3414021, 18.028251)])),
            ("cubic-zirconia", resonances(1.0, &[(1.347091, 0.062543), (2.117788, 0.166739), (9.452943, 24.320570)])),
            ("diamond", resonances(1.0, &[(0.3306, 0.175), (4.3356, 0.106)])),
            ("rutile", (5.913 + 0.2441 / (SQUARED - 0.0803)).sqrt()),
        ]
    }

    #[test]
    fn indices_are_those_of_the_published_formulas() {
        for (name, expected) in published() {
            let found = NAMED_IORS.iter().find(|(known, _)| *known == name).expect("known").1;
            assert!((found - expected).abs() <= 6e-5, "{name}: {found}, but {expected}");
        }
    }
}
