// SPDX-License-Identifier: MIT
//! Descriptions of objects: meshes, bounds, transforms.
use crate::error::wrong;
#[cfg(doc)]
use crate::World;
use crate::{sys, Error, Mesh, Node, Obb, Result, Status, Transform};
use std::{mem::size_of, os::raw::c_void, ptr};

/// A mesh's positions, in your memory.
#[derive(Debug, Clone, Copy)]
pub enum Vertices<'a> {
    /// x, y, z of each vertex.
    F32(&'a [[f32; 3]]),
    /// Rounded to `f32`.
    F64(&'a [[f64; 3]]),
    /// x, y, z of each vertex are the first three of `stride` numbers.
    Interleaved {
        /// All vertices, one after another.
        floats: &'a [f32],
        /// Numbers per vertex, at least 3.
        stride: usize,
    },
}

/// A mesh's triangles, three indices each, counter-clockwise seen from outside.
#[derive(Debug, Clone, Copy)]
pub enum Indices<'a> {
    /// Each three positions are a triangle.
    None,
    /// 32 bits each.
    U32(&'a [u32]),
    /// 16 bits each.
    U16(&'a [u16]),
}

/// A mesh in its own frame; [`World`] copies what it needs.
#[derive(Debug, Clone, Copy)]
pub struct MeshData<'a> {
    /// The vertices.
    pub vertices: Vertices<'a>,
    /// The triangles.
    pub indices: Indices<'a>,
    /// True: queries test the triangles; false: they test the mesh's box.
    pub triangles: bool,
    /// Views with a picture list the triangles by clusters: [`World::clusters_of`].
    pub clusters: bool,
    /// With clusters: back faces are not drawn; they are listed for mirrored objects only.
    pub one_sided: bool,
}

impl<'a> MeshData<'a> {
    /// Describes a mesh with the default options.
    pub fn new(positions: &'a [[f32; 3]], indices: &'a [u32]) -> MeshData<'a> {
        let (vertices, indices) = (Vertices::F32(positions), Indices::U32(indices));
        MeshData { vertices, indices, triangles: true, clusters: false, one_sided: false }
    }

    pub(crate) fn raw(&self) -> Result<sys::MeshData> {
        let (positions, position_count, position_stride, is_double) = match self.vertices {
            Vertices::F32(p) => (p.as_ptr() as *const c_void, p.len(), 0, 0),
            Vertices::F64(p) => (p.as_ptr() as *const c_void, p.len(), 0, 1),
            Vertices::Interleaved { floats, stride } => {
                if stride < 3 || floats.len() % stride != 0 {
                    return Err(wrong(
                        "interleaved vertices: `floats` is to hold whole vertices of `stride` >= 3 numbers",
                    ));
                }
                (floats.as_ptr() as *const c_void, floats.len() / stride, stride * size_of::<f32>(), 0)
            }
        };
        let (indices, index_count, is_short) = match self.indices {
            Indices::None => (ptr::null(), 0, 0),
            Indices::U32(i) => (i.as_ptr() as *const c_void, i.len(), 0),
            Indices::U16(i) => (i.as_ptr() as *const c_void, i.len(), 1),
        };
        // The library takes no indices for `Indices::None`.
        if index_count == 0 && !indices.is_null() {
            let message = "the slice of indices is empty, so there is no triangle".to_owned();
            return Err(Error { status: Status::Empty, message, item: None });
        }
        Ok(sys::MeshData {
            size: size_of::<sys::MeshData>(),
            positions,
            position_count,
            position_stride,
            indices,
            index_count,
            is_double,
            is_short,
            triangles: self.triangles as u32,
            clusters: self.clusters as u32,
            one_sided: self.one_sided as u32,
            precut: ptr::null(),
        })
    }
}

/// The bound of an object without a mesh, in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// An oriented box.
    Box(Obb),
    /// A box along the axes.
    Aligned {
        /// The minimum corner.
        min: [f64; 3],
        /// The maximum corner.
        max: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// The center.
        center: [f64; 3],
        /// At least 0.
        radius: f64,
    },
}

impl Bound {
    pub(crate) fn raw(&self) -> sys::Bound {
        let mut bound = sys::Bound {
            kind: 0,
            bounding_box: Obb::aligned([0.0; 3], [0.0; 3]),
            min: [0.0; 3],
            max: [0.0; 3],
            center: [0.0; 3],
            radius: 0.0,
        };
        match *self {
            Bound::Box(b) => (bound.kind, bound.bounding_box) = (1, b),
            Bound::Aligned { min, max } => (bound.kind, bound.min, bound.max) = (2, min, max),
            Bound::Sphere { center, radius } => (bound.kind, bound.center, bound.radius) = (3, center, radius),
        }
        bound
    }
}

/// Describes an object to add: a mesh that is placed under a node or in the world, or a bound.
#[derive(Debug, Clone, Copy)]
pub struct Description {
    pub(crate) mesh: Option<Mesh>,
    pub(crate) bound: Option<Bound>,
    pub(crate) node: Option<Node>,
    pub(crate) transform: Option<Transform>,
    pub(crate) user: u64,
    pub(crate) layers: u32,
    pub(crate) collides_with: u32,
    pub(crate) occludes: bool,
}

impl Description {
    fn new(mesh: Option<Mesh>, bound: Option<Bound>) -> Description {
        Description {
            mesh,
            bound,
            node: None,
            transform: None,
            user: 0,
            layers: u32::MAX,
            collides_with: u32::MAX,
            occludes: true,
        }
    }
    /// Describes an object with a mesh.
    pub fn mesh(mesh: Mesh) -> Description {
        Description::new(Some(mesh), None)
    }
    /// Describes an object with only a bound.
    pub fn bound(bound: Bound) -> Description {
        Description::new(None, Some(bound))
    }
    /// Places the object under this node.
    pub fn under(self, node: Node) -> Description {
        Description { node: Some(node), ..self }
    }
    /// Sets the transform of the mesh, to its node or to the world.
    pub fn at(self, transform: Transform) -> Description {
        Description { transform: Some(transform), ..self }
    }
    /// Sets a number that is returned with every answer.
    pub fn user(self, user: u64) -> Description {
        Description { user, ..self }
    }
    /// Sets the layers that the object is in; the default is all.
    pub fn layers(self, layers: u32) -> Description {
        Description { layers, ..self }
    }
    /// Sets the layers that the object collides with; the default is all.
    pub fn collides_with(self, layers: u32) -> Description {
        Description { collides_with: layers, ..self }
    }
    /// Makes the object hide no others.
    pub fn transparent(self) -> Description {
        Description { occludes: false, ..self }
    }
}
