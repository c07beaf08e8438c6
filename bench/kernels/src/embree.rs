//! Embree 4, opened at run time: the few functions of its C API that are needed. The only file with `unsafe`.
//!
//! Source: Embree 4 API manual, <https://github.com/RenderKit/embree>.

use crate::rays::{BLOCK, RayBlock};
use libloading::Library;
use std::arch::asm;
use std::ffi::{CString, c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::ptr::{null, null_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicIsize, Ordering};
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{MeshHit, Ray};

type Handle = *mut c_void;

const INVALID: u32 = u32::MAX;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const GEOMETRY_TRIANGLE: c_int = 0;
const SCENE_ROBUST: c_int = 4;
const QUALITY_MEDIUM: c_int = 1;
const QUALITY_HIGH: c_int = 2;
const QUERY_COHERENT: c_int = 1 << 16;
const ALL_FEATURES: c_int = -1;

/// `RTCRayHit`. The last rows are larger than in builds without instance arrays, which never touch them.
#[repr(C, align(16))]
#[derive(Clone, Copy, Default)]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    dir: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
    instance_primitive: u32,
    unused: [u32; 3],
}

/// `RTCRayHit16`.
#[repr(C, align(64))]
#[derive(Clone, Copy, Default)]
struct RayHit16 {
    origin: [[f32; BLOCK]; 3],
    near: [f32; BLOCK],
    dir: [[f32; BLOCK]; 3],
    time: [f32; BLOCK],
    far: [f32; BLOCK],
    mask: [u32; BLOCK],
    id: [u32; BLOCK],
    flags: [u32; BLOCK],
    normal: [[f32; BLOCK]; 3],
    u: [f32; BLOCK],
    v: [f32; BLOCK],
    primitive: [u32; BLOCK],
    geometry: [u32; BLOCK],
    instance: [u32; BLOCK],
    instance_primitive: [u32; BLOCK],
}

/// `int valid[16]` with the alignment that the wide functions ask for.
#[repr(C, align(64))]
struct Valid([c_int; BLOCK]);

/// `RTCIntersectArguments` and `RTCOccludedArguments`.
#[repr(C)]
struct Arguments {
    flags: c_int,
    features: c_int,
    context: *mut c_void,
    filter: *const c_void,
    function: *const c_void,
    /// Only in builds with `RTC_MIN_WIDTH`.
    min_width_distance_factor: f32,
}

impl Arguments {
    fn new(coherent: bool) -> Self {
        let flags = if coherent { QUERY_COHERENT } else { 0 };
        let (context, filter, function) = (null_mut(), null(), null());
        Self { flags, features: ALL_FEATURES, context, filter, function, min_width_distance_factor: 0.0 }
    }
}

type Monitor = extern "C" fn(*mut c_void, isize, bool) -> bool;

/// The functions, under their C names without `rtc`.
struct Api {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    release_device: unsafe extern "C" fn(Handle),
    device_error: unsafe extern "C" fn(Handle) -> c_int,
    set_monitor: unsafe extern "C" fn(Handle, Monitor, *mut c_void),
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    release_scene: unsafe extern "C" fn(Handle),
    set_scene_flags: unsafe extern "C" fn(Handle, c_int),
    set_scene_quality: unsafe extern "C" fn(Handle, c_int),
    join_commit_scene: unsafe extern "C" fn(Handle),
    new_geometry: unsafe extern "C" fn(Handle, c_int) -> Handle,
    release_geometry: unsafe extern "C" fn(Handle),
    set_geometry_quality: unsafe extern "C" fn(Handle, c_int),
    set_buffer: unsafe extern "C" fn(Handle, c_int, u32, c_int, *const c_void, usize, usize, usize),
    commit_geometry: unsafe extern "C" fn(Handle),
    attach_geometry: unsafe extern "C" fn(Handle, Handle) -> u32,
    intersect1: unsafe extern "C" fn(Handle, *mut RayHit, *mut Arguments),
    occluded1: unsafe extern "C" fn(Handle, *mut RayHit, *mut Arguments),
    intersect16: unsafe extern "C" fn(*const Valid, Handle, *mut RayHit16, *mut Arguments),
    occluded16: unsafe extern "C" fn(*const Valid, Handle, *mut RayHit16, *mut Arguments),
    /// Stays loaded to the end: its worker threads may still be leaving when the last scene is gone.
    _library: ManuallyDrop<Library>,
}

