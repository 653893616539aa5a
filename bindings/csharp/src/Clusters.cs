// SPDX-License-Identifier: MIT
using System;
using System.Linq;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>A group of neighbouring triangles: a range of Clusters.TriangleOrder.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Cluster {
        public uint FirstTriangle, TriangleCount;
    }

    /// <summary>Contains a cluster's triangles, in the mesh's coordinates. Its corners are the center plus or minus each of the three edges.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ClusterBox {
        public Float3 Center, HalfEdge0, HalfEdge1, HalfEdge2;
    }

    /// <summary>A mesh cut into clusters. Permute the index buffer that you draw by TriangleOrder: each cluster is then one range.</summary>
    public sealed class Clusters {
        public Cluster[] All;
        public uint[] TriangleOrder;

        /// <summary>Returns a mesh's indices in the order of its clusters.</summary>
        public uint[] Permute(uint[] indices) {
            Library.NotNull(indices, "indices");
            Library.NotNull(All, "All");
            Library.NotNull(TriangleOrder, "TriangleOrder");
            using (var memory = new Copies()) {
                var data = new Native.ClustersData {
                    Clusters = memory.Pinned(All), ClusterCount = (UIntPtr)All.Length, TriangleOrder = memory.Pinned(TriangleOrder),
                    TriangleCount = (UIntPtr)TriangleOrder.Length
                };
                var permuted = new uint[indices.Length];
                Library.Check(Native.crofton_permute_triangles(ref data, indices, (UIntPtr)indices.Length, permuted));
                return permuted;
            }
        }
    }

    /// <summary>The order of indices that are lent to a ClusteredMesh: by Clusters.Permute, or as the mesh was cut.</summary>
    public enum IndexOrder { Permuted = 0, Original = 1 }

    /// <summary>A cluster with triangles to draw: bit k of Triangles stands for triangle FirstTriangle + k of the cluster.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct VisibleCluster {
        public uint Object, Cluster;
        public ulong Triangles;
    }

    /// <summary>A mesh cut into clusters. A World takes it as `precut`; what uses it keeps what it needs.</summary>
    public sealed class ClusteredMesh : IDisposable {
        internal readonly ClusteredMeshHandle Handle;

        internal ClusteredMesh(ClusteredMeshHandle handle) { Handle = handle; }
        /// <summary>Cuts a mesh into clusters of up to maxTriangles, at most 64; 0 chooses by the size of the mesh.</summary>
        public ClusteredMesh(float[] positions, uint[] indices, uint maxTriangles = 0) {
            Library.Load();
            using (var memory = new Copies()) {
                Native.PlainMeshData data = memory.Of(positions, indices);
                Library.Check(Native.crofton_clustered_mesh_create(ref data, maxTriangles, out Handle));
            }
        }
        /// <summary>Makes an equal one of what ToBytes returned, without cutting again.</summary>
        public ClusteredMesh(byte[] bytes) {
            Library.NotNull(bytes, "bytes");
            Library.Load();
            Library.Check(Native.crofton_clustered_mesh_deserialise(bytes, (UIntPtr)bytes.Length, out Handle));
        }
        /// <summary>Frees the mesh; a World that was made of it keeps what it needs.</summary>
        public void Dispose() { Handle.Dispose(); }

        /// <summary>Reads your arrays from now on in place of copies, and pins them until the mesh is freed: it then needs a tenth to a seventh of their
        /// memory. Do not change them: views would be wrong. With permuted indices the order of triangles is released, too, and Clusters returns an
        /// empty one. Error: another mesh than was cut, with the index as Item; nothing has changed.</summary>
        public void Lend(float[] positions, uint[] indices, IndexOrder order = IndexOrder.Permuted) {
            var memory = new Copies();
            try {
                Native.PlainMeshData data = memory.Of(positions, indices);
                Library.Check(Native.crofton_clustered_mesh_lend(Handle, ref data, (uint)order));
            } catch {
                memory.Dispose();
                throw;
            }
            Handle.Keep(memory);
        }
        /// <summary>Returns a copy, to store; for machines of the same byte order.</summary>
        public byte[] ToBytes() {
            UIntPtr count;
            Library.Check(Native.crofton_clustered_mesh_serialise(Handle, null, UIntPtr.Zero, out count));
            var bytes = new byte[(int)count];
            Library.Check(Native.crofton_clustered_mesh_serialise(Handle, bytes, count, out count));
            return bytes;
        }
        /// <summary>Returns the clusters.</summary>
        public Clusters Clusters() {
            using (var memory = new Copies()) {
                memory.Held(Handle);
                Native.ClustersData data;
                Library.Check(Native.crofton_clustered_mesh_get(Handle, out data));
                return Of(data);
            }
        }
        /// <summary>Returns a box that contains the triangles of a cluster.</summary>
        public ClusterBox BoxOf(int cluster) {
            ClusterBox box;
            Library.Check(Native.crofton_clustered_mesh_box(Handle, new UIntPtr((ulong)cluster), out box));
            return box;
        }
        internal static Clusters Of(Native.ClustersData data) {
            return new Clusters {
                All = Library.ToArray<Cluster>(data.Clusters, data.ClusterCount),
                TriangleOrder = Library.ToArray<uint>(data.TriangleOrder, data.TriangleCount)
            };
        }
    }

    /// <summary>A mesh to be drawn.</summary>
    public sealed class DepthObject {
        public ClusteredMesh Mesh;
        /// <summary>Sixteen numbers, column by column; takes positions of the mesh to clip space, as the vertex shader does in float. If they are
        /// not finite, the whole object is listed and hides nothing.</summary>
        public float[] ToClip;
        /// <summary>Back faces are not drawn.</summary>
        public bool OneSided;
        /// <summary>False for alpha-tested and transparent objects: hides nothing.</summary>
        public bool Hides = true;
        /// <summary>By how much drawn vertices may be off, in units of the mesh, besides the rounding of ToClip times vertex.</summary>
        public float PositionError;
    }

    /// <summary>Where an object of a camera's picture lies in a light's shadow map.</summary>
    public sealed class DepthReceiver {
        /// <summary>That of the picture; may be null if nothing of the object was listed.</summary>
        public ClusteredMesh Mesh;
        /// <summary>Sixteen numbers, column by column; takes positions of the mesh to clip space of the map, as the shader does.</summary>
        public float[] ToMap;
        /// <summary>Anything within the mesh's bound may be seen, and not its triangles only.</summary>
        public bool Solid;
    }

    /// <summary>Finds the triangles of pictures, without a World. It keeps its buffers from picture to picture.</summary>
    public sealed class DepthCuller : IDisposable {
        readonly DepthCullerHandle handle;

        public DepthCuller() {
            Library.Load();
            Library.Check(Native.crofton_depth_culler_create(out handle));
        }
        /// <summary>Frees the buffers.</summary>
        public void Dispose() { handle.Dispose(); }

        /// <summary>Lists the triangles that the picture needs, by object, then by cluster. Drawn in the order in which you would draw all, they
        /// give the same picture, bit by bit. If an object is refused, the exception's Item is its place.</summary>
        public VisibleCluster[] FindVisible(DepthObject[] objects, PictureView picture) {
            using (var memory = new Copies()) {
                Native.DepthObjectData[] data = Of(objects, memory);
                Native.PictureData size = Of(picture);
                IntPtr clusters;
                UIntPtr count;
                Library.Check(Native.crofton_depth_culler_find_visible(handle, data, (UIntPtr)data.Length, ref size, IntPtr.Zero, out clusters, out count, IntPtr.Zero));
                return Library.ToArray<VisibleCluster>(clusters, count);
            }
        }
        /// <summary>Lists the triangles without which a shadow on what a camera sees would change. The casters' matrices take them to the
        /// shadow map. `seen` has found the camera's picture; there is one receiver for each object of that. radius: as in ShadowReceivers.</summary>
        public VisibleCluster[] FindCasters(DepthObject[] casters, PictureView map, DepthCuller seen, DepthReceiver[] receivers, double radius = 1) {
            Library.NotNull(seen, "seen");
            Library.NotNull(receivers, "receivers");
            using (var memory = new Copies()) {
                Native.DepthObjectData[] data = Of(casters, memory);
                Native.PictureData size = Of(map);
                Native.DepthReceiversData lookup = Native.crofton_default_depth_receivers();
                lookup.Seen = memory.Held(seen.handle);
                lookup.Objects = memory.CopiedAll(receivers.Select(given => {
                    Library.NotNull(given, "receivers");
                    return new Native.DepthReceiverData {
                        Mesh = given.Mesh == null ? IntPtr.Zero : memory.Held(given.Mesh.Handle), ToMap = Sixteen(given.ToMap, "ToMap"),
                        Solid = given.Solid ? 1u : 0u
                    };
                }).ToArray());
                lookup.ObjectCount = (UIntPtr)receivers.Length;
                lookup.Radius = radius;
                IntPtr clusters;
                UIntPtr count;
                Library.Check(Native.crofton_depth_culler_find_casters(handle, data, (UIntPtr)data.Length, ref size, ref lookup, IntPtr.Zero, out clusters, out count, IntPtr.Zero));
                return Library.ToArray<VisibleCluster>(clusters, count);
            }
        }
        /// <summary>Returns a lower bound of the nearness of the listed triangles at a pixel of the last picture: the depth, negated unless
        /// reversed, or minus infinity where nothing is proved to be. Row 0 is at the bottom.</summary>
        public float Nearness(uint x, uint y) {
            float nearness;
            Library.Check(Native.crofton_depth_culler_nearness(handle, x, y, out nearness));
            return nearness;
        }

        static Native.PictureData Of(PictureView picture) {
            Library.NotNull(picture, "picture");
            return picture.Data();
        }
        static float[] Sixteen(float[] matrix, string name) {
            if (matrix == null || matrix.Length != 16) throw new ArgumentException("a matrix has sixteen numbers", name);
            return matrix;
        }
        static Native.DepthObjectData[] Of(DepthObject[] objects, Copies memory) {
            Library.NotNull(objects, "objects");
            return objects.Select(given => {
                Library.NotNull(given, "objects");
                Library.NotNull(given.Mesh, "Mesh");
                Native.DepthObjectData data = Native.crofton_default_depth_object();
                data.Mesh = memory.Held(given.Mesh.Handle);
                data.ToClip = Sixteen(given.ToClip, "ToClip");
                data.OneSided = given.OneSided ? 1u : 0u;
                data.Hides = given.Hides ? 1u : 0u;
                data.PositionError = given.PositionError;
                return data;
            }).ToArray();
        }
    }
}
