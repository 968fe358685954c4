//! GSD.

use photosphere::particles::{ReadRequest, count_frames, read, survey};

use super::kit::{check, error, fixture, frame};

#[test]
fn files_of_gsd_are_read_as_it_reads_them() {
    check("gsd", 3);
}

#[test]
fn missing_chunks_are_those_of_frame_0_or_defaults() {
    let path = fixture("gsd/three.gsd");
    assert_eq!(count_frames(&path, &ReadRequest::default()).unwrap(), 3);
    let diameter = |at| read(&path, &frame(at)).unwrap().column("diameter").unwrap().clone();
    assert_eq!(diameter(0), diameter(1));
    assert_eq!(diameter(2).range(), Some([1.0, 1.0]));
    let told = survey(&path, &frame(1)).unwrap();
    assert_eq!((told.frames, told.count, told.time), (Some(3), Some(6), Some(10.0)));
}

#[test]
fn promises_are_not_believed() {
    let whole = std::fs::read(fixture("gsd/three.gsd")).unwrap();
    for at in [16, 32] {
        let mut huge = whole.clone();
        huge[at..at + 8].copy_from_slice(&(1u64 << 40).to_le_bytes());
        let found = error(huge);
        assert!(found.contains("its index has more than 4 GiB"), "{found}");
        let mut large = whole.clone();
        large[at..at + 8].copy_from_slice(&(1u64 << 20).to_le_bytes());
        let found = error(large);
        assert!(found.contains("the file ends too early"), "{found}");
    }
}