/// The opened library.
#[derive(Clone)]
pub struct Embree(Arc<Api>);

impl Embree {
    /// Opens the shared library at `path`.
    pub fn open(path: &str) -> Result<Self, String> {
        // SAFETY: the user names a library that is Embree 4; its initialisers do nothing but set up tables.
        let library = unsafe { Library::new(path) }.map_err(|error| format!("{path}: {error}"))?;
        // SAFETY: the types above are those of Embree 4's headers.
        unsafe { Self::functions(library) }.map_err(|error| format!("{path}: {error}"))
    }

    /// # Safety
    /// `library` must be Embree 4.
    unsafe fn functions(library: Library) -> Result<Self, libloading::Error> {
        macro_rules! function {
            ($name:literal) => {
                // SAFETY: see above.
                *unsafe { library.get($name.as_bytes()) }?
            };
        }
        Ok(Self(Arc::new(Api {
            new_device: function!("rtcNewDevice"),
            release_device: function!("rtcReleaseDevice"),
            device_error: function!("rtcGetDeviceError"),
            set_monitor: function!("rtcSetDeviceMemoryMonitorFunction"),
            new_scene: function!("rtcNewScene"),
            release_scene: function!("rtcReleaseScene"),
            set_scene_flags: function!("rtcSetSceneFlags"),
            set_scene_quality: function!("rtcSetSceneBuildQuality"),
            join_commit_scene: function!("rtcJoinCommitScene"),
            new_geometry: function!("rtcNewGeometry"),
            release_geometry: function!("rtcReleaseGeometry"),
            set_geometry_quality: function!("rtcSetGeometryBuildQuality"),
            set_buffer: function!("rtcSetSharedGeometryBuffer"),
            commit_geometry: function!("rtcCommitGeometry"),
            attach_geometry: function!("rtcAttachGeometry"),
            intersect1: function!("rtcIntersect1"),
            occluded1: function!("rtcOccluded1"),
            intersect16: function!("rtcIntersect16"),
            occluded16: function!("rtcOccluded16"),
            _library: ManuallyDrop::new(library),
        })))
    }
}

/// A device: a number of threads to build with.
#[derive(Clone)]
pub struct Device(Arc<DeviceHandle>);

struct DeviceHandle {
    api: Embree,
    device: Handle,
    bytes: AtomicIsize,
}

/// A scene of one mesh.
pub struct Scene {
    api: Embree,
    scene: Handle,
    bytes: usize,
    _device: Device,
    /// Embree reads the vertices while it traces; they end with one more vertex, because it loads 16 bytes at a time.
    _buffers: (Arc<[Vec3]>, Arc<[[u32; 3]]>),
}

// SAFETY: Embree allows devices to be used from any thread.
unsafe impl Send for DeviceHandle {}
// SAFETY: as above.
unsafe impl Sync for DeviceHandle {}
// SAFETY: Embree allows queries of a committed scene from any number of threads; nothing changes it later.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

extern "C" fn count_bytes(counter: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `counter` is the counter of a device, which it outlives.
    unsafe { &*counter.cast::<AtomicIsize>() }.fetch_add(bytes, Ordering::Relaxed);
    true
}

