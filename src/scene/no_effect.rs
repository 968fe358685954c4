//! Overrides of `[render]` that change nothing, because of what other settings say.

use super::settings::{Estimator, IntegratorSettings, RenderSettings};

impl RenderSettings {
    /// Why a value given for the key `render.KEY` has no effect; `None` if it has one.
    pub(super) fn why_no_effect(&self, key: &str) -> Option<String> {
        use IntegratorSettings::{AmbientOcclusion, Direct, Paper, Path, Raycast};
        let integrator = self.integrator;
        let samples_light = matches!(integrator, Path | Direct);
        let is_used = match key.split('.').next()? {
            "estimator" => samples_light,
            "caustics" | "light_choice" if samples_light && self.estimator == Estimator::Bsdf => {
                return Some("the estimator `bsdf` samples no lights".to_owned());
            }
            "caustics" | "light_choice" => samples_light,
            "max_depth" => matches!(integrator, Path | Direct | Paper(_)),
            "clamp_indirect" => matches!(integrator, Path | Paper(_)),
            "paper" => matches!(integrator, Paper(_)),
            "raycast" => matches!(integrator, Raycast { .. }),
            "ambient_occlusion" => matches!(integrator, AmbientOcclusion { .. }),
            _ => true,
        };
        (!is_used).then(|| format!("the integrator `{}` does not use it", integrator.kind().name()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_integrator_leaves_out_what_others_use() {
        let path = RenderSettings::default();
        let with = |integrator| RenderSettings { integrator, ..path };
        let paper = with(IntegratorSettings::Paper(Default::default()));
        let normals = with(IntegratorSettings::Normals);
        let direct = with(IntegratorSettings::Direct);
        let chance = RenderSettings { estimator: Estimator::Bsdf, ..path };
        let cases = [
            (&path, ["paper.samples", "raycast.shadows", "ambient_occlusion.distance"].as_slice()),
            (&paper, &["estimator", "caustics", "light_choice"]),
            (&normals, &["estimator", "max_depth", "clamp_indirect"]),
            (&direct, &["clamp_indirect"]),
            (&chance, &["caustics", "light_choice"]),
        ];
        let keys = ["estimator", "caustics", "light_choice", "max_depth", "clamp_indirect"];
        for (settings, idle) in cases {
            for key in idle {
                assert!(settings.why_no_effect(key).is_some(), "{key}");
            }
        }
        assert!(keys.iter().all(|key| path.why_no_effect(key).is_none()));
        assert!(paper.why_no_effect("paper.samples").is_none());
        assert!(normals.why_no_effect("seed").is_none());
    }
}
