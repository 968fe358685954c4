//! The viewer tev at the other end of a socket. The program only writes to it: nothing of what a
//! viewer sends is read. The viewer may hang up, or send what it likes.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::thread;

use photosphere::cli::testing::show_in_tev;
use photosphere::color::Rgb;
use photosphere::image_io::Picture;

/// Packets by their numbers in tev's protocol.
const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE: u8 = 6;

/// The bytes of the input are the width, the height, how many of 32 bytes the viewer takes before
/// it hangs up (0: it never does), what it sends back at once, and the title of the picture.
pub(super) fn viewer(input: &[u8]) -> bool {
    let [width, height, patience, chatter, title @ ..] = input else { return false };
    let Ok(title) = std::str::from_utf8(title) else { return false };
    // A file name has no zero byte.
    if title.contains('\0') {
        return false;
    }
    let (width, height) = (usize::from(width % 16) + 1, usize::from(height % 16) + 1);
    let pixels: Vec<Rgb> = (0..width * height).map(|pixel| Rgb::splat(pixel as f32)).collect();
    let indirect = vec![Rgb::ZERO; pixels.len()];
    let picture = Picture { width, height, direct: pixels, indirect, ..Picture::default() };
    let limit = (*patience > 0).then_some(usize::from(*patience) * 32);
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("it is bound").to_string();
    let chatter = vec![*chatter; usize::from(*chatter)];
    let is_silent = chatter.is_empty();
    let viewer = thread::spawn(move || {
        let (stream, _) = listener.accept().expect("the program connects");
        take(stream, limit, &chatter)
    });
    let shown = show_in_tev(&address, title, &picture);
    let taken = viewer.join().expect("the viewer of this test does not panic");
    if limit.is_some() {
        // Whether the program notices depends on when the other end hangs up.
        return true;
    }
    shown.expect("a viewer that takes everything");
    // Bytes that nobody reads make the system reset the connection, and what is under way is lost.
    if is_silent {
        check_packets(&taken, title, &picture);
    }
    true
}

/// Reads up to `limit` bytes.
fn take(mut stream: TcpStream, limit: Option<usize>, chatter: &[u8]) -> Vec<u8> {
    // The program may have hung up already.
    let _ = stream.write_all(chatter);
    let mut taken = vec![0; limit.unwrap_or(0)];
    match limit {
        Some(_) => _ = stream.read(&mut taken),
        None => _ = stream.read_to_end(&mut taken),
    }
    taken
}

/// Checks that the packets create the picture once and fill it twice.
fn check_packets(mut bytes: &[u8], title: &str, picture: &Picture) {
    let mut kinds = Vec::new();
    while let Some(length) = bytes.first_chunk() {
        let (packet, rest) = bytes.split_at(u32::from_le_bytes(*length) as usize);
        bytes = rest;
        kinds.push(packet[4]);
        let name = packet[6..].split(|byte| *byte == 0).next();
        assert_eq!(name, Some(title.as_bytes()));
        if packet[4] == UPDATE_IMAGE {
            let values = picture.len() * 3;
            let data = packet[packet.len() - 4 * values..].chunks_exact(4);
            let data =
                data.map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
            let expected = (0..picture.len()).flat_map(|pixel| picture.beauty(pixel).to_array());
            assert!(data.eq(expected), "other values arrive");
        }
    }
    assert_eq!(kinds, [CREATE_IMAGE, UPDATE_IMAGE, UPDATE_IMAGE]);
}
