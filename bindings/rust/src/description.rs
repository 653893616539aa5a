// SPDX-License-Identifier: MIT
//! Descriptions of objects: meshes, bounds, transforms.
use crate::error::wrong;
use crate::world::as_pointer;
#[cfg(doc)]
use crate::World;
use crate::{sys, ClusteredMesh, Error, Mesh, Node, Obb, Result, Shape, Status, Transform};
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
    /// With clusters: those of this mesh that were cut before.
    pub precut: Option<&'a ClusteredMesh>,
}

impl<'a> MeshData<'a> {
    /// Describes a mesh with the default options.
    pub fn new(positions: &'a [[f32; 3]], indices: &'a [u32]) -> MeshData<'a> {
        let (vertices, indices) = (Vertices::F32(positions), Indices::U32(indices));
        MeshData { vertices, indices, triangles: true, clusters: false, one_sided: false, precut: None }
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
            precut: self.precut.map_or(ptr::null(), |p| p.raw as *const _),
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

/// Describes an object to add: a mesh or a shape that is placed under a node or in the world, or a bound.
#[derive(Debug, Clone, Copy)]
pub struct Description<'a> {
    pub(crate) mesh: Option<Mesh>,
    pub(crate) bound: Option<Bound>,
    pub(crate) node: Option<Node>,
    pub(crate) transform: Option<Transform>,
    pub(crate) user: u64,
    pub(crate) layers: u32,
    pub(crate) collides_with: u32,
    pub(crate) occludes: bool,
    pub(crate) only_occludes: bool,
    pub(crate) hidden: bool,
    pub(crate) shape: Option<&'a Shape>,
}

impl<'a> Description<'a> {
    fn new(mesh: Option<Mesh>, bound: Option<Bound>) -> Self {
        Description {
            mesh,
            bound,
            node: None,
            transform: None,
            user: 0,
            layers: u32::MAX,
            collides_with: u32::MAX,
            occludes: true,
            only_occludes: false,
            hidden: false,
            shape: None,
        }
    }
    // `bound`: that of the description, as the library has it.
    pub(crate) fn raw(&self, bound: *const sys::Bound) -> sys::ObjectDescription {
        sys::ObjectDescription {
            size: size_of::<sys::ObjectDescription>(),
            user: self.user,
            bound,
            transform: as_pointer(&self.transform),
            has_mesh: self.mesh.is_some() as u32,
            has_node: self.node.is_some() as u32,
            mesh: self.mesh.unwrap_or(Mesh { index: u32::MAX, generation: 0 }),
            node: self.node.unwrap_or(Node { index: u32::MAX, generation: 0 }),
            layers: self.layers,
            collides_with: self.collides_with,
            occludes: self.occludes as u32,
            only_occludes: self.only_occludes as u32,
            shape: self.shape.map_or(ptr::null(), |s| s.raw as *const _),
            hidden: self.hidden as u32,
        }
    }
    /// Describes an object with a mesh.
    pub fn mesh(mesh: Mesh) -> Self {
        Description::new(Some(mesh), None)
    }
    /// Describes an object with only a bound.
    pub fn bound(bound: Bound) -> Self {
        Description::new(None, Some(bound))
    }
    /// Describes an object with only a shape.
    pub fn shape(shape: &'a Shape) -> Self {
        Description::new(None, None).collides_as(shape)
    }
    /// Gives the object a shape: rays, casts and contacts use it in place of its mesh or bound. Half-spaces, and compounds
    /// that contain some, are infinite ground. The object's transform scales the shape.
    pub fn collides_as(self, shape: &'a Shape) -> Self {
        Description { shape: Some(shape), ..self }
    }
    /// Places the object under this node.
    pub fn under(self, node: Node) -> Self {
        Description { node: Some(node), ..self }
    }
    /// Sets the transform of the mesh or the shape, to its node or to the world.
    pub fn at(self, transform: Transform) -> Self {
        Description { transform: Some(transform), ..self }
    }
    /// Sets a number that is returned with every answer.
    pub fn user(self, user: u64) -> Self {
        Description { user, ..self }
    }
    /// Sets the layers that the object is in; the default is all.
    pub fn layers(self, layers: u32) -> Self {
        Description { layers, ..self }
    }
    /// Sets the layers that the object collides with; the default is all.
    pub fn collides_with(self, layers: u32) -> Self {
        Description { collides_with: layers, ..self }
    }
    /// Makes the object's mesh only hide others: no answer contains the object.
    pub fn only_occludes(self) -> Self {
        Description { only_occludes: true, ..self }
    }
    /// Makes no answer contain the object until [`World::set_hidden`].
    pub fn hidden(self) -> Self {
        Description { hidden: true, ..self }
    }
    /// Makes the object hide no others.
    pub fn transparent(self) -> Self {
        Description { occludes: false, ..self }
    }
}
