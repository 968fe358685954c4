//! The library's functions, by their names in C.

use std::ffi::{c_char, c_int, c_void};
use std::path::Path;

use libloading::Library;

/// A device, behind a pointer.
pub(super) type DevicePointer = *mut c_void;
/// A filter, behind a pointer.
pub(super) type FilterPointer = *mut c_void;

/// Declares the functions and loads them by name.
macro_rules! functions {
    ($($field:ident = $name:literal: fn($($argument:ty),*) $(-> $result:ty)?;)+) => {
        /// The functions of a library that is loaded.
        #[derive(Debug)]
        pub(in crate::denoise) struct Functions {
            $(pub(super) $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)+
            /// Keeps the functions where they are.
            _library: Library,
        }

        impl Functions {
            /// Loads the library.
            ///
            /// # Errors
            /// If there is none, or it lacks a function.
            pub(in crate::denoise) fn load(file: &Path) -> Result<Self, String> {
                // SAFETY: the file is the one that the user or the system names as Open Image
                // Denoise 2, whose initialisation has no preconditions.
                let library = unsafe { Library::new(file) }.map_err(|e| e.to_string())?;
                Ok(Self {
                    $($field: {
                        // SAFETY: a function of this name has this type in version 2 of the
                        // library, which is part of the file's name.
                        let function = unsafe { library.get(concat!($name, "\0").as_bytes()) };
                        *function.map_err(|e| e.to_string())?
                    },)+
                    _library: library,
                })
            }
        }
    };
}

functions! {
    new_device = "oidnNewDevice": fn(c_int) -> DevicePointer;
    set_device_int = "oidnSetDeviceInt": fn(DevicePointer, *const c_char, c_int);
    set_device_bool = "oidnSetDeviceBool": fn(DevicePointer, *const c_char, bool);
    get_device_int = "oidnGetDeviceInt": fn(DevicePointer, *const c_char) -> c_int;
    get_device_error = "oidnGetDeviceError": fn(DevicePointer, *mut *const c_char) -> c_int;
    commit_device = "oidnCommitDevice": fn(DevicePointer);
    release_device = "oidnReleaseDevice": fn(DevicePointer);
    new_filter = "oidnNewFilter": fn(DevicePointer, *const c_char) -> FilterPointer;
    set_shared_filter_image = "oidnSetSharedFilterImage":
        fn(FilterPointer, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);
    set_filter_bool = "oidnSetFilterBool": fn(FilterPointer, *const c_char, bool);
    commit_filter = "oidnCommitFilter": fn(FilterPointer);
    execute_filter = "oidnExecuteFilter": fn(FilterPointer);
    release_filter = "oidnReleaseFilter": fn(FilterPointer);
}
