// SPDX-License-Identifier: MIT
//! Crofton for Rust: exact culling, collision detection and rays; and boxes and triangulations that
//! are optimal by a stated measure. A thin crate over Crofton's C API: the library does the work, the compiler checks
//! ownership.
//!
//! ```
//! use crofton::{Bound, Camera, Description, ViewResult, World};
//! # fn main() -> Result<(), crofton::Error> {
//! let mut world = World::new()?;
//! let sphere = world.add(&Description::bound(Bound::Sphere { center: [0.0, 0.0, -5.0], radius: 1.0 }).user(7))?;
//! world.update()?; // once a frame; then ask
//! let mut visible = ViewResult::new()?;
//! let seen = world.view(&Camera::default().into(), &mut visible)?;
//! assert_eq!(seen.ids(), [sphere.index]);
//! # Ok(()) }
//! ```
//!
//! Positions are `f64` in world coordinates, which are right-handed; angles are in radians. Queries answer as of the
//! last [`World::update`]. Many threads may query a `&World` at once.
#![warn(missing_docs)]
mod baked;
mod broadphase;
mod depth;
mod description;
mod error;
mod fit;
mod geometry;
mod jobs;
mod log;
mod occlusion;
mod queries;
mod regions;
mod shape;
#[allow(missing_docs, dead_code)]
mod sys;
mod triangulate;
mod views;
mod world;

pub use baked::{
    BakedInstance, BakedMesh, BakedNode, BakedRegionOptions, BakedScene, Pvs, PvsMode, RegionFile, RegionIndex,
};
pub use broadphase::{Broadphase, Filter, Pair, Pairs};
pub use depth::{ClusteredMesh, DepthCuller, DepthObject, DepthReceiver, IndexOrder};
pub use description::{Bound, Description, Indices, MeshData, Vertices};
pub use error::{Error, Result, Status};
pub use fit::{fit, fit_boxes, Criterion, Points, Quality};
pub use geometry::{
    classify, distance, manifold, ray_enters, touches, Camera, ContactPoint, DepthRange, Frustum, Manifold, Obb,
    Projection, Ray, Separation, Transform, Verdict,
};
pub use jobs::{Executor, Threads};
pub use log::{log, set_logger, LogLevel, Logger};
pub use occlusion::{DepthBuffer, FindOptions, Occluder, OccluderRef, OcclusionOptions, OcclusionStatistics};
pub use queries::{
    Closest, Contact, Containment, Feature, Found, MeshContact, ObjectHit, ObjectPair, Phase, QueryFilter, QueryShape,
};
pub use queries::{ObjectManifold, ShapeHit, TrackedPoint};
pub use regions::{AttachedRegion, Region, RegionInfo, RegionObject, RegionOptions};
pub use shape::{
    CastOptions, HeightField, Impact, MassProperties, Motion, NearestPoint, Part, Penetration, Placed, Shape,
    ShapeContact, ShapePoint, ShapeRayHit,
};
pub use triangulate::{Method, Triangulation, Triangulator};
pub use views::{view_boxes, ViewMatrix, ViewRequest, ViewResult, VisibleCluster};
pub use views::{Cluster, ClusterBox, Clusters, DrawLimits, PictureView, Seen, SeenByMany, ShadowReceivers};
pub use world::{Mesh, Node, Object, ObjectRef, Statistics, World, WorldOptions};

/// All 32 layers.
pub const ALL_LAYERS: u32 = u32::MAX;

/// Returns the library's version, "major.minor.patch".
pub fn version() -> &'static str {
    // The library returns a constant of plain ASCII.
    unsafe { std::ffi::CStr::from_ptr(sys::crofton_version_string()) }.to_str().unwrap_or("")
}

/// Runs the programs of README.md as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
