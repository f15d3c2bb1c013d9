//! Supports on points of the axis: what they hold, and that it depends on the mesh.

use crate::model::{Law, Model, SupportKind};
use crate::results::Diagnostic;

/// Warns of `fix` lists that hold r and vectors beside it but not the section: a force on the axis of a three-dimensional
/// body is a point load, under which the body gives way without bound as elements shrink.
pub fn point_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    for support in &model.supports {
        let SupportKind::Fix(list) = &support.kind else { continue };
        let node = &model.nodes[support.node];
        let continuum = model.elements.iter().any(|e| {
            let ends = [e.first_node, e.first_node + e.kind.axial_degree];
            e.kind.law == Law::Continuum && ends.contains(&support.node)
        });
        let plane = (0..node.n_vectors()).all(|vector| list.contains(&(vector, 0)));
        // vectors of first order move the whole of a linear section
        if !continuum || node.n_vectors() <= 3 || plane {
            continue;
        }
        diagnostics.push(Diagnostic::warning(
            "point-support",
            format!(
                "`{}` holds the axis at x = {} m and not its section: a point support of a three-dimensional body, whose frequencies \
                 and displacements do not converge with the mesh (they fall slowly as elements shrink); \"kind\": \"clamped\", \
                 \"revolute\" or \"pinned\" hold the section",
                support.path, node.x
            ),
        ));
    }
}
