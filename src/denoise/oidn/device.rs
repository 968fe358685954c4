//! A device of the processor, and the one thing that is done with it: filtering an image.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr;

use crate::color::Rgb;

use super::functions::{DevicePointer, FilterPointer, Functions};

/// `OIDN_DEVICE_TYPE_CPU`.
const CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// Bytes from a pixel to the next.
const STRIDE: usize = size_of::<Rgb>();

/// The images of a filter, of `width * height` pixels each, row by row.
#[derive(Clone, Copy, Debug)]
pub(in crate::denoise) struct Images<'a> {
    pub(in crate::denoise) size: [usize; 2],
    /// The image to filter by its name in the library: `color`, `albedo` or `normal`.
    pub(in crate::denoise) main: (&'static CStr, &'a [Rgb]),
    /// Images without noise that guide the filter.
    pub(in crate::denoise) guides: [Option<(&'static CStr, &'a [Rgb])>; 2],
    /// True for light, which may be brighter than 1.
    pub(in crate::denoise) is_hdr: bool,
}

/// A device that computes on the processor.
#[derive(Debug)]
pub(in crate::denoise) struct Device<'a> {
    functions: &'a Functions,
    pointer: DevicePointer,
}

impl<'a> Device<'a> {
    /// Starts a device with so many threads.
    ///
    /// # Errors
    /// If the library cannot compute on this processor.
    pub(in crate::denoise) fn new(
        functions: &'a Functions,
        threads: usize,
    ) -> Result<Self, String> {
        // SAFETY: takes a number; returns a device or null, which all functions accept as an error.
        let pointer = unsafe { (functions.new_device)(CPU) };
        let device = Self { functions, pointer };
        device.check()?;
        let threads = c_int::try_from(threads).unwrap_or(0);
        // SAFETY: the device is not null and was made by this library; the names end with zero and
        // are copied. Parameters are set before the device is committed, as the library asks.
        unsafe {
            (functions.set_device_int)(pointer, c"numThreads".as_ptr(), threads);
            // Threads that stay on their cores would slow other programs and the next render.
            (functions.set_device_bool)(pointer, c"setAffinity".as_ptr(), false);
            (functions.commit_device)(pointer);
        }
        device.check()?;
        Ok(device)
    }

    /// The version of the library, such as `2.5.1`.
    pub(in crate::denoise) fn version(&self) -> String {
        // SAFETY: the device is committed, and the name ends with zero.
        let version = unsafe { (self.functions.get_device_int)(self.pointer, c"version".as_ptr()) };
        format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    /// Filters an image.
    ///
    /// # Errors
    /// If an image has another size, or the library fails.
    pub(in crate::denoise) fn filter(&self, images: &Images<'_>) -> Result<Vec<Rgb>, String> {
        let [width, height] = images.size;
        let count = width.checked_mul(height).ok_or("the picture is too large")?;
        let all = images.guides.iter().flatten().chain([&images.main]);
        if all.clone().any(|(_, pixels)| pixels.len() != count) {
            return Err("the images differ in size".to_owned());
        }
        let mut output = vec![Rgb::ZERO; count];
        let filter = Filter::new(self)?;
        for (name, pixels) in all {
            // SAFETY: the slice has as many pixels as the size says, and lives longer than the
            // filter. The library only reads its inputs.
            unsafe { filter.set_image(name, pixels.as_ptr().cast_mut().cast(), images.size) };
        }
        // SAFETY: as above; nothing else refers to the output while the filter exists.
        unsafe { filter.set_image(c"output", output.as_mut_ptr().cast(), images.size) };
        filter.set_flag(c"hdr", images.is_hdr);
        filter.set_flag(c"cleanAux", images.guides.iter().any(Option::is_some));
        filter.run()?;
        drop(filter);
        Ok(output)
    }

    /// Returns the first error since the last check.
    fn check(&self) -> Result<(), String> {
        let mut message: *const c_char = ptr::null();
        // SAFETY: null asks for the error of this thread; the message is valid until the next call.
        let code = unsafe { (self.functions.get_device_error)(self.pointer, &raw mut message) };
        match code {
            0 if self.pointer.is_null() => Err("it makes no device".to_owned()),
            0 => Ok(()),
            _ if message.is_null() => Err(format!("error {code}")),
            // SAFETY: the library returns a text that ends with zero.
            _ => Err(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned()),
        }
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        if !self.pointer.is_null() {
            // SAFETY: the device was made by this library and is released once.
            unsafe { (self.functions.release_device)(self.pointer) };
        }
    }
}

/// A filter for rendered images.
struct Filter<'a> {
    device: &'a Device<'a>,
    pointer: FilterPointer,
}

impl<'a> Filter<'a> {
    fn new(device: &'a Device<'a>) -> Result<Self, String> {
        // SAFETY: the device is committed, and the name ends with zero.
        let pointer = unsafe { (device.functions.new_filter)(device.pointer, c"RT".as_ptr()) };
        device.check()?;
        if pointer.is_null() {
            return Err("it makes no filter".to_owned());
        }
        Ok(Self { device, pointer })
    }

    /// Names an image of the filter.
    ///
    /// # Safety
    /// The memory must hold as many pixels of three floats as the size says, and live as long as
    /// the filter; that of the output must not be referred to otherwise.
    unsafe fn set_image(&self, name: &CStr, pixels: *mut c_void, [width, height]: [usize; 2]) {
        let set = self.device.functions.set_shared_filter_image;
        let row = width * STRIDE;
        // SAFETY: the caller vouches for the memory; the name ends with zero.
        unsafe {
            set(self.pointer, name.as_ptr(), pixels, FLOAT3, width, height, 0, STRIDE, row);
        }
    }

    fn set_flag(&self, name: &CStr, value: bool) {
        // SAFETY: the filter exists, and the name ends with zero.
        unsafe { (self.device.functions.set_filter_bool)(self.pointer, name.as_ptr(), value) };
    }

    fn run(&self) -> Result<(), String> {
        let Functions { commit_filter, execute_filter, .. } = self.device.functions;
        // SAFETY: the filter exists, and its images are set and alive.
        unsafe { commit_filter(self.pointer) };
        self.device.check()?;
        // SAFETY: the filter is committed; the call returns when the output is complete.
        unsafe { execute_filter(self.pointer) };
        self.device.check()
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter was made by this library and is released once, before its device.
        unsafe { (self.device.functions.release_filter)(self.pointer) };
    }
}

const _: () = assert!(STRIDE == 3 * size_of::<f32>());
