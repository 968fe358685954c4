//! Cuts a part out of a picture that was read.

use crate::error::{Error, Result};
use crate::image_io::ChannelValues;
use crate::math::Rect;

use super::source::Source;

impl Source {
    /// Keeps these pixels of the full picture.
    ///
    /// # Errors
    /// If the file does not hold all of them.
    pub(super) fn crop(&mut self, crop: Rect) -> Result<()> {
        let own = self.window();
        if own.intersection(&crop) != Some(crop) {
            let message = format!("the crop {crop} is not within the picture, which is {own}");
            return Err(Error::input(message)
                .with_help("corners are X0,Y0,X1,Y1 in pixels of the full picture, from 0,0"));
        }
        let [left, top] = [crop.x - own.x, crop.y - own.y].map(|first| first as usize);
        let (width, rows) = (self.size[0], top..top + crop.height as usize);
        let columns = left..left + crop.width as usize;
        let place = |row: usize| row * width + columns.start..row * width + columns.end;
        for channel in self.layers.iter_mut().flat_map(|layer| &mut layer.channels) {
            match &mut channel.values {
                ChannelValues::Float(values) => {
                    *values = rows.clone().flat_map(|row| values[place(row)].to_vec()).collect();
                }
                ChannelValues::Uint(values) => {
                    *values = rows.clone().flat_map(|row| values[place(row)].to_vec()).collect();
                }
            }
        }
        self.size = [crop.width as usize, crop.height as usize];
        self.offset = [crop.x as usize, crop.y as usize];
        Ok(())
    }

    /// The pixels of the full picture that are held.
    pub(super) fn window(&self) -> Rect {
        let [x, y] = self.offset.map(|first| first as u32);
        let [width, height] = self.size.map(|length| length as u32);
        Rect { x, y, width, height }
    }
}
