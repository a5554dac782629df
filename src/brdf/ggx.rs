use super::Brdf;
use glam::{DVec2, DVec3};

#[derive(Debug)]
pub struct Ggx;

impl Brdf for Ggx {
    fn name(&self) -> &'static str {
        "ggx"
    }
    fn d(&self, _h_local: DVec3, _alpha: f64) -> f64 {
        todo!()
    }
    fn g1(&self, _n_dot_w: f64, _alpha: f64) -> f64 {
        todo!()
    }
    fn sample_d(&self, _xi: DVec2, _alpha: f64) -> DVec3 {
        todo!()
    }
    fn sample_visible(&self, _xi: DVec2, _v_local: DVec3, _alpha: f64) -> DVec3 {
        todo!()
    }
    fn pdf_visible_l(&self, _v_local: DVec3, _h_local: DVec3, _alpha: f64) -> f64 {
        todo!()
    }
}
