//! Tables and plots of a campaign, as files.
//!
//! | file | content |
//! | --- | --- |
//! | `table.md` | the table, to read |
//! | `table.csv` | the same with all digits |
//! | `plots/*.svg` | see [`super::plots`] |

use std::path::Path;

use super::columns::{self, Row};
use super::plan::Plan;
use super::store::{Finished, put};
use super::table::{Table, table};
use super::{CampaignError, csv, markdown, plots};

/// What was written.
#[derive(Clone, Debug)]
pub struct Written {
    /// The table.
    pub table: Table,
    /// Remarks for the user, as on a column that no report has.
    pub notes: Vec<String>,
}

/// Writes tables and plots into the folder of a campaign.
///
/// # Errors
/// The system refuses to write a file.
pub fn write(folder: &Path, plan: &Plan, finished: &[Finished]) -> Result<Written, CampaignError> {
    let table = table(plan, finished);
    put(&folder.join("table.md"), &markdown::text(&table, plan))?;
    put(&folder.join("table.csv"), &csv::text(&table))?;
    plots::write(folder, plan, finished)?;
    let rows: Vec<Row<'_>> = finished.iter().map(Row::new).collect();
    Ok(Written {
        notes: columns::unknown(&plan.columns, &rows),
        table,
    })
}
