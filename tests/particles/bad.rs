//! Bad files of all formats: cut anywhere, empty, junk, lines without end.

use photosphere::particles::{Format, ReadRequest, read_bytes};

use super::kit::{bytes, error, fixture};

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

/// No atom is lost because a number in the file is too small.
#[test]
fn particles_that_are_not_counted_are_told() {
    let dump = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 6\n0 6\n\
                0 6\nITEM: ATOMS id x y z\n1 0 0 0\n2 1 1 1\n";
    let data = "title\n\n1 atoms\n1 atom types\n\nAtoms # atomic\n\n1 1 0 0 0\n2 1 1 1 1\n";
    let atom = |row| format!("    1SOL     OW    {row}   0.100   0.200   0.300\n");
    let gro = format!("water\n 1\n{}{}   3.0 3.0 3.0\n", atom(1), atom(2));
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
               property float z\nend_header\n0 0 0\n1 1 1\n";
    for (text, line, counted) in [
        ("1\n\nO 1 2 3\nH 1 2 3\n", 4, "line 1 counts 1 atom"),
        ("1\n\nO 1 2 3\n\n\nH 1 2 3\n", 6, "line 1 counts 1 atom"),
        (dump, 11, "line 4 counts 1 atom"),
        (data, 9, "the header counts 1 atom"),
        (&gro, 4, "line 2 counts 1 atom"),
        (ply, 9, "the header counts 1 vertex"),
    ] {
        let error = bytes(text).unwrap_err();
        assert!(error.to_string().starts_with(&format!("memory:{line}: ")), "{error}");
        let help = format!("{counted}: are there more?");
        assert_eq!(error.help(), Some(&*help), "{error}");
    }
}
