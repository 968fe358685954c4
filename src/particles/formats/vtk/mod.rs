//! Points and point data of VTK files: XML (`.vtp`, `.vtu`), collections of them (`.pvd`), and the
//! legacy format.

mod array;
mod base64;
mod collection;
mod legacy;
mod legacy_text;
mod xml;

pub(in crate::particles) use collection::{count_pvd, part_of_pvd};
pub(in crate::particles) use legacy::{read_legacy, survey_legacy};
pub(in crate::particles) use xml::{read_xml, survey_xml};