impl Device {
    /// A device that builds with `threads` threads.
    pub fn new(api: &Embree, threads: usize) -> Result<Self, String> {
        let settings = format!("threads={threads},set_affinity=0,ignore_config_files=1");
        let settings = CString::new(settings).map_err(|error| error.to_string())?;
        // SAFETY: the settings are a C string.
        let device = unsafe { (api.0.new_device)(settings.as_ptr()) };
        let this = Arc::new(DeviceHandle { api: api.clone(), device, bytes: AtomicIsize::new(0) });
        // SAFETY: the counter is not moved and is dropped after the device.
        unsafe { (api.0.set_monitor)(device, count_bytes, (&raw const this.bytes).cast_mut().cast()) };
        Ok(Self(this))
    }
}

impl Drop for DeviceHandle {
    fn drop(&mut self) {
        // SAFETY: the handle is alive and used nowhere else.
        unsafe { (self.api.0.release_device)(self.device) };
    }
}

impl Scene {
    /// Builds; the last of the `positions` is padding and belongs to no triangle.
    pub fn build(
        device: &Device,
        (positions, indices): (&Arc<[Vec3]>, &Arc<[[u32; 3]]>),
        (high, robust): (bool, bool),
    ) -> Result<Self, String> {
        let DeviceHandle { api, device: handle, bytes, .. } = &*device.0;
        let quality = if high { QUALITY_HIGH } else { QUALITY_MEDIUM };
        let rtc = &api.0;
        let before = bytes.load(Ordering::Relaxed);
        // SAFETY: handles come from the functions that make them; the buffers live as long as the scene.
        let scene = unsafe {
            let scene = (rtc.new_scene)(*handle);
            (rtc.set_scene_flags)(scene, if robust { SCENE_ROBUST } else { 0 });
            (rtc.set_scene_quality)(scene, quality);
            let geometry = (rtc.new_geometry)(*handle, GEOMETRY_TRIANGLE);
            (rtc.set_geometry_quality)(geometry, quality);
            let (vertices, triangles) = (positions.as_ptr().cast(), indices.as_ptr().cast());
            (rtc.set_buffer)(geometry, BUFFER_VERTEX, 0, FORMAT_FLOAT3, vertices, 0, 12, positions.len() - 1);
            (rtc.set_buffer)(geometry, BUFFER_INDEX, 0, FORMAT_UINT3, triangles, 0, 12, indices.len());
            (rtc.commit_geometry)(geometry);
            (rtc.attach_geometry)(scene, geometry);
            (rtc.release_geometry)(geometry);
            // Either commit function may use the threads of the largest device of the process: one number of threads each.
            (rtc.join_commit_scene)(scene);
            scene
        };
        let bytes = (bytes.load(Ordering::Relaxed) - before).max(0) as usize;
        let buffers = (positions.clone(), indices.clone());
        let scene = Self { api: api.clone(), scene, bytes, _device: device.clone(), _buffers: buffers };
        // SAFETY: the device is alive.
        match unsafe { (rtc.device_error)(*handle) } {
            0 => Ok(scene),
            code => Err(format!("Embree reports error {code}")),
        }
    }

    /// Bytes that the device has allocated for this scene.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// `rtcIntersect1` for each ray.
    pub fn closest(&self, rays: &[Ray], coherent: bool, hits: &mut [Option<MeshHit>]) {
        let _mode = FlushDenormals::new();
        let mut arguments = Arguments::new(coherent);
        let mut query = RayHit { mask: u32::MAX, ..RayHit::default() };
        for (ray, hit) in rays.iter().zip(hits) {
            query.start(ray);
            // SAFETY: the scene is committed; the structures have Embree's layout and alignment.
            unsafe { (self.api.0.intersect1)(self.scene, &raw mut query, &raw mut arguments) };
            *hit = (query.geometry != INVALID).then_some(MeshHit {
                primitive: query.primitive,
                t: query.far,
                u: query.u,
                v: query.v,
            });
        }
    }

