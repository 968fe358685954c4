//! Geometries, the scene builder, and the committed scene.
//!
//! Each type is the only owner of its handle. A [`Geometry`] is always committed, only an
//! [`EmbreeSceneBuilder`] can be modified, and only an [`EmbreeScene`] can be queried, so Embree
//! never sees calls in a wrong order. Each owner of a handle also holds whatever Embree points to
//! (device, spheres), so owners may be dropped in any order.

use std::ffi::c_void;
use std::ptr::{self, NonNull};
use std::sync::Arc;

use crate::accel::options::BuildOptions;
use crate::error::Result;
use crate::geometry::SphereSet;
use crate::math::{Hit, Ray};

use super::device::Device;
use super::sys;

/// How particles are represented in Embree. Giants are always user geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::accel) enum ParticleGeometry {
    Points,
    User,
}

/// The spheres as the shim reads them. Never moves or changes once inside its `Arc`.
pub(super) struct SphereBuffers {
    pub(super) table: sys::PsSpheres,
    /// Owns what the table points to.
    _set: Arc<SphereSet>,
    _giants: Vec<[f64; 4]>,
}

// SAFETY: the table's pointers lead to memory that this value owns and that is never written.
unsafe impl Send for SphereBuffers {}
// SAFETY: as above.
unsafe impl Sync for SphereBuffers {}

impl SphereBuffers {
    pub(super) fn new(set: &Arc<SphereSet>, particles_as: ParticleGeometry) -> Arc<Self> {
        let giants: Vec<[f64; 4]> = set
            .giants()
            .iter()
            .map(|giant| [giant.center.x, giant.center.y, giant.center.z, giant.radius])
            .collect();
        let particles = set.particles();
        let table = sys::PsSpheres {
            particles: particles.as_ptr().cast(),
            giants: giants.as_ptr().cast(),
            // A set has less than 2^32 spheres.
            particle_count: particles.len() as u32,
            giant_count: giants.len() as u32,
            first_user_id: match particles_as {
                ParticleGeometry::Points => particles.len() as u32,
                ParticleGeometry::User => 0,
            },
        };
        Arc::new(Self { table, _set: set.clone(), _giants: giants })
    }

    pub(super) fn point_count(&self) -> u32 {
        self.table.first_user_id
    }

    pub(super) fn user_count(&self) -> u32 {
        self.table.particle_count + self.table.giant_count - self.table.first_user_id
    }
}

/// Owns a geometry.
pub(super) struct Geometry {
    raw: NonNull<sys::PsGeometry>,
    device: Arc<Device>,
    spheres: Arc<SphereBuffers>,
}

// SAFETY: a geometry may be used and released by any one thread.
unsafe impl Send for Geometry {}

impl Geometry {
    /// Creates committed sphere points.
    pub(super) fn points(device: &Arc<Device>, spheres: &Arc<SphereBuffers>) -> Result<Self> {
        // SAFETY: device and table are alive, and the geometry keeps them alive.
        let raw = unsafe { sys::ps_points_new(device.raw(), &spheres.table) };
        Self::uncommitted(raw, device, spheres, "share the spheres")?.commit()
    }

    /// Creates committed user geometry.
    pub(super) fn user(device: &Arc<Device>, spheres: &Arc<SphereBuffers>) -> Result<Self> {
        // SAFETY: device and table are alive, and the geometry keeps them alive.
        let raw = unsafe { sys::ps_user_new(device.raw(), &spheres.table) };
        Self::uncommitted(raw, device, spheres, "take the spheres")?.commit()
    }

    pub(super) fn uncommitted(
        raw: *mut sys::PsGeometry,
        device: &Arc<Device>,
        spheres: &Arc<SphereBuffers>,
        doing: &str,
    ) -> Result<Self> {
        let owned = NonNull::new(raw).map(|raw| Self {
            raw,
            device: device.clone(),
            spheres: spheres.clone(),
        });
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
    spheres: Vec<Arc<SphereBuffers>>,
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
        let owned = raw.map(|raw| SceneHandle { raw, spheres: Vec::new(), device: device.clone() });
        device.check("begin a scene")?;
        Ok(Self { handle: owned.expect("Embree reports an error where it gives no scene") })
    }

    /// Adds a geometry of the same device. The geometry's own handle may be dropped afterwards.
    pub(super) fn attach(mut self, geometry: &Geometry) -> Result<Self> {
        self.handle.spheres.push(geometry.spheres.clone());
        // SAFETY: both handles are alive, and `self` is the only user of the scene.
        unsafe { sys::ps_scene_attach(self.handle.raw.as_ptr(), geometry.raw.as_ptr()) }
        self.handle.device.check("add the spheres to the scene")?;
        Ok(self)
    }

    /// Builds the tree.
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
        Ok(EmbreeScene { handle: self.handle })
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
}

impl EmbreeScene {
    /// # Panics
    /// When the slices differ in length.
    pub(super) fn closest(&self, rays: &[Ray], hits: &mut [Hit]) {
        assert_eq!(rays.len(), hits.len(), "one hit for each ray");
        // SAFETY: the scene is committed and may be queried from any thread. `sys` proves that the
        // layouts of rays and hits agree; the shim reads and writes `len` of each.
        unsafe {
            sys::ps_closest(
                self.handle.raw.as_ptr(),
                rays.as_ptr().cast(),
                rays.len(),
                hits.as_mut_ptr().cast(),
            );
        }
    }

    /// # Panics
    /// When the slices differ in length.
    pub(super) fn occluded(&self, rays: &[Ray], blocked: &mut [bool]) {
        assert_eq!(rays.len(), blocked.len(), "one answer for each ray");
        // SAFETY: as in `closest`; C's bool is Rust's, and only 0 and 1 are written.
        unsafe {
            sys::ps_occluded(
                self.handle.raw.as_ptr(),
                rays.as_ptr().cast(),
                rays.len(),
                blocked.as_mut_ptr(),
            );
        }
    }

    /// Bytes held by Embree, see [`Device::bytes`].
    pub(super) fn bytes(&self) -> usize {
        self.handle.device.bytes()
    }
}
