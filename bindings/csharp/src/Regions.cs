// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>An object of a Region: a bound, or a mesh of the region's or a shape under a transform; relative to the region's origin.</summary>
    public struct RegionObject {
        internal Bound Bound;
        internal Shape Shape;
        internal bool OnlyOccludes, Occludes;
        internal int Mesh;
        internal Transform Transform;
        internal ulong User;
        internal uint Layers, CollidesWith;

        /// <summary>An object with only a bound; `user` is returned with every answer.</summary>
        public static RegionObject Of(Bound bound, ulong user = 0, uint layers = World.AllLayers, uint collidesWith = World.AllLayers) {
            return new RegionObject { Bound = bound, Mesh = -1, User = user, Layers = layers, CollidesWith = collidesWith };
        }
        /// <summary>An object with only a shape, not infinite ground.</summary>
        public static RegionObject Of(Shape shape, Transform transform, ulong user = 0, uint layers = World.AllLayers, uint collidesWith = World.AllLayers) {
            Library.NotNull(shape, "shape");
            return new RegionObject { Shape = shape, Mesh = -1, Transform = transform, User = user, Layers = layers, CollidesWith = collidesWith };
        }
        /// <summary>An object with the mesh at that place among the region's. onlyOccludes: it only hides others; without occludes
        /// it hides none.</summary>
        public static RegionObject Of(int mesh, Transform transform, ulong user = 0, uint layers = World.AllLayers, uint collidesWith = World.AllLayers, bool onlyOccludes = false,
                                      bool occludes = true) {
            if (mesh < 0) throw new ArgumentOutOfRangeException("mesh");
            return new RegionObject { Mesh = mesh, Transform = transform, User = user, Layers = layers, CollidesWith = collidesWith, OnlyOccludes = onlyOccludes, Occludes = occludes };
        }
    }

    /// <summary>A mesh that objects of a Region share: x, y, z of each vertex; three indices per triangle.</summary>
    public sealed class RegionMesh {
        public float[] Positions;
        public uint[] Indices;
        /// <summary>Views with a picture list the mesh's triangles. OneSided: back faces are not drawn.</summary>
        public bool Clusters, OneSided;
        /// <summary>With Clusters: those of this mesh, cut before.</summary>
        public ClusteredMesh Precut;
        /// <summary>False: queries and contacts test the mesh's box only, which saves memory and time.</summary>
        public bool Triangles = true;
    }

    /// <summary>Many objects that do not move. Prepare it on any thread and attach it to a World, where that takes microseconds.</summary>
    public sealed partial class Region : IDisposable {
        internal readonly RegionHandle Handle;

        /// <summary>Prepares a region. If an object or a mesh is refused, the exception's Item is its place. With findOccluders, searches
        /// the meshes for occluders, as World.FindOccluders does. With meshes or shapes no coordinate of an origin may be larger than maxOrigin.</summary>
        public Region(RegionObject[] objects, RegionMesh[] meshes = null, bool findOccluders = false, double maxOrigin = 1e9) {
            Library.NotNull(objects, "objects");
            Library.Load();
            using (var memory = new Copies()) {
                var transforms = new Transform[objects.Length];
                IntPtr first = memory.Pinned(transforms);
                var data = new Native.RegionObjectData[objects.Length];
                for (int i = 0; i < data.Length; ++i) {
                    RegionObject given = objects[i];
                    data[i] = Native.crofton_default_region_object();
                    data[i].User = given.User;
                    data[i].Layers = given.Layers;
                    data[i].CollidesWith = given.CollidesWith;
                    if (given.Mesh < 0 && given.Shape == null) {
                        data[i].Bound = given.Bound.Data;
                        continue;
                    }
                    if (given.Mesh >= 0) data[i].Mesh = (uint)given.Mesh;
                    else data[i].Shape = memory.Held(given.Shape.Handle);
                    data[i].OnlyOccludes = given.OnlyOccludes ? 1u : 0u;
                    if (given.Mesh >= 0) data[i].Occludes = given.Occludes ? 1u : 0u;
                    transforms[i] = given.Transform;
                    data[i].Transform = new IntPtr(first.ToInt64() + (long)i * Marshal.SizeOf(typeof(Transform)));
                }
                meshes = meshes ?? new RegionMesh[0];
                var described = new Native.MeshData[meshes.Length];
                for (int i = 0; i < meshes.Length; ++i) {
                    Library.NotNull(meshes[i], "meshes");
                    Library.NotNull(meshes[i].Indices, "meshes");
                    described[i] = memory.Of(meshes[i]);
                }
                Native.RegionOptionsData options = Native.crofton_default_region_options();
                options.Meshes = memory.Pinned(described);
                options.MeshCount = (UIntPtr)described.Length;
                options.FindOccluders = findOccluders ? 1u : 0u;
                options.MaxOrigin = maxOrigin;
                Library.Check(Native.crofton_region_prepare(data, (UIntPtr)data.Length, ref options, IntPtr.Zero, out Handle));
            }
        }
        /// <summary>Frees the region; a World that it is attached to keeps what it needs.</summary>
        public void Dispose() { Handle.Dispose(); }

        /// <summary>Returns what the region holds.</summary>
        public RegionInfo Info() {
            var data = new Native.RegionInfoData { Size = Native.SizeOf<Native.RegionInfoData>() };
            Library.Check(Native.crofton_region_get_info(Handle, ref data));
            return new RegionInfo { ObjectCount = data.ObjectCount, Bytes = data.Bytes, Min = data.Min, Max = data.Max };
        }
        /// <summary>Returns the mesh of the object at a place, as its number among the region's meshes or in the file; -1: it has none.</summary>
        public int MeshOf(int place) {
            uint mesh;
            Library.Check(Native.crofton_region_mesh_of(Handle, (uint)place, out mesh));
            return (int)mesh;
        }
        /// <summary>Returns the clusters of a mesh, to which a view's triangles refer; null: there is no such mesh, or it has none.</summary>
        public Clusters ClustersOf(int mesh) {
            using (var memory = new Copies()) {
                memory.Held(Handle);
                Native.ClustersData data;
                int status = Native.crofton_region_clusters_of(Handle, (uint)mesh, out data);
                if (status == (int)Status.Empty) return null;
                Library.Check(status);
                return ClusteredMesh.Of(data);
            }
        }
    }

    /// <summary>What a Region holds.</summary>
    public struct RegionInfo {
        /// <summary>The number of objects; bytes of memory, without those of occluders and clusters.</summary>
        public ulong ObjectCount, Bytes;
        /// <summary>A box around all objects, relative to the origin; Min is infinite without objects.</summary>
        public Vector3 Min, Max;
    }

    /// <summary>A Region that is attached to a World.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct AttachedRegion { public uint Index, Generation; }

    public sealed partial class World {
        /// <summary>Attaches a region: from the next update on, answers contain its objects, moved by the origin.</summary>
        public AttachedRegion Attach(Region region, Vector3 origin) {
            Library.NotNull(region, "region");
            AttachedRegion attached;
            Library.Check(Native.crofton_world_attach(Handle, region.Handle, ref origin, out attached));
            return attached;
        }
        /// <summary>Detaches a region. Handles of its objects are stale at once; views follow with the next update.</summary>
        public void Detach(AttachedRegion region) { Library.Check(Native.crofton_world_detach(Handle, region)); }
        /// <summary>Returns the object at a place in the array that the region was prepared from. SetHidden can hide it; other changes are errors.</summary>
        public ObjectHandle ObjectIn(AttachedRegion region, int place) {
            ObjectHandle handle;
            Library.Check(Native.crofton_world_object_in(Handle, region, (uint)place, out handle));
            return handle;
        }
        /// <summary>Returns the region of an object and its place there. Error: the object was added by Add.</summary>
        public AttachedRegion RegionOf(ObjectHandle handle, out int place) {
            AttachedRegion region;
            uint found;
            Library.Check(Native.crofton_world_place_of(Handle, handle, out region, out found));
            place = (int)found;
            return region;
        }
    }
}
