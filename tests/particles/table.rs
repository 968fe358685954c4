//! Tables as text.

use photosphere::particles::{Format, ReadRequest, Role, read, read_bytes};

use super::kit::{bytes, check, error, fixture, only};

#[test]
fn files_of_pandas_and_numpy_are_read_as_they_read_them() {
    check("table", 7);
}

#[test]
fn delimiters_and_headers_are_found() {
    for (text, format) in [
        ("x,y,z,r\n1,2,3,4\n", Format::Csv),
        ("x;y;z;r\n1;2;3;4\n", Format::Csv),
        ("x\ty\tz\tr\n1\t2\t3\t4\n", Format::Csv),
        ("x|y|z|r\n1|2|3|4\n", Format::Csv),
        ("x y z r\n1 2 3 4\n", Format::Table),
        ("# x y z r\n1   2 3 4\n", Format::Table),
        ("# made by hand\n#x,y,z,r\n1,2,3,4\n", Format::Csv),
        ("//X Y Z r\n1 2 3 4\n", Format::Table),
        ("\u{feff}x [mm];y [mm];z [mm];r\n1;2;3;4\n", Format::Csv),
        ("\"x\",\"y\",\"z\",\"r\"\r\n1,\"2\", 3 ,4\r\n\r\n# end\n", Format::Csv),
        ("Points:0,Points:1,Points:2,r\n1,2,3,4\n", Format::Csv),
        ("r;z;y;x\n4,0;3,0;2,0;1,0\n", Format::Csv),
    ] {
        let found = bytes(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((found.format, found.len()), (format, 1), "{text}");
        assert_eq!(found.positions.get(0).to_array(), [1.0, 2.0, 3.0], "{text}");
        assert_eq!(found.columns.len(), 1, "{text}");
        assert_eq!((&*found.columns[0].name, found.columns[0].number(0)), ("r", 4.0), "{text}");
    }
}

#[test]
fn values_without_names_have_usual_ones() {
    let found = bytes("Ar 1 2 3\nNe 4 5 6\n").unwrap();
    assert_eq!(found.role(Role::Element).unwrap().data.show(1), "Ne");
    let found = bytes("1 2 3 0.5\n4 5 6 0.25\n").unwrap();
    assert_eq!(found.column("column_4").unwrap().number(1), 0.25);
    let names = ["x", "y", "_", "z"].map(str::to_owned).to_vec();
    let request = ReadRequest { names, ..ReadRequest::default() };
    let found = read_bytes("a".as_ref(), b"1 2 9 3\n", &request).unwrap();
    assert_eq!(found.positions.get(0).to_array(), [1.0, 2.0, 3.0]);
}

/// A column is one of words if only a late row says so, and missing numbers are NaN.
#[test]
fn types_follow_all_rows() {
    let mut text = "x,y,z,n,s\n".to_owned();
    for row in 0..5000 {
        text += &format!("{row},0,0,{},{row}\n", if row == 4000 { "" } else { "7" });
    }
    let found = bytes(&text).unwrap();
    assert!(found.column("n").unwrap().number(4000).is_nan());
    assert_eq!(found.column("n").unwrap().range(), Some([7.0, 7.0]));
    text += "1,2,3,8.5,late\n";
    let found = bytes(&text).unwrap();
    let words = found.column("s").unwrap();
    assert_eq!((words.data.show(5000), words.data.show(12)), ("late".into(), "12".into()));
    assert_eq!(found.column("n").unwrap().number(5000), 8.5);
    assert_eq!(found.first_line, Some(2));
}

#[test]
fn mistakes_have_their_line() {
    for (text, message) in [
        ("x,y,z\n1,2,3\n1,2\n", "memory:3: expected 3 values, found 2 (z is missing)"),
        ("x,y,z\n1,2,3\n1,2,3,4\n", "memory:3: expected 3 values, found 4"),
        ("x,y,z\n1,2,3\n1,,3\n", "memory:3: expected a finite number for `y`, found ``"),
        ("x y z\n1 2 3\n1 inf 3\n", "memory:3: expected a finite number for `y`, found `inf`"),
        ("a,b,c\n1,2,3\n", "memory: there are no columns x, y and z among `a`, `b`, `c`"),
        ("x,y,z\n", "memory: it has no rows"),
        ("# nothing\n", "memory: it has no rows"),
        ("1 2\n3 4\n", "memory:1: 3 columns named, but its rows have 2 values"),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}");
    }
    let missing = read(&fixture("table/comma.csv"), &only(&["energi"])).unwrap_err();
    assert!(missing.to_string().ends_with("there is no column `energi`"));
    assert!(missing.help().unwrap().contains("`energy`"));
}
