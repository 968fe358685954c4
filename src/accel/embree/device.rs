//! Embree devices, which own errors, memory statistics and build threads.

use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::NonNull;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::error::{Error, Result, Suggestion};

use super::sys;

/// Owns a device. Each intersector has its own, and so its own errors and memory statistics.
pub(super) struct Device {
    raw: NonNull<sys::PsDevice>,
    /// Embree keeps this address, so it must outlive `raw`.
    listener: Arc<DeviceListener>,
}

/// Receives callbacks from Embree, on any of its threads.
#[derive(Default)]
struct DeviceListener {
    /// The first error since the last check; later ones are mostly consequences of the first.
    error: Mutex<Option<DeviceError>>,
    /// Bytes held by Embree, according to Embree.
    bytes: AtomicIsize,
}

struct DeviceError {
    code: u32,
    text: String,
}

// SAFETY: Embree's device functions may be called from any thread, and the listener is `Sync`.
unsafe impl Send for Device {}
// SAFETY: as above; all methods take `&self` and call only such functions.
unsafe impl Sync for Device {}

impl Device {
    /// Creates a device that builds with this many threads; 0 means all.
    pub(super) fn new(threads: usize) -> Result<Arc<Self>> {
        let config = if threads == 0 { String::new() } else { format!("threads={threads}") };
        Self::with_config(&config)
    }

    /// Creates a device with a configuration in Embree's words.
    pub(super) fn with_config(config: &str) -> Result<Arc<Self>> {
        let config = CString::new(config).expect("a configuration holds no NUL");
        // SAFETY: `config` is a C string that outlives the call, which copies it.
        let raw = unsafe { sys::ps_device_new(config.as_ptr()) };
        let device = Self::adopt(raw)?;
        device.check("start")?;
        Ok(Arc::new(device))
    }

    /// Takes ownership of a new device and registers the callbacks.
    pub(super) fn adopt(raw: *mut sys::PsDevice) -> Result<Self> {
        let Some(raw) = NonNull::new(raw) else {
            // SAFETY: reads the error of this thread's failed `ps_device_new`.
            let cause = match unsafe { sys::ps_creation_error() } {
                4 => "there is not enough memory".to_owned(),
                5 => "it does not support this processor".to_owned(),
                code => format!("it gives no device, and error code {code}"),
            };
            return Err(Error::backend(format!("Embree cannot start: {cause}"))
                .with_help("choose another intersector")
                .with_suggestion(Suggestion::Intersector, "native"));
        };
        let device = Self { raw, listener: Arc::default() };
        let listener = Arc::as_ptr(&device.listener).cast_mut().cast::<c_void>();
        // SAFETY: `raw` is alive. The callbacks cast `listener` back to its type and only use it as
        // a shared reference. It lives until `drop` has released the device.
        unsafe {
            sys::ps_device_on_error(raw.as_ptr(), Some(on_error), listener);
            sys::ps_device_on_memory(raw.as_ptr(), Some(on_memory), listener);
        }
        Ok(device)
    }

    pub(super) fn raw(&self) -> *mut sys::PsDevice {
        self.raw.as_ptr()
    }

    /// Fails if Embree reported an error since the last check. `doing` completes "Embree cannot".
    pub(super) fn check(&self, doing: &str) -> Result<()> {
        match self.listener.error().take() {
            None => Ok(()),
            Some(report) if report.code == sys::PS_ERROR_CANCELLED => Err(Error::cancelled()),
            Some(DeviceError { code, text }) => {
                Err(Error::backend(format!("Embree cannot {doing}: {text} (error code {code})")))
            }
        }
    }

    /// Version and features of this Embree.
    pub(super) fn describe(&self) -> Result<sys::PsDescription> {
        let mut description = std::mem::MaybeUninit::uninit();
        // SAFETY: the device is alive, and the call fills the whole description.
        let description = unsafe {
            sys::ps_device_describe(self.raw(), description.as_mut_ptr());
            description.assume_init()
        };
        self.check("describe itself")?;
        Ok(description)
    }

    /// Bytes held by Embree for this device, according to Embree. In large scenes this is up to
    /// twice the real growth of the process.
    pub(super) fn bytes(&self) -> usize {
        usize::try_from(self.listener.bytes.load(Ordering::Relaxed)).unwrap_or(0)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: this is the only owner. Scenes and geometries hold an `Arc` of this device and
        // release their own handles first, so this call frees it, and the listener is still alive.
        unsafe { sys::ps_device_release(self.raw()) }
    }
}

impl DeviceListener {
    fn error(&self) -> std::sync::MutexGuard<'_, Option<DeviceError>> {
        self.error.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

unsafe extern "C" fn on_error(listener: *mut c_void, code: u32, text: *const c_char) {
    // SAFETY: `adopt` passed a pointer to the device's listener, which outlives the device.
    let listener = unsafe { &*listener.cast::<DeviceListener>() };
    let text = if text.is_null() {
        "no reason given".to_owned()
    } else {
        // SAFETY: Embree passes a C string that is valid during this call.
        unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
    };
    listener.error().get_or_insert(DeviceError { code, text });
}

unsafe extern "C" fn on_memory(listener: *mut c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: `adopt` passed a pointer to the device's listener, which outlives the device.
    let listener = unsafe { &*listener.cast::<DeviceListener>() };
    listener.bytes.fetch_add(bytes, Ordering::Relaxed);
    true
}
