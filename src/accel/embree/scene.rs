//! Geometries, the scene builder, and the committed scene.
//!
//! Each type is the only owner of its handle. A [`Geometry`] is always committed, only an
//! [`EmbreeSceneBuilder`] can be modified, and only an [`EmbreeScene`] can be queried, so Embree's
//! functions are never called in a wrong order. Each owner of a handle also holds the memory that
//! Embree refers to (device, spheres), so owners may be dropped in any order.

use std::ffi::c_void;
use std::ptr::{self, NonNull};
use std::sync::Arc;

use crate::accel::options::BuildOptions;
use crate::error::Result;
use crate::math::{Hit, Ray};

use super::device::Device;
use super::group::{ParticleGeometry, SphereGroup};
use super::sys;

/// Owns a geometry.
pub(super) struct Geometry {
    raw: NonNull<sys::PsGeometry>,
    device: Arc<Device>,
    group: Arc<SphereGroup>,
}

// SAFETY: a geometry may be used and released by any one thread.
unsafe impl Send for Geometry {}

impl Geometry {
    /// Creates the committed geometry of a group.
    pub(super) fn new(device: &Arc<Device>, group: &Arc<SphereGroup>) -> Result<Self> {
        // SAFETY: device and group are alive, and the geometry keeps them alive.
        let raw = unsafe {
            match group.geometry {
                ParticleGeometry::Points => sys::ps_points_new(device.raw(), &group.raw),
                ParticleGeometry::User => sys::ps_user_new(device.raw(), &group.raw),
            }
        };
        Self::uncommitted(raw, device, group, "take the spheres")?.commit()
    }

    pub(super) fn uncommitted(
        raw: *mut sys::PsGeometry,
        device: &Arc<Device>,
        group: &Arc<SphereGroup>,
        doing: &str,
    ) -> Result<Self> {
        let owned =
            NonNull::new(raw).map(|raw| Self { raw, device: device.clone(), group: group.clone() });
        device.check(doing)?;
        Ok(owned.expect("Embree reports an error where it gives no geometry"))
    }

    fn commit(self) -> Result<Self> {
        // SAFETY: the handle is alive, and no other thread has it.
        unsafe { sys::ps_geometry_commit(self.raw.as_ptr()) }
        self.device.check("prepare the spheres")?;
        Ok(self)
    }
}

impl Drop for Geometry {
    fn drop(&mut self) {
        // SAFETY: this is the only owner; scenes count their own reference.
        unsafe { sys::ps_geometry_release(self.raw.as_ptr()) }
    }
}

/// Owns a scene's handle, and everything that Embree reads through it.
struct SceneHandle {
    raw: NonNull<sys::PsScene>,
    group: Option<Arc<SphereGroup>>,
    device: Arc<Device>,
}

// SAFETY: any thread may use an Embree scene; `EmbreeSceneBuilder` lets only one thread modify it.
unsafe impl Send for SceneHandle {}
// SAFETY: by Embree's contract, the `&self` functions (queries of a committed `EmbreeScene`) may
// run on many threads at once.
unsafe impl Sync for SceneHandle {}

impl Drop for SceneHandle {
    fn drop(&mut self) {
        // SAFETY: this is the only owner, and its fields are dropped afterwards.
        unsafe { sys::ps_scene_release(self.raw.as_ptr()) }
    }
}

/// A scene under construction.
pub(super) struct EmbreeSceneBuilder {
    handle: SceneHandle,
}

impl EmbreeSceneBuilder {
    pub(super) fn new(device: &Arc<Device>) -> Result<Self> {
        // SAFETY: the device is alive.
        let raw = NonNull::new(unsafe { sys::ps_scene_new(device.raw()) });
        let owned = raw.map(|raw| SceneHandle { raw, group: None, device: device.clone() });
        device.check("begin a scene")?;
        Ok(Self { handle: owned.expect("Embree reports an error where it gives no scene") })
    }

    /// Attaches the geometry, which belongs to the same device. The geometry's own handle may be
    /// dropped afterwards.
    pub(super) fn attach(mut self, geometry: &Geometry) -> Result<Self> {
        self.handle.group = Some(geometry.group.clone());
        // SAFETY: both handles are alive, and `self` is the only user of the scene.
        unsafe { sys::ps_scene_attach(self.handle.raw.as_ptr(), geometry.raw.as_ptr()) }
        self.handle.device.check("add the spheres to the scene")?;
        Ok(self)
    }

    /// Builds the BVH.
    pub(super) fn commit(self, options: &BuildOptions) -> Result<EmbreeScene> {
        let raw = self.handle.raw.as_ptr();
        let listener = ptr::from_ref(options).cast_mut().cast::<c_void>();
        // SAFETY: `self` is the only user of the scene. `on_progress` reads `options` as a shared
        // reference and is unregistered before the borrow ends.
        unsafe {
            sys::ps_scene_on_progress(raw, Some(on_progress), listener);
            sys::ps_scene_commit(raw);
            sys::ps_scene_on_progress(raw, None, ptr::null_mut());
        }
        self.handle.device.check("build its tree")?;
        let group = self.handle.group.clone().expect("a scene has a geometry");
        Ok(EmbreeScene { handle: self.handle, group })
    }
}

unsafe extern "C" fn on_progress(options: *mut c_void, done: f64) -> bool {
    // SAFETY: `commit` passed a `&BuildOptions` that outlives all calls of this function.
    let options = unsafe { &*options.cast::<BuildOptions>() };
    options.progress.report(done);
    !options.cancel.is_cancelled()
}

/// A committed scene, which can only be queried.
pub(super) struct EmbreeScene {
    handle: SceneHandle,
    group: Arc<SphereGroup>,
}

impl EmbreeScene {
    /// Bytes held by the group, without those of Embree.
    pub(super) fn group_bytes(&self) -> usize {
        self.group.bytes()
    }

    fn target(&self) -> sys::PsTarget {
        sys::PsTarget { scene: self.handle.raw.as_ptr(), group: &self.group.raw }
    }
}

/// Finds the closest hit of each ray in any of the scenes.
///
/// # Panics
/// When the slices differ in length.
pub(super) fn closest(scenes: &[EmbreeScene], rays: &[Ray], hits: &mut [Hit]) {
    assert_eq!(rays.len(), hits.len(), "one hit for each ray");
    let targets: Vec<sys::PsTarget> = scenes.iter().map(EmbreeScene::target).collect();
    // SAFETY: the scenes are committed and may be queried from any thread. `sys` proves that the
    // layouts of rays and hits agree; the shim reads and writes as many as it is told.
    unsafe {
        sys::ps_closest(
            targets.as_ptr(),
            targets.len(),
            rays.as_ptr().cast(),
            rays.len(),
            hits.as_mut_ptr().cast(),
        );
    }
}

/// Sets each flag to true if the ray is occluded in any of the scenes.
///
/// # Panics
/// When the slices differ in length.
pub(super) fn occluded(scenes: &[EmbreeScene], rays: &[Ray], occluded: &mut [bool]) {
    assert_eq!(rays.len(), occluded.len(), "one output per ray");
    let targets: Vec<sys::PsTarget> = scenes.iter().map(EmbreeScene::target).collect();
    // SAFETY: as in `closest`; C's bool is Rust's, and only 0 and 1 are written.
    unsafe {
        sys::ps_occluded(
            targets.as_ptr(),
            targets.len(),
            rays.as_ptr().cast(),
            rays.len(),
            occluded.as_mut_ptr(),
        );
    }
}
