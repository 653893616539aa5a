// SPDX-License-Identifier: MIT
//! Boxes, cameras, frusta and rays, and queries that need nothing else.
use crate::error::{check, wrong};
use crate::{sys, Result};
use std::mem::size_of;

/// An oriented box: the points `center + sum t[k] half_extents[k] axes[k]` with `|t[k]| <= 1`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obb {
    /// In world coordinates.
    pub center: [f64; 3],
    /// Three unit vectors; `axes[3 * k + i]` is component `i` of axis `k`.
    pub axes: [f32; 9],
    /// At least 0.
    pub half_extents: [f32; 3],
}

impl Obb {
    /// Returns a box along the coordinate axes.
    pub fn aligned(center: [f64; 3], half_extents: [f32; 3]) -> Obb {
        Obb { center, axes: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], half_extents }
    }

    /// Returns an error if the box is invalid.
    pub fn validate(&self) -> Result<()> {
        check(unsafe { sys::crofton_boxes_validate(self, 1) })
    }

    /// Returns a box that contains this one under `transform`.
    pub fn transformed(&self, transform: &Transform) -> Result<Obb> {
        let mut result = *self;
        check(unsafe { sys::crofton_box_transform(transform, self, &mut result) })?;
        Ok(result)
    }
}

/// The map x -> linear x + translation.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Column-major: `linear[3 * c + r]` is row `r` of column `c`.
    pub linear: [f64; 9],
    /// In units of the target frame.
    pub translation: [f64; 3],
}

impl Transform {
    /// Returns a translation.
    pub fn at(translation: [f64; 3]) -> Transform {
        Transform { linear: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], translation }
    }
}

impl Default for Transform {
    fn default() -> Transform {
        Transform::at([0.0; 3])
    }
}

/// The points origin + t direction with 0 <= t <= max_t. A segment from p to q is {p, q - p, 1}.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The point at t = 0.
    pub origin: [f64; 3],
    /// Any length except 0.
    pub direction: [f64; 3],
    /// May be infinite.
    pub max_t: f64,
}

impl Ray {
    /// Returns a ray without an end.
    pub fn new(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray { origin, direction, max_t: f64::INFINITY }
    }

    /// Returns the segment from `begin` to `end`.
    pub fn segment(begin: [f64; 3], end: [f64; 3]) -> Ray {
        let direction = [end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]];
        Ray { origin: begin, direction, max_t: 1.0 }
    }
}

/// The projection of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Perspective, by the full vertical angle in radians.
    Perspective {
        /// Between 0 and pi, exclusive.
        fov_y: f64,
    },
    /// Orthographic, by the full height in world units.
    Orthographic {
        /// More than 0.
        height: f64,
    },
}

/// A right-handed camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// In world coordinates.
    pub position: [f64; 3],
    /// The direction of view; any length except 0.
    pub forward: [f64; 3],
    /// Not parallel to `forward`.
    pub up: [f64; 3],
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Width over height.
    pub aspect: f64,
    /// More than 0 for perspective cameras.
    pub near: f64,
    /// May be infinite for perspective cameras.
    pub far: f64,
}

impl Default for Camera {
    /// Returns a camera at the origin that looks along -z: 60 degrees, 16:9, from 0.1 to 1000.
    fn default() -> Camera {
        let c = unsafe { sys::crofton_default_camera() };
        Camera {
            position: c.position,
            forward: c.forward,
            up: c.up,
            projection: Projection::Perspective { fov_y: c.fov_y },
            aspect: c.aspect,
            near: c.near_distance,
            far: c.far_distance,
        }
    }
}

impl Camera {
    pub(crate) fn raw(&self) -> sys::Camera {
        let (projection, fov_y, height) = match self.projection {
            Projection::Perspective { fov_y } => (0, fov_y, 0.0),
            Projection::Orthographic { height } => (1, 0.0, height),
        };
        sys::Camera {
            size: size_of::<sys::Camera>(),
            position: self.position,
            forward: self.forward,
            up: self.up,
            projection,
            fov_y,
            height,
            aspect: self.aspect,
            near_distance: self.near,
            far_distance: self.far,
        }
    }

    /// Returns the frustum of this camera.
    pub fn frustum(&self) -> Result<Frustum> {
        let mut frustum = Frustum::empty();
        check(unsafe { sys::crofton_frustum_from_camera(&self.raw(), &mut frustum.raw) })?;
        Ok(frustum)
    }
}

/// The depth range of a projection matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DepthRange {
    /// Vulkan, Direct3D: near at 1, far at 0.
    ReversedZeroToOne = 0,
    /// Vulkan, Direct3D: near at 0, far at 1.
    ZeroToOne = 1,
    /// OpenGL: near at -1, far at 1.
    MinusOneToOne = 2,
}

/// A convex volume: up to twelve half-spaces.
#[derive(Clone, Copy)]
pub struct Frustum {
    pub(crate) raw: sys::Frustum,
}

