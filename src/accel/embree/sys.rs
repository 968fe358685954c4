//! The declarations of `ffi/shim.h`, as read by bindgen, with a proof that rays and hits have the
//! same layout on both sides.

#![allow(dead_code, reason = "Rust 1.85 overlooks a constant that only constants use")]
#![allow(
    missing_docs,
    unreachable_pub,
    non_camel_case_types,
    reason = "generated; ffi/shim.h says what things mean"
)]

use std::mem::offset_of;

use crate::math::{Hit, NO_SPHERE, Ray};

include!(concat!(env!("OUT_DIR"), "/shim.rs"));

const _: () = {
    assert!(size_of::<Ray>() == size_of::<PsRay>() && align_of::<Ray>() == align_of::<PsRay>());
    assert!(offset_of!(Ray, origin) == offset_of!(PsRay, origin));
    assert!(offset_of!(Ray, t_min) == offset_of!(PsRay, t_min));
    assert!(offset_of!(Ray, direction) == offset_of!(PsRay, direction));
    assert!(offset_of!(Ray, t_max) == offset_of!(PsRay, t_max));
    assert!(offset_of!(Ray, exclude) == offset_of!(PsRay, exclude));
    assert!(offset_of!(Ray, origin_low) == offset_of!(PsRay, origin_low));
    assert!(offset_of!(Ray, direction_low) == offset_of!(PsRay, direction_low));
    assert!(size_of::<Hit>() == size_of::<PsHit>() && align_of::<Hit>() == align_of::<PsHit>());
    assert!(offset_of!(Hit, t) == offset_of!(PsHit, t));
    assert!(offset_of!(Hit, id) == offset_of!(PsHit, id));
    assert!(NO_SPHERE == PS_NO_SPHERE);
};
