//! Forces that act on the shaft in the last evaluated state: of supports, bearings, loads and rings.

use crate::model::Frame;
use crate::shaft::acting::Acting;
use crate::shaft::loads::Turned;
use crate::shaft::motion::{Dynamics, turn_pair};

impl Dynamics<'_> {
    /// Forces of the supports on all coordinates at the last evaluation, in fixed directions: resultant at each
    /// constrained node, `(node, [x, y, z])`, N.
    pub fn reactions(&self, t: f64) -> Vec<(usize, [f64; 3])> {
        let (sin, cos) = self.angle_at(t).sin_cos();
        let mut list: Vec<(usize, [f64; 3])> = Vec::new();
        for node in self.assembly.constrained_nodes() {
            if list.last().is_some_and(|(last, _)| *last == node) {
                continue;
            }
            let place = &self.nodes[node];
            let mut f = [0.0; 3];
            for first in self.assembly.numbering.fields(node) {
                f.iter_mut().zip(&self.memory.residual[first..]).for_each(|(f, r)| *f += r);
            }
            if self.frame == Frame::Rotating || place.turned {
                turn_pair(&mut f, sin, cos);
            }
            list.push((node, f));
        }
        list
    }

    /// All that acts at the last evaluation, in the axes of the frame.
    pub fn acting(&self) -> Acting {
        let m = &self.memory;
        let (sin, cos) = m.turned;
        let mut held = m.residual.clone();
        for node in self.nodes.iter().filter(|n| n.turned) {
            held[node.start..node.end].chunks_exact_mut(3).for_each(|f| turn_pair(f, sin, cos));
        }
        let rotating = self.frame == Frame::Rotating;
        Acting {
            position: m.position.clone(),
            velocity: m.velocity.clone(),
            acceleration: m.acceleration.clone(),
            outer: m.inertia.iter().map(|f| -f).collect(),
            held,
            axes: if rotating { Turned { sin, cos } } else { Turned::NOT },
            load: 1.0,
        }
    }

    /// Force `[x, y, z]` of every ring on the shaft at the last evaluation, in fixed directions, N.
    pub fn ring_forces(&self) -> Vec<[f64; 3]> {
        let (sin, cos) = if self.frame == Frame::Rotating { self.memory.turned } else { (0.0, 1.0) };
        let mut list = vec![[0.0; 3]; self.rub.rings.len()];
        for touch in &self.rub.touching {
            let law = &self.rub.rings[touch.ring].law;
            let force = law.force(&touch.place, &law.contact(&touch.place, &touch.rate));
            list[touch.ring] = Turned { sin, cos }.in_space([0.0, force[0], force[1]]);
        }
        list
    }
}
