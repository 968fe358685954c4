//! The current picture in the viewer tev.

use std::io;
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::time::Duration;

use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use crate::error::{Error, Result};
use crate::image_io::Picture;

/// Timeout for connecting to tev and for sending to it. Only the viewer thread waits for tev.
const PATIENCE: Duration = Duration::from_secs(5);
/// Number of values sent at once: 4 MiB.
const NUMBERS: usize = 1 << 20;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A picture in a running tev.
pub(in crate::cli) struct Tev {
    client: TevClient,
    /// The connection of `client`, kept to shut it down.
    stream: TcpStream,
    name: String,
    is_there: bool,
}

impl Tev {
    /// Connects to a tev that listens at `HOST:PORT`. `name` is the title of the picture there.
    ///
    /// # Errors
    /// If the address does not exist, or tev does not answer.
    pub(in crate::cli) fn connect(place: &str, name: String) -> Result<Self> {
        let failed = |e: io::Error| {
            Error::input(format!("cannot reach tev at `{place}`: {e}"))
                .with_help("start tev first; by default it listens at 127.0.0.1:14158")
        };
        let connect = || {
            let mut failure = io::Error::other("the name has no address");
            for address in place.to_socket_addrs()? {
                match TcpStream::connect_timeout(&address, PATIENCE) {
                    Ok(stream) => {
                        stream.set_write_timeout(Some(PATIENCE))?;
                        return Ok(stream);
                    }
                    Err(e) => failure = e,
                }
            }
            Err(failure)
        };
        let stream = connect().map_err(failed)?;
        let client = TevClient::wrap(stream.try_clone().map_err(failed)?);
        Ok(Self { client, stream, name, is_there: false })
    }

    /// Returns a closure that closes the connection from another thread, even while a picture is
    /// being sent.
    pub(in crate::cli) fn disconnector(&self) -> Option<impl FnOnce() + use<>> {
        let stream = self.stream.try_clone().ok()?;
        Some(move || drop(stream.shutdown(Shutdown::Both)))
    }

    /// Shows the picture, replacing the previous one.
    ///
    /// # Errors
    /// If the connection to tev is lost.
    pub(in crate::cli) fn show(&mut self, picture: &Picture) -> io::Result<()> {
        let (width, height) = (picture.width, picture.height);
        if !self.is_there {
            self.client.send(PacketCreateImage {
                image_name: &self.name,
                grab_focus: true,
                width: width as u32,
                height: height as u32,
                channel_names: &CHANNELS,
            })?;
            self.is_there = true;
        }
        let rows_at_once = (NUMBERS / (CHANNELS.len() * width)).max(1);
        for first in (0..height).step_by(rows_at_once) {
            let rows = rows_at_once.min(height - first);
            let pixels = first * width..(first + rows) * width;
            let data: Vec<f32> =
                pixels.flat_map(|pixel| picture.beauty(pixel).to_array()).collect();
            self.client.send(PacketUpdateImage {
                image_name: &self.name,
                grab_focus: false,
                channel_names: &CHANNELS,
                channel_offsets: &[0, 1, 2],
                channel_strides: &[3; 3],
                x: 0,
                y: first as u32,
                width: width as u32,
                height: rows as u32,
                data: &data,
            })?;
        }
        Ok(())
    }
}
