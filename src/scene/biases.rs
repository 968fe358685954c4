//! Finds the options that bias a picture, with which no number of samples converges to the scene's
//! light; pictures record this list. Also finds the materials that create energy, which no real
//! surface can.

use crate::material::Phong;

use super::description::{SceneDescription, SurfaceModel};
use super::settings::{IntegratorSettings, MissPolicy, PathTermination, RenderSettings};

impl SceneDescription {
    /// The materials that reflect more light than they receive (classic Phong surfaces), by name,
    /// with their largest albedo. Colours of sphere tables are not examined.
    pub fn energy_creating_materials(&self) -> Vec<(&str, f32)> {
        let up_to = |surface: &SurfaceModel| match *surface {
            SurfaceModel::Phong { albedo, specular, exponent, normalized } => {
                Phong { albedo, specular, exponent, normalized }.max_albedo().max_element()
            }
            _ => 1.0,
        };
        let shares = self.materials.iter().map(|m| (m.name.as_str(), up_to(&m.surface)));
        // Rounding may push an albedo of exactly 1 slightly above 1.
        shares.filter(|(_, share)| *share > 1.0 + 1e-5).collect()
    }
}

impl RenderSettings {
    /// The options that bias the picture, as `key = value`; empty for an unbiased picture.
    ///
    /// Integrators that do not compute full light transport (`ambient-occlusion`, `normals`,
    /// `raycast`) are never listed, and `direct` is not biased by leaving out indirect light.
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