    /// `rtcOccluded1` for each ray.
    pub fn any(&self, rays: &[Ray], coherent: bool, occluded: &mut [bool]) {
        let _mode = FlushDenormals::new();
        let mut arguments = Arguments::new(coherent);
        let mut query = RayHit { mask: u32::MAX, ..RayHit::default() };
        for (ray, occluded) in rays.iter().zip(occluded) {
            query.start(ray);
            // SAFETY: as above; `RTCRay` is the first part of `RTCRayHit`.
            unsafe { (self.api.0.occluded1)(self.scene, &raw mut query, &raw mut arguments) };
            *occluded = query.far == f32::NEG_INFINITY;
        }
    }

    /// `rtcIntersect16` for each block.
    pub fn closest16(&self, blocks: &[RayBlock], coherent: bool, hits: &mut [Option<MeshHit>]) {
        let _mode = FlushDenormals::new();
        let mut arguments = Arguments::new(coherent);
        let mut query = RayHit16 { mask: [u32::MAX; BLOCK], ..RayHit16::default() };
        for (block, hits) in blocks.iter().zip(hits.chunks_mut(BLOCK)) {
            query.start(block);
            let valid = Valid::first(hits.len());
            // SAFETY: as above.
            unsafe {
                (self.api.0.intersect16)(&raw const valid, self.scene, &raw mut query, &raw mut arguments);
            }
            for (k, hit) in hits.iter_mut().enumerate() {
                *hit = (query.geometry[k] != INVALID).then_some(MeshHit {
                    primitive: query.primitive[k],
                    t: query.far[k],
                    u: query.u[k],
                    v: query.v[k],
                });
            }
        }
    }

    /// `rtcOccluded16` for each block.
    pub fn any16(&self, blocks: &[RayBlock], coherent: bool, occluded: &mut [bool]) {
        let _mode = FlushDenormals::new();
        let mut arguments = Arguments::new(coherent);
        let mut query = RayHit16 { mask: [u32::MAX; BLOCK], ..RayHit16::default() };
        for (block, occluded) in blocks.iter().zip(occluded.chunks_mut(BLOCK)) {
            query.start(block);
            let valid = Valid::first(occluded.len());
            // SAFETY: as above.
            unsafe {
                (self.api.0.occluded16)(&raw const valid, self.scene, &raw mut query, &raw mut arguments);
            }
            for (k, occluded) in occluded.iter_mut().enumerate() {
                *occluded = query.far[k] == f32::NEG_INFINITY;
            }
        }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: the handle is alive and used nowhere else.
        unsafe { (self.api.0.release_scene)(self.scene) };
    }
}

impl RayHit {
    #[inline]
    fn start(&mut self, ray: &Ray) {
        (self.origin, self.dir) = (ray.origin.into(), ray.dir.into());
        (self.near, self.far) = (ray.t.min, ray.t.max);
        (self.geometry, self.instance) = (INVALID, INVALID);
    }
}

impl RayHit16 {
    #[inline]
    fn start(&mut self, block: &RayBlock) {
        (self.origin, self.dir) = (block.origin, block.dir);
        (self.near, self.far) = (block.min, block.max);
        (self.geometry, self.instance) = ([INVALID; BLOCK], [INVALID; BLOCK]);
    }
}

impl Valid {
    #[inline]
    fn first(count: usize) -> Self {
        Self(std::array::from_fn(|k| if k < count { -1 } else { 0 }))
    }
}

/// Flushes denormal numbers to zero on this thread, as Embree recommends, for as long as it lives.
struct FlushDenormals(u32);

impl FlushDenormals {
    fn new() -> Self {
        let mut before = 0_u32;
        // SAFETY: stores the control register to a local variable.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut before, options(nostack)) };
        Self::set(before | 0x8040);
        Self(before)
    }

    fn set(value: u32) {
        // SAFETY: only the bits FTZ and DAZ differ from what was there; no float is moved across a call of Embree.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, readonly)) };
    }
}

impl Drop for FlushDenormals {
    fn drop(&mut self) {
        Self::set(self.0);
    }
}
