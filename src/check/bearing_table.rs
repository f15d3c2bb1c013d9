//! Tables of bearings: from rows as written to a grid that can be interpolated.

use crate::case::{TableInput, grid};
use crate::check::Input;
use crate::error::Result;
use crate::model::{BearingTable, Coefficients};

impl Input<'_> {
    /// The table at a path such as `supports.0.table`.
    pub(super) fn bearing_table(&self, path: &str, table: &TableInput) -> Result<BearingTable> {
        let places: Vec<_> = table.0.iter().map(|row| (row.speed.0, row.whirl.map(|w| w.0))).collect();
        let (speeds, whirls) = match grid(&places) {
            Ok(grid) => grid,
            Err(wrong) if table.0.is_empty() => return self.fault(path, wrong.problem, wrong.allowed),
            Err(wrong) => {
                let place = format!("{path}.{}.{}", wrong.row, wrong.key);
                return self.fault(&place, wrong.problem, wrong.allowed);
            }
        };
        let rows = table.0.iter().map(|row| Coefficients {
            stiffness: row.stiffness.0.map(|r| r.map(|k| k.0)),
            damping: row.damping.map_or([[0.0; 2]; 2], |c| c.0.map(|r| r.map(|c| c.0))),
            mass: row.mass.map_or([[0.0; 2]; 2], |m| m.0.map(|r| r.map(|m| m.0))),
        });
        match BearingTable::new(speeds, whirls, rows.collect()) {
            Some(table) => Ok(table),
            None => self.fault(
                path,
                "these rows make no table",
                "speeds that ascend, with the same whirl frequencies",
            ),
        }
    }
}
