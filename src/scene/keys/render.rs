//! The keys of `[render]` and its tables, and which of its plain values stands under which.

use crate::scene::settings::{
    Caustics, Estimator, Hemisphere, IntegratorKind, LightSamplerKind, MissPolicy,
    PathTerminationKind, RenderSettings, SamplerKind,
};
use crate::scene::value_types::{Boolean, EnumValue, Integer, Number, NumberRange};

use super::key::DefaultValue::{Derived, Toml};
use super::key::{CliOption, DynKey, Key, KeyVisitor, key, key_with_option, keys, option};
use super::limits::{LENGTH, MAX_RADIANCE, UNIT_INTERVAL};

keys! {
    INTEGRATOR: EnumValue<IntegratorKind> = key_with_option("integrator", EnumValue::NEW, Toml("\"path\""), "the integrator",
        option("integrator", "NAME"));
    ESTIMATOR: EnumValue<Estimator> = key_with_option("estimator", EnumValue::NEW, Toml("\"mis\""), "how light is sampled",
        option("estimator", "NAME"));
    CAUSTICS: EnumValue<Caustics> = key_with_option("caustics", EnumValue::NEW, Toml("\"connect\""), "how light by way of polished balls is found",
        option("caustics", "NAME"));
    SAMPLER: EnumValue<SamplerKind> = key_with_option("sampler", EnumValue::NEW, Derived("sobol; independent for paper"), "the sampler",
        option("sampler", "NAME"));
    SAMPLES: Integer<u32> = key_with_option("samples_per_pixel", Integer(1..=u32::MAX), Derived("64; 1 for normals and raycast; k^2 N for paper"),
        "samples per pixel", CliOption { help: Some("Samples per pixel, from 1"), ..option("spp", "N") });
    SEED: Integer<i64> = key_with_option("seed", Integer(0..=i64::MAX), Toml("0"), "the seed of the random numbers; equal seeds give equal pictures", option("seed", "S"));
    MAX_DEPTH: Integer<u32> = key_with_option("max_depth", Integer(1..=u32::MAX), Derived("no limit"),
        "the longest path in edges: 1 shows emitters only, 2 adds direct light, 3 one indirect bounce", option("max-depth", "D"));
    CLAMP_INDIRECT: Number = key("clamp_indirect", Number(NumberRange::LeftOpen(0.0, MAX_RADIANCE)), Derived("no limit"),
        "the most that one path may add to a channel of indirect light (biased)");
    LIGHT_CHOICE: EnumValue<LightSamplerKind> = key("light_choice", EnumValue::NEW, Toml("\"hierarchy\""), "how next-event estimation chooses an emitter");
}

pub(in crate::scene) mod ambient_occlusion {
    use super::*;
    keys! {
        DISTANCE: Number = key("distance", LENGTH, Derived("no limit"), "only surfaces nearer than this occlude");
    }
}

pub(in crate::scene) mod paper {
    use super::*;
    keys! {
        SUBPIXELS: Integer<u32> = key("subpixels", Integer(1..=256), Toml("2"), "k: a pixel is k x k sub-pixels");
        SAMPLES: Integer<u32> = key("samples", Integer(1..=u32::MAX), Toml("4"), "N: paths per sub-pixel");
        HEMISPHERE: EnumValue<Hemisphere> = key("hemisphere", EnumValue::NEW, Toml("\"cosine\""), "how directions are sampled");
        STOP: EnumValue<PathTerminationKind> = key("stop", EnumValue::NEW, Toml("\"roulette\""), "how a path ends");
        THRESHOLD: Number = key("threshold", Number(NumberRange::LeftOpen(0.0, 1.0)), Toml("0.01"),
            "only with stop = \"threshold\": a path ends when its throughput falls below this");
        MISS: EnumValue<MissPolicy> = key("miss", EnumValue::NEW, Toml("\"background\""), "how a camera ray that hits nothing is treated");
        JITTER: Number = key("jitter", UNIT_INTERVAL, Toml("1"), "the size of the random offset in a sub-pixel");
    }
}

pub(in crate::scene) mod raycast {
    use super::*;
    keys! {
        SHADOWS: Boolean = key("shadows", Boolean, Toml("false"), "whether emitters cast shadows");
    }
}

impl RenderSettings {
    /// Visits the keys whose values depend on no other key.
    pub(in crate::scene) fn visit_keys(&mut self, visitor: &mut impl KeyVisitor) {
        visitor.visit(&CAUSTICS, &mut self.caustics);
        visitor.visit_option(&MAX_DEPTH, &mut self.max_depth);
        visitor.visit_option(&CLAMP_INDIRECT, &mut self.clamp_indirect);
        visitor.visit(&LIGHT_CHOICE, &mut self.light_choice);
    }
}
