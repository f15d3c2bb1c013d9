//! What holds a body of a scene, and what loads it.

use crate::case::{self};
use crate::check::Input;
use crate::error::Result;
use crate::model::scene::{Action, BodyLoad, Face, Hold};
use crate::units::Length;

impl Input<'_> {
    /// Supports of a body: node and what is held there.
    pub(super) fn body_supports(
        &self,
        path: &str,
        body: &case::BodyInput,
        node: &dyn Fn(String, f64) -> Result<usize>,
    ) -> Result<Vec<(usize, Hold)>> {
        let mut supports = Vec::new();
        for (k, support) in body.supports.iter().enumerate() {
            let hold = match support.kind {
                case::BodySupportKind::Clamped => Hold::Clamped,
                case::BodySupportKind::Pinned => Hold::Pinned,
                case::BodySupportKind::PinnedX => Hold::PinnedX,
                case::BodySupportKind::PinnedY => Hold::PinnedY,
            };
            let node = node(format!("{path}.supports.{k}.at"), support.at.0)?;
            let again = |&(other, held): &(usize, Hold)| other == node && held.meets(hold);
            if let Some(other) = supports.iter().position(again) {
                return self.fault(
                    &format!("{path}.supports.{k}"),
                    format!("`{path}.supports.{other}` holds this place already"),
                    "one support at a place; or pinned-x and pinned-y",
                );
            }
            supports.push((node, hold));
        }
        Ok(supports)
    }

    /// Loads of a body.
    pub(super) fn body_loads(
        &self,
        path: &str,
        body: &case::BodyInput,
        planar: bool,
        node: &dyn Fn(String, f64) -> Result<usize>,
    ) -> Result<Vec<BodyLoad>> {
        let mut loads = Vec::new();
        for (k, load) in body.loads.iter().enumerate() {
            let path = format!("{path}.loads.{k}");
            let given = [load.force.is_some(), load.moment.is_some(), load.pressure.is_some()];
            let allowed = "at with force or moment; or face with pressure";
            let single = given.iter().filter(|g| **g).count() == 1;
            if !single || load.at.is_some() == load.pressure.is_some() || load.face.is_some() != given[2] {
                return self.fault(&path, "the load is incomplete or mixed", allowed);
            }
            if !planar && load.force.is_none() {
                return self.fault(&path, "spatial bodies take forces only", "force [x, y, z]");
            }
            let place = |x: Option<Length>| node(format!("{path}.at"), x.map_or(0.0, |x| x.0));
            let action = if let Some(force) = &load.force {
                let list: Vec<f64> = force.iter().map(|f| f.0).collect();
                Action::Force(place(load.at)?, self.place(&format!("{path}.force"), &list, planar)?)
            } else if let Some(moment) = load.moment {
                self.within(&format!("{path}.moment"), moment.0.abs(), 0.0, 1e30)?;
                Action::Moment(place(load.at)?, moment.0)
            } else {
                let face = load.face.unwrap_or(Face::Top);
                Action::Pressure(face, load.pressure.map_or(0.0, |p| p.0))
            };
            let until = match load.until {
                Some(t) => self.positive(&format!("{path}.until"), t.0)?,
                None => f64::INFINITY,
            };
            loads.push(BodyLoad { action, until });
        }
        Ok(loads)
    }
}
