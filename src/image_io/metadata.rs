//! Reads the [metadata](MetadataEntry) of a file.

use std::path::Path;

use crate::error::{Error, Result};

use super::format::FileFormat;
use super::read::open_ordinary;
use super::record::MetadataEntry;
use super::{exr, png};

/// Reads the metadata of a `.png` or `.exr` file, in no particular order. Empty if another program
/// wrote the file.
///
/// # Errors
/// When the file cannot be read, or its format has no metadata.
pub fn read_metadata(path: &Path) -> Result<Vec<MetadataEntry>> {
    let trouble = |reason: String| Error::file("read", path, reason);
    let records = match FileFormat::from_path(path)? {
        FileFormat::Png => open_ordinary(path).and_then(|_| png::read_metadata(path)),
        FileFormat::Exr => open_ordinary(path).and_then(|_| exr::read_metadata(path)),
        _ => {
            let format = path.extension().unwrap_or_default().to_string_lossy();
            return Err(Error::input(format!(
                "`{}` does not record how it was made: .{format} files hold only pixels",
                path.display()
            ))
            .with_help("use a .png or .exr file"));
        }
    };
    records.map_err(|reason| {
        trouble(reason).with_help("check that the file is complete and that its extension is right")
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::picture;
    use super::super::{ImageWriter, WriteOptions};
    use super::*;

    #[test]
    fn records_come_back_from_both_formats() {
        let folder = tempfile::tempdir().unwrap();
        let long = "κόσμος = [1, 2]\n".repeat(1000);
        let records = vec![
            MetadataEntry::new("version", "1.2.3"),
            MetadataEntry::new("scene", long),
            MetadataEntry::new("empty", ""),
            MetadataEntry::new("word", "Bär \u{1F43B}"),
        ];
        let notes = WriteOptions { metadata: records.clone(), ..WriteOptions::default() };
        for name in ["a.png", "a.exr"] {
            let path = folder.path().join(name);
            ImageWriter::new(&path).unwrap().write_with(&picture(), &notes).unwrap();
            let mut found = super::read_metadata(&path).unwrap();
            found.sort_by_key(|record| records.iter().position(|r| r.name == record.name));
            assert_eq!(found, records, "{name}");
            // Other programs can read the file too.
            if name == "a.png" {
                assert_eq!(::image::open(&path).unwrap().into_rgb8().dimensions(), (13, 5));
                assert!(std::fs::metadata(&path).unwrap().len() < 4000, "long texts are packed");
            }
            // Output is deterministic.
            let again = folder.path().join(format!("again-{name}"));
            ImageWriter::new(&again).unwrap().write_with(&picture(), &notes).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), std::fs::read(&again).unwrap(), "{name}");
        }
    }

    #[test]
    fn texts_that_could_not_be_read_again_are_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let metadata = vec![MetadataEntry::new("scene", "x".repeat((64 << 20) + 1))];
        let notes = WriteOptions { metadata, ..WriteOptions::default() };
        let refusal = ImageWriter::new(&path).unwrap().write_with(&picture(), &notes);
        let told = refusal.unwrap_err().to_string();
        assert!(told.contains("its metadata has 67108865 bytes, more than"), "{told}");
        assert!(!path.exists());
    }

    #[test]
    fn formats_without_records_say_so() {
        let error = super::read_metadata(Path::new("a.pfm")).unwrap_err().to_string();
        assert_eq!(error, "`a.pfm` does not record how it was made: .pfm files hold only pixels");
    }
}
