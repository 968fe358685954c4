//! Bad files of all formats: cut anywhere, empty, junk, lines without end.

use photosphere::particles::{Format, ReadRequest, read_bytes};

use super::kit::{error, fixture};

/// Every fixture cut at every byte, or, in long ones, at many.
#[test]
fn files_cut_anywhere_are_errors_or_shorter() {
    let mut files = 0;
    for folder in std::fs::read_dir(fixture("")).unwrap() {
        let folder = folder.unwrap().path();
        if !folder.is_dir() || folder.ends_with("packed") {
            continue;
        }
        for file in std::fs::read_dir(&folder).unwrap() {
            cut(&file.unwrap().path());
            files += 1;
        }
    }
    assert!(files > 50, "{files}");
}

fn cut(path: &std::path::Path) {
    let whole = std::fs::read(path).expect("a fixture");
    let name = path.display();
    let read = |bytes: &[u8]| read_bytes("memory".as_ref(), bytes, &ReadRequest::default());
    // A collection in memory has no files beside it.
    let rows = match read(&whole) {
        Ok(found) => found.len(),
        Err(_) if path.extension().is_some_and(|end| end == "pvd") => return,
        Err(error) => panic!("{name}: {error}"),
    };
    let step = (whole.len() / 1500).max(1);
    for end in (0..whole.len()).step_by(step) {
        match read(&whole[..end]) {
            Ok(found) => assert!(found.len() <= rows, "{name} cut at {end}"),
            Err(error) => {
                let text = error.to_string();
                assert!(text.starts_with("memory:"), "{name} cut at {end}: {text}");
            }
        }
    }
}

#[test]
fn nothing_and_junk_are_refused() {
    assert_eq!(error(""), "memory: the file is empty");
    assert_eq!(error(" \n\n"), "memory: the file is empty");
    let junk: Vec<u8> = (0..5000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 11) as u8).collect();
    assert_eq!(error(&junk), "memory: it has no known format");
    for (name, format) in Format::NAMES {
        for bytes in [&b""[..], b"\n", &junk, b"\xff\xfe\n1 2 3\n"] {
            let request = ReadRequest { format: Some(*format), ..ReadRequest::default() };
            if let Ok(found) = read_bytes("memory".as_ref(), bytes, &request) {
                assert!(found.len() <= 1, "{name}");
            }
        }
    }
}

#[test]
fn long_lines_are_read_or_refused() {
    let long = "1 ".repeat(1 << 20);
    for text in [
        format!("1\n{long}\nO 1 2 3\n"),
        format!("1\n\nO 1 2 3 {long}\n"),
        format!("ITEM: ATOMS {long}\n"),
        format!("x y z\n1 2 3 {long}\n"),
        "x,y,z\n".to_owned() + &"1,2,3".repeat(1 << 20),
        "ply\ncomment ".to_owned() + &long,
        "9".repeat(20 << 20),
    ] {
        let start = text[..20].to_owned();
        match read_bytes("memory".as_ref(), text.as_bytes(), &ReadRequest::default()) {
            Ok(found) => assert_eq!(found.len(), 1, "{start}"),
            Err(error) => assert!(error.to_string().len() < 300, "{start}: {error}"),
        }
    }
}
