// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;
using System.Threading;

namespace Crofton {
    /// <summary>An object of a World: an index that is used again and a generation that tells its users apart.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectHandle : IEquatable<ObjectHandle> {
        public uint Index, Generation;
        public bool Equals(ObjectHandle other) { return Index == other.Index && Generation == other.Generation; }
        public override bool Equals(object other) { return other is ObjectHandle && Equals((ObjectHandle)other); }
        public override int GetHashCode() { return (int)(Index ^ (Generation << 24)); }
        public override string ToString() { return Index + "." + Generation; }
    }
    /// <summary>A node of a World: what moves it moves all below it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct NodeHandle { public uint Index, Generation; }
    /// <summary>A mesh of a World.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshHandle { public uint Index, Generation; }

    /// <summary>An object and the number that the caller gave it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectRef {
        public ObjectHandle Object;
        public ulong User;
    }

    /// <summary>The shape of an object without a mesh, in the world's coordinates.</summary>
    public struct Bound {
        internal Native.BoundData Data;
        /// <summary>An oriented box.</summary>
        public static Bound Box(Obb box) { return new Bound { Data = new Native.BoundData { Kind = 1, Box = box } }; }
        /// <summary>A box along the axes, by its least and greatest corners.</summary>
        public static Bound Aligned(Vector3 min, Vector3 max) {
            return new Bound { Data = new Native.BoundData { Kind = 2, Min = min, Max = max } };
        }
        /// <summary>A sphere.</summary>
        public static Bound Sphere(Vector3 center, double radius) {
            return new Bound { Data = new Native.BoundData { Kind = 3, Center = center, Radius = radius } };
        }
    }

    /// <summary>What a World looks for.</summary>
    public sealed class WorldOptions {
        /// <summary>Looks for pairs and contacts; false: for neither.</summary>
        public bool Pairs = true;
        /// <summary>False: pairs alone.</summary>
        public bool Contacts = true;
        /// <summary>An object inside a closed mesh touches it.</summary>
        public bool Containment = true;
        /// <summary>Contacts between meshes have a way out, which costs more.</summary>
        public bool SeparatingMotion = false;
        /// <summary>More are an error.</summary>
        public ulong MaxPairs = 1ul << 24;
    }

    /// <summary>An engine's objects, what they are and where. Changes take effect in Update, once a frame; answers are as of
    /// the last one. Questions may come from many threads at once; a change at the same time is an error (Busy).</summary>
    public sealed partial class World : IDisposable {
        /// <summary>All 32 layers.</summary>
        public const uint AllLayers = uint.MaxValue;
        internal readonly WorldHandle Handle;
        readonly ReaderWriterLockSlim updating = new ReaderWriterLockSlim();

        public World() : this(new WorldOptions()) { }
        public World(WorldOptions options) {
            Library.NotNull(options, "options");
            Library.Load();
            Native.WorldOptionsData data = Native.crofton_default_world_options();
            data.Pairs = Flag(options.Pairs);
            data.Contacts = Flag(options.Contacts);
            data.Containment = Flag(options.Containment);
            data.SeparatingMotion = Flag(options.SeparatingMotion);
            data.MaxPairs = options.MaxPairs;
            Library.Check(Native.crofton_world_create(ref data, out Handle));
        }
        /// <summary>Frees it; any later call throws ObjectDisposedException.</summary>
        public void Dispose() { Change(Handle.Dispose); }

        /// <summary>Adds a mesh in its own frame: x, y, z of each vertex; three indices a triangle, counter-clockwise seen from
        /// outside, or null where three vertices are one. Both are copied.</summary>
        public MeshHandle AddMesh(float[] positions, uint[] indices) { return AddMesh(positions, indices, false); }
        /// <summary>The same; with clusters, views with a picture list its triangles. oneSided: back faces are not drawn.</summary>
        public MeshHandle AddMesh(float[] positions, uint[] indices, bool clusters, bool oneSided = false) {
            MeshHandle mesh = default(MeshHandle);
            WithMesh(positions, indices, data => {
                data.Clusters = Flag(clusters);
                data.OneSided = Flag(oneSided);
                return Native.crofton_world_add_mesh(Handle, ref data, out mesh);
            });
            return mesh;
        }
        /// <summary>All objects with this mesh get the new one.</summary>
        public void ReplaceMesh(MeshHandle mesh, float[] positions, uint[] indices) {
            WithMesh(positions, indices, data => Native.crofton_world_replace_mesh(Handle, mesh, ref data));
        }
        /// <summary>For a mesh that deforms: as many vertices as before.</summary>
        public void SetVertices(MeshHandle mesh, float[] positions) {
            WithMesh(positions, null, data => Native.crofton_world_set_vertices(Handle, mesh, ref data));
        }
        /// <summary>An error while objects use it.</summary>
        public void RemoveMesh(MeshHandle mesh) { Library.Check(Native.crofton_world_remove_mesh(Handle, mesh)); }

        /// <summary>Adds a node; the layers limit those of all objects below.</summary>
        public NodeHandle AddNode(NodeHandle? parent, Transform transform, uint layers = AllLayers) {
            NodeHandle node;
            Library.Check(Native.crofton_world_add_node(Handle, ToArray(parent), ref transform, layers, out node));
            return node;
        }
        /// <summary>With all nodes and objects below it.</summary>
        public void RemoveNode(NodeHandle node) { Library.Check(Native.crofton_world_remove_node(Handle, node)); }
        /// <summary>An error where the parent is the node itself or one below it.</summary>
        public void SetParent(NodeHandle node, NodeHandle? parent) {
            Library.Check(Native.crofton_world_set_parent(Handle, node, ToArray(parent)));
        }
        /// <summary>Items that are refused stay as they are and all others change; the exception names the first.</summary>
        public void SetNodeTransforms(NodeHandle[] nodes, Transform[] transforms) {
            var count = Library.SameLength(nodes, transforms);
            Library.Check(Native.crofton_world_set_node_transforms(Handle, nodes, UIntPtr.Zero, transforms, UIntPtr.Zero, count));
        }

        /// <summary>Adds an object with a mesh, under a node or in the world; `user` is given back with every answer.</summary>
        public ObjectHandle Add(MeshHandle mesh, Transform transform, ulong user = 0, NodeHandle? node = null,
                                uint layers = AllLayers, uint collidesWith = AllLayers) {
            var data = Describe(user, layers, collidesWith);
            data.HasMesh = 1;
            data.Mesh = mesh;
            data.HasNode = Flag(node.HasValue);
            data.Node = node.GetValueOrDefault();
            return Add(data, transform, (ref Native.ObjectData d, IntPtr p) => d.Transform = p);
        }
        /// <summary>Adds an object that is a bound alone.</summary>
        public ObjectHandle Add(Bound bound, ulong user = 0, uint layers = AllLayers, uint collidesWith = AllLayers) {
            return Add(Describe(user, layers, collidesWith), bound.Data, (ref Native.ObjectData d, IntPtr p) => d.Bound = p);
        }
        /// <summary>Its handle is stale from now on.</summary>
        public void Remove(ObjectHandle handle) { Library.Check(Native.crofton_world_remove(Handle, handle)); }
        /// <summary>Of objects with a mesh. Refused items stay as they are; the exception names the first.</summary>
        public void SetTransforms(ObjectHandle[] objects, Transform[] transforms) {
            var count = Library.SameLength(objects, transforms);
            Library.Check(Native.crofton_world_set_transforms(Handle, objects, UIntPtr.Zero, transforms, UIntPtr.Zero, count));
        }
        /// <summary>Of objects that were added with a bound, which becomes a box. Refused items as in SetTransforms.</summary>
        public void SetBoxes(ObjectHandle[] objects, Obb[] boxes) {
            var count = Library.SameLength(objects, boxes);
            Library.Check(Native.crofton_world_set_boxes(Handle, objects, UIntPtr.Zero, boxes, UIntPtr.Zero, count));
        }
        /// <summary>Of an object that was added with a bound.</summary>
        public void SetBound(ObjectHandle handle, Bound bound) {
            IntPtr memory = Marshal.AllocHGlobal(Marshal.SizeOf(typeof(Native.BoundData)));
            try {
                Marshal.StructureToPtr(bound.Data, memory, false);
                Set(handle, Native.SetBound, (ref Native.ObjectData d) => d.Bound = memory);
            } finally {
                Marshal.FreeHGlobal(memory);
            }
        }
        /// <summary>Of an object that has a mesh.</summary>
        public void SetMesh(ObjectHandle handle, MeshHandle mesh) {
            Set(handle, Native.SetMesh, (ref Native.ObjectData d) => { d.HasMesh = 1; d.Mesh = mesh; });
        }
        /// <summary>A hidden object is in no answer until it is shown again.</summary>
        public void SetHidden(ObjectHandle handle, bool hidden) {
            Set(handle, Native.SetHidden, (ref Native.ObjectData d) => d.Hidden = Flag(hidden));
        }
        /// <summary>The layers that it is in.</summary>
        public void SetLayers(ObjectHandle handle, uint layers) {
            Set(handle, Native.SetLayers, (ref Native.ObjectData d) => d.Layers = layers);
        }
        /// <summary>The layers that it collides with.</summary>
        public void SetCollidesWith(ObjectHandle handle, uint layers) {
            Set(handle, Native.SetCollidesWith, (ref Native.ObjectData d) => d.CollidesWith = layers);
        }
        /// <summary>The number that answers give back.</summary>
        public void SetUser(ObjectHandle handle, ulong user) {
            Set(handle, Native.SetUser, (ref Native.ObjectData d) => d.User = user);
        }
        /// <summary>Looks for occluders in a mesh: a second or more for 100,000 triangles. They count from the next update on.</summary>
        public void FindOccluders(MeshHandle mesh) { Library.Check(Native.crofton_world_find_occluders(Handle, mesh, IntPtr.Zero)); }
        /// <summary>How many occluders a mesh has.</summary>
        public int OccluderCount(MeshHandle mesh) {
            return (int)Info(mesh).OccluderCount;
        }
        /// <summary>Whether an object with a mesh hides others, as at first, or not, as where it is drawn transparent.</summary>
        public void SetOccludes(ObjectHandle handle, bool occludes) {
            Set(handle, Native.SetOccludes, (ref Native.ObjectData d) => d.Occludes = Flag(occludes));
        }

        /// <summary>Makes the changes take effect; once a frame. An exception: more than MaxPairs pairs; then there are none, and
        /// all else is as it should be.</summary>
        public void Update() { Change(() => Library.Check(Native.crofton_world_update(Handle, IntPtr.Zero))); }

        /// <summary>How many objects there are.</summary>
        public int Count {
            get {
                var statistics = new Native.WorldStatisticsData { Size = Native.SizeOf<Native.WorldStatisticsData>() };
                Library.Check(Native.crofton_world_get_statistics(Handle, ref statistics));
                return (int)statistics.ObjectCount;
            }
        }
        /// <summary>Whether the handle is of an object that is still there.</summary>
        public bool Contains(ObjectHandle handle) {
            var info = new Native.ObjectInfo { Size = Native.SizeOf<Native.ObjectInfo>() };
            int status = Native.crofton_world_get_object(Handle, handle, ref info);
            if (status != (int)Status.StaleHandle) Library.Check(status);
            return status == 0;
        }
        /// <summary>The caller's number.</summary>
        public ulong User(ObjectHandle handle) { return Info(handle).User; }
        /// <summary>The object's box; an error before the first update after it was added.</summary>
        public Obb Box(ObjectHandle handle) {
            Native.ObjectInfo info = Info(handle);
            if (info.HasBox == 0) throw new CroftonException(Status.Empty, "the object has no box before the next update", handle.Index);
            return info.Box;
        }
        /// <summary>Of an object with a mesh: to the world's coordinates.</summary>
        public Transform TransformOf(ObjectHandle handle) {
            Native.ObjectInfo info = Info(handle);
            if (info.HasTransform == 0)
                throw new CroftonException(Status.Empty, "the object is a bound, or there was no update since it was added", handle.Index);
            return info.Transform;
        }
        /// <summary>How a mesh with clusters is cut, as of the last update; null where it is not.</summary>
        public Clusters ClustersOf(MeshHandle mesh) {
            return Read(() => {
                Native.MeshInfo info = Info(mesh);
                if (info.ClusterCount == UIntPtr.Zero) return null;
                return new Clusters {
                    All = Library.ToArray<Cluster>(info.Clusters, info.ClusterCount),
                    TriangleOrder = Library.ToArray<uint>(info.TriangleOrder, info.TriangleCount)
                };
            });
        }
        Native.ObjectInfo Info(ObjectHandle handle) {
            var info = new Native.ObjectInfo { Size = Native.SizeOf<Native.ObjectInfo>() };
            Library.Check(Native.crofton_world_get_object(Handle, handle, ref info));
            return info;
        }
        Native.MeshInfo Info(MeshHandle mesh) {
            var info = new Native.MeshInfo { Size = Native.SizeOf<Native.MeshInfo>() };
            Library.Check(Native.crofton_world_get_mesh(Handle, mesh, ref info));
            return info;
        }
        delegate void Fill(ref Native.ObjectData data);
        void Set(ObjectHandle handle, uint member, Fill fill) {
            Native.ObjectData data = Native.crofton_default_object_description();
            fill(ref data);
            Library.Check(Native.crofton_world_set(Handle, handle, member, ref data));
        }

        // What a view has found is looked up in the world, and pairs and contacts lie in its memory: no update and no end
        // of the world between the two calls that read them.
        T Read<T>(Func<T> read) {
            updating.EnterReadLock();
            try {
                var result = read();
                GC.KeepAlive(this);
                return result;
            } finally {
                updating.ExitReadLock();
            }
        }
        void Change(Action change) {
            updating.EnterWriteLock();
            try {
                change();
            } finally {
                updating.ExitWriteLock();
            }
        }

        static uint Flag(bool value) { return value ? 1u : 0u; }
        static NodeHandle[] ToArray(NodeHandle? node) { return node.HasValue ? new[] { node.Value } : null; }
        static Native.ObjectData Describe(ulong user, uint layers, uint collidesWith) {
            Native.ObjectData data = Native.crofton_default_object_description();
            data.User = user;
            data.Layers = layers;
            data.CollidesWith = collidesWith;
            return data;
        }

        delegate void Put(ref Native.ObjectData data, IntPtr pointer);
        ObjectHandle Add<T>(Native.ObjectData data, T part, Put put) where T : struct {
            IntPtr memory = Marshal.AllocHGlobal(Marshal.SizeOf(typeof(T)));
            try {
                Marshal.StructureToPtr(part, memory, false);
                put(ref data, memory);
                ObjectHandle handle;
                Library.Check(Native.crofton_world_add(Handle, ref data, out handle));
                return handle;
            } finally {
                Marshal.FreeHGlobal(memory);
            }
        }

        // The collector must not move the arrays during the call.
        void WithMesh(float[] positions, uint[] indices, Func<Native.MeshData, int> call) {
            Library.NotNull(positions, "positions");
            if (positions.Length % 3 != 0) throw new ArgumentException("positions are x, y, z of each vertex", "positions");
            if (indices != null && indices.Length == 0) throw new ArgumentException("there are none, so there is no triangle", "indices");
            var p = GCHandle.Alloc(positions, GCHandleType.Pinned);
            var i = indices == null ? default(GCHandle) : GCHandle.Alloc(indices, GCHandleType.Pinned);
            try {
                Native.MeshData data = Native.crofton_default_mesh_data();
                data.Positions = p.AddrOfPinnedObject();
                data.PositionCount = (UIntPtr)(positions.Length / 3);
                data.Indices = indices == null ? IntPtr.Zero : i.AddrOfPinnedObject();
                data.IndexCount = (UIntPtr)(indices == null ? 0 : indices.Length);
                Library.Check(call(data));
            } finally {
                p.Free();
                if (indices != null) i.Free();
            }
        }
    }
}