impl Frustum {
    fn empty() -> Frustum {
        let mut raw: sys::Frustum = unsafe { std::mem::zeroed() };
        raw.size = size_of::<sys::Frustum>();
        Frustum { raw }
    }

    /// Makes a frustum of a matrix. `to_clip` is column-major and takes column vectors relative to `origin` to clip
    /// space.
    pub fn from_matrix(to_clip: &[f64; 16], depth: DepthRange, origin: [f64; 3]) -> Result<Frustum> {
        let mut frustum = Frustum::empty();
        check(unsafe {
            sys::crofton_frustum_from_matrix(to_clip.as_ptr(), depth as u32, origin.as_ptr(), &mut frustum.raw)
        })?;
        Ok(frustum)
    }

    /// Makes a frustum of half-spaces `dot(normal, x - origin) + offset >= 0` with unit normals.
    pub fn from_planes(origin: [f64; 3], planes: &[([f64; 3], f64)]) -> Result<Frustum> {
        if planes.len() > sys::MAX_PLANES {
            return Err(wrong("a frustum has at most twelve planes: give fewer"));
        }
        let mut frustum = Frustum::empty();
        frustum.raw.origin = origin;
        frustum.raw.plane_count = planes.len() as u32;
        for (to, &(normal, offset)) in frustum.raw.planes.iter_mut().zip(planes) {
            *to = sys::Plane { normal, offset };
        }
        Ok(frustum)
    }

    /// Returns normals and offsets of the planes, relative to [`Frustum::origin`].
    pub fn planes(&self) -> Vec<([f64; 3], f64)> {
        self.raw.planes[..self.raw.plane_count as usize].iter().map(|p| (p.normal, p.offset)).collect()
    }

    /// Returns the point that the planes are relative to.
    pub fn origin(&self) -> [f64; 3] {
        self.raw.origin
    }
}

/// How a box lies relative to a frustum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// No point of the box is in the frustum.
    Outside,
    /// Some points are inside and some are outside.
    Straddling,
    /// All points are inside.
    Inside,
}

pub(crate) fn to_verdict(number: u8) -> Verdict {
    match number {
        0 => Verdict::Outside,
        2 => Verdict::Inside,
        _ => Verdict::Straddling,
    }
}

/// Returns the exact verdict of each box.
pub fn classify(frustum: &Frustum, boxes: &[Obb]) -> Result<Vec<Verdict>> {
    let mut verdicts = vec![0u8; boxes.len()];
    check(unsafe { sys::crofton_classify(&frustum.raw, boxes.as_ptr(), boxes.len(), verdicts.as_mut_ptr()) })?;
    Ok(verdicts.into_iter().map(to_verdict).collect())
}

/// Tests whether two boxes share a point, exactly; touching counts.
pub fn touches(a: &Obb, b: &Obb) -> Result<bool> {
    let mut meet = 0;
    check(unsafe { sys::crofton_boxes_meet(a, b, &mut meet) })?;
    Ok(meet != 0)
}

/// The distance of two shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// 0 if they overlap.
    pub distance: f64,
    /// The nearest point of the first.
    pub on_a: [f64; 3],
    /// The nearest point of the second.
    pub on_b: [f64; 3],
}

/// Returns the distance of two boxes.
pub fn distance(a: &Obb, b: &Obb) -> Result<Separation> {
    let mut result = Separation { distance: 0.0, on_a: [0.0; 3], on_b: [0.0; 3] };
    check(unsafe {
        sys::crofton_boxes_distance(a, b, &mut result.distance, result.on_a.as_mut_ptr(), result.on_b.as_mut_ptr())
    })?;
    Ok(result)
}

/// A contact point.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Midway between the surfaces.
    pub position: [f64; 3],
    /// At least 0.
    pub depth: f64,
}

/// The contact points of two boxes. Moving the second by `depth * normal` ends the contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifold {
    /// Unit, from the first to the second.
    pub normal: [f64; 3],
    /// At least 0.
    pub depth: f64,
    /// At most eight.
    pub points: Vec<ContactPoint>,
}

/// Returns where two boxes touch; `None` if they do not.
pub fn manifold(a: &Obb, b: &Obb) -> Result<Option<Manifold>> {
    let mut m: sys::Manifold = unsafe { std::mem::zeroed() };
    m.size = size_of::<sys::Manifold>();
    check(unsafe { sys::crofton_boxes_manifold(a, b, &mut m) })?;
    let points = m.points[..m.point_count as usize].to_vec();
    Ok((!points.is_empty()).then_some(Manifold { normal: m.normal, depth: m.depth, points }))
}

/// Returns the t at which the ray enters the box: 0 if it begins inside, `None` if it misses.
pub fn ray_enters(obb: &Obb, ray: &Ray) -> Result<Option<f64>> {
    let mut t = 0.0;
    check(unsafe { sys::crofton_box_raycast(obb, ray, &mut t) })?;
    Ok(t.is_finite().then_some(t))
}
