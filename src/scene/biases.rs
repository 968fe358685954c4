//! Which of a scene's options bias its picture: those with which no number of samples brings it to
//! the light that the scene has. Pictures carry this list with them. And which of its materials no
//! real surface can resemble, because they make light.

use crate::material::Phong;

use super::description::{SceneDescription, SurfaceModel};
use super::settings::{IntegratorSettings, MissPolicy, PathTermination, RenderSettings};

impl SceneDescription {
    /// The materials that reflect more light than they receive, by name, with the largest share that
    /// they send on: classic Phong surfaces. The colours of sphere tables are not looked at.
    pub fn energy_creating_materials(&self) -> Vec<(&str, f32)> {
        let up_to = |surface: &SurfaceModel| match *surface {
            SurfaceModel::Phong { albedo, specular, exponent, normalized } => {
                Phong { albedo, specular, exponent, normalized }.max_albedo().max_element()
            }
            _ => 1.0,
        };
        let shares = self.materials.iter().map(|m| (m.name.as_str(), up_to(&m.surface)));
        // Not what rounding makes of exactly 1.
        shares.filter(|(_, share)| *share > 1.0 + 1e-5).collect()
    }
}

impl RenderSettings {
    /// The options that bias the picture, as `key = value`; empty for a picture that can be trusted.
    ///
    /// Integrators that are not after the whole light say so by their names: `direct`,
    /// `ambient-occlusion`, `normals` and `raycast` are not biased by leaving out what they do not
    /// show.
    pub fn biases(&self) -> Vec<String> {
        let mut biases = Vec::new();
        let follows_paths = matches!(
            self.integrator,
            IntegratorSettings::Path | IntegratorSettings::Direct | IntegratorSettings::Paper(_)
        );
        if !follows_paths {
            return biases;
        }
        if let Some(depth) = self.max_depth {
            biases.push(format!("max_depth = {depth}"));
        }
        if let Some(limit) =
            self.clamp_indirect.filter(|_| self.integrator != IntegratorSettings::Direct)
        {
            biases.push(format!("clamp_indirect = {limit}"));
        }
        if let IntegratorSettings::Paper(paper) = self.integrator {
            match paper.stop {
                PathTermination::Roulette => {}
                PathTermination::Depth => biases.push("paper.stop = \"depth\"".to_owned()),
                PathTermination::Threshold(threshold) => {
                    biases.push("paper.stop = \"threshold\"".to_owned());
                    biases.push(format!("paper.threshold = {threshold}"));
                }
            }
            if paper.miss == MissPolicy::Redraw {
                biases.push("paper.miss = \"redraw\"".to_owned());
            }
            if paper.jitter < 1.0 {
                biases.push(format!("paper.jitter = {}", paper.jitter));
            }
        }
        biases
    }
}
