//! stub
use crate::error::Result;
use crate::results::{Contact, Report};
pub fn svg(_: &Report<Contact>) -> Result<Vec<(String, String)>> {
    Ok(Vec::new())
}
