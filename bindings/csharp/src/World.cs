// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;
using System.Threading;

namespace Crofton {
    /// <summary>An object of a World: an index, which is reused after removal, and a generation, which tells apart those that have used it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectHandle : IEquatable<ObjectHandle> {
        public uint Index, Generation;
        public bool Equals(ObjectHandle other) { return Index == other.Index && Generation == other.Generation; }
        public override bool Equals(object other) { return other is ObjectHandle && Equals((ObjectHandle)other); }
        public override int GetHashCode() { return (int)(Index ^ (Generation << 24)); }
        public override string ToString() { return Index + "." + Generation; }
    }
    /// <summary>A node of a World. Moving it moves all nodes and objects below it.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct NodeHandle { public uint Index, Generation; }
    /// <summary>A mesh of a World.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshHandle { public uint Index, Generation; }

    /// <summary>An object and its user number.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectRef {
        public ObjectHandle Object;
        public ulong User;
    }

    /// <summary>The bound of an object without a mesh, in world coordinates.</summary>
    public struct Bound {
        internal Native.BoundData Data;
        /// <summary>An oriented box.</summary>
        public static Bound Box(Obb box) { return new Bound { Data = new Native.BoundData { Kind = 1, Box = box } }; }
        /// <summary>A box along the axes, by its minimum and maximum corners.</summary>
        public static Bound Aligned(Vector3 min, Vector3 max) {
            return new Bound { Data = new Native.BoundData { Kind = 2, Min = min, Max = max } };
        }
        /// <summary>A sphere.</summary>
        public static Bound Sphere(Vector3 center, double radius) {
            return new Bound { Data = new Native.BoundData { Kind = 3, Center = center, Radius = radius } };
        }
    }

    /// <summary>Options of a World.</summary>
    public sealed class WorldOptions {
        /// <summary>Updates find pairs and contacts; false: neither.</summary>
        public bool Pairs = true;
        /// <summary>False: updates find pairs only.</summary>
        public bool Contacts = true;
        /// <summary>An object inside a closed mesh counts as a contact.</summary>
        public bool Containment = true;
        /// <summary>Computes depths of contacts between meshes; takes longer than finding them.</summary>
        public bool MeshDepth = false;
        /// <summary>An update with more pairs fails.</summary>
        public ulong MaxPairs = 1ul << 24;
        /// <summary>Gaps up to this between shapes are contacts.</summary>
        public double ContactMargin;
        /// <summary>Updates without motion after which an object rests again.</summary>
        public uint UpdatesToRest = 16;
        /// <summary>Items' worth of background work on the tree in each update; 0: none, and no allocation; the default: as many as are good.</summary>
        public ulong RebuildBudget = ulong.MaxValue;
    }

    /// <summary>How World.FindOccluders searches.</summary>
    public sealed class FindOptions {
        /// <summary>Back faces are drawn as well.</summary>
        public bool IsTwoSided;
        /// <summary>0: the library's choice.</summary>
        public uint MaxOccluders;
        /// <summary>Not 0: takes a level of many small pieces as surfaces of so many triangles, say 48.</summary>
        public uint LevelTriangles;
    }

    /// <summary>As of the last update.</summary>
    public struct Statistics {
        /// <summary>All objects; those at rest and those that move, hidden ones not counted.</summary>
        public ulong Objects, Resting, Moving;
        /// <summary>Boxes that the last update changed.</summary>
        public uint BoxesChanged;
        /// <summary>Objects whose product of transforms is out of range: hidden until it is valid.</summary>
        public uint OutOfRange;
        /// <summary>Pairs of boxes that the last update tested, and those whose shapes or triangles it tested.</summary>
        public ulong BoxPairsTested, ContactPairsTested;
        /// <summary>Objects of regions whose occluders are not placed yet; they hide nothing until then.</summary>
        public ulong OccludersWaiting;
    }

    /// <summary>Holds a game's objects and answers queries about them. Changes take effect in Update, once a frame; queries answer as
    /// of the last one. Many threads may query at once; a change at the same time is an error (Busy).</summary>
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
            data.MeshDepth = Flag(options.MeshDepth);
            data.MaxPairs = options.MaxPairs;
            data.ContactMargin = options.ContactMargin;
            data.UpdatesToRest = options.UpdatesToRest;
            data.RebuildBudget = options.RebuildBudget;
            Library.Check(Native.crofton_world_create(ref data, out Handle));
        }
        /// <summary>Frees the world; any later call throws ObjectDisposedException.</summary>
        public void Dispose() { Change(Handle.Dispose); }

        /// <summary>Adds a mesh in its own frame: x, y, z of each vertex; three indices per triangle, counter-clockwise seen
        /// from outside, or null if each three vertices are a triangle. Copies both. With clusters, views with a picture list the mesh's
        /// triangles; oneSided: back faces are not drawn; precut: its clusters, cut before. Without triangles, queries and contacts test
        /// the mesh's box only, which saves memory and time.</summary>
        public MeshHandle AddMesh(float[] positions, uint[] indices, bool clusters = false, bool oneSided = false, ClusteredMesh precut = null, bool triangles = true) {
            MeshHandle mesh = default(MeshHandle);
            WithMesh(positions, indices, clusters, oneSided, precut, triangles, data => Native.crofton_world_add_mesh(Handle, ref data, out mesh));
            return mesh;
        }
        /// <summary>Replaces a mesh in all objects that use it. The rest as in AddMesh.</summary>
        public void ReplaceMesh(MeshHandle mesh, float[] positions, uint[] indices, bool clusters = false, bool oneSided = false, ClusteredMesh precut = null, bool triangles = true) {
            WithMesh(positions, indices, clusters, oneSided, precut, triangles, data => Native.crofton_world_replace_mesh(Handle, mesh, ref data));
        }
        /// <summary>Moves the vertices of a mesh that deforms: as many as before.</summary>
        public void SetVertices(MeshHandle mesh, float[] positions) {
            WithMesh(positions, null, false, false, null, true, data => Native.crofton_world_set_vertices(Handle, mesh, ref data));
        }
        /// <summary>Removes a mesh. Error: objects use it.</summary>
        public void RemoveMesh(MeshHandle mesh) { Library.Check(Native.crofton_world_remove_mesh(Handle, mesh)); }

        /// <summary>Adds a node. Objects below have only those of their layers that are also in its layers.</summary>
        public NodeHandle AddNode(NodeHandle? parent, Transform transform, uint layers = AllLayers) {
            NodeHandle node;
            Library.Check(Native.crofton_world_add_node(Handle, ToArray(parent), ref transform, layers, out node));
            return node;
        }
        /// <summary>Removes the node with all nodes and objects below it.</summary>
        public void RemoveNode(NodeHandle node) { Library.Check(Native.crofton_world_remove_node(Handle, node)); }
        /// <summary>Moves the node below another. Error: the parent is the node itself or one below it.</summary>
        public void SetParent(NodeHandle node, NodeHandle? parent) {
            Library.Check(Native.crofton_world_set_parent(Handle, node, ToArray(parent)));
        }
        /// <summary>Sets the node's layers. Objects below have only those of their layers that are also in these.</summary>
        public void SetNodeLayers(NodeHandle node, uint layers) { Library.Check(Native.crofton_world_set_node_layers(Handle, node, layers)); }
        /// <summary>Applies all valid items and leaves the others unchanged; the exception names the first invalid one.</summary>
        public void SetNodeTransforms(NodeHandle[] nodes, Transform[] transforms) {
            var count = Library.SameLength(nodes, transforms);
            Library.Check(Native.crofton_world_set_node_transforms(Handle, nodes, UIntPtr.Zero, transforms, UIntPtr.Zero, count));
        }

        /// <summary>Adds an object with a mesh, under a node or in the world; `user` is returned with every answer. onlyOccludes: no answer contains
        /// the object, but its occluders hide others; without occludes it hides none. hidden: no answer contains it until SetHidden shows it.</summary>
        public ObjectHandle Add(MeshHandle mesh, Transform transform, ulong user = 0, NodeHandle? node = null,
                                uint layers = AllLayers, uint collidesWith = AllLayers, bool onlyOccludes = false, bool occludes = true, bool hidden = false) {
            var data = Describe(user, layers, collidesWith, hidden);
            data.HasMesh = 1;
            data.OnlyOccludes = Flag(onlyOccludes);
            data.Occludes = Flag(occludes);
            data.Mesh = mesh;
            data.HasNode = Flag(node.HasValue);
            data.Node = node.GetValueOrDefault();
            return Add(data, transform, (ref Native.ObjectData d, IntPtr p) => d.Transform = p);
        }
        /// <summary>Adds an object with only a bound.</summary>
        public ObjectHandle Add(Bound bound, ulong user = 0, uint layers = AllLayers, uint collidesWith = AllLayers, bool hidden = false) {
            return Add(Describe(user, layers, collidesWith, hidden), bound.Data, (ref Native.ObjectData d, IntPtr p) => d.Bound = p);
        }
        /// <summary>Adds many objects with only bounds; objects[i] becomes the handle of bounds[i]. Adds all valid ones: the exception names the
        /// first of the others, whose handles are stale from the start. users: a number for each, or null.</summary>
        public void AddMany(Bound[] bounds, ObjectHandle[] objects, ulong[] users = null, uint layers = AllLayers, uint collidesWith = AllLayers) {
            Library.NotNull(bounds, "bounds");
            AddMany(Array.ConvertAll(bounds, b => b.Data), objects, users, layers, collidesWith, (ref Native.ObjectData d, IntPtr p) => d.Bound = p);
        }
        /// <summary>Adds many objects with one mesh. The rest as for bounds.</summary>
        public void AddMany(MeshHandle mesh, Transform[] transforms, ObjectHandle[] objects, ulong[] users = null, uint layers = AllLayers,
                            uint collidesWith = AllLayers) {
            AddMany(transforms, objects, users, layers, collidesWith, (ref Native.ObjectData d, IntPtr p) => {
                d.HasMesh = 1;
                d.Mesh = mesh;
                d.Transform = p;
            });
        }
        void AddMany<T>(T[] parts, ObjectHandle[] objects, ulong[] users, uint layers, uint collidesWith, Put put) where T : struct {
            UIntPtr count = Library.SameLength(parts, objects);
            if (users != null) Library.SameLength(parts, users);
            using (var memory = new Copies()) {
                long first = memory.Pinned(parts).ToInt64();
                int size = Marshal.SizeOf(typeof(T));
                Native.ObjectData data = Describe(0, layers, collidesWith);
                var all = new Native.ObjectData[parts.Length];
                for (int i = 0; i < all.Length; ++i) {
                    if (users != null) data.User = users[i];
                    put(ref data, new IntPtr(first + (long)i * size));
                    all[i] = data;
                }
                Library.Check(Native.crofton_world_add_many(Handle, all, count, objects));
            }
        }
        /// <summary>Takes memory for so many objects in all, so that no later call has to copy what the world knows of each.</summary>
        public void Reserve(int objects) {
            if (objects < 0) throw new ArgumentOutOfRangeException("objects");
            Library.Check(Native.crofton_world_reserve(Handle, (UIntPtr)objects));
        }
        /// <summary>Removes an object; its handle becomes stale.</summary>
        public void Remove(ObjectHandle handle) { Library.Check(Native.crofton_world_remove(Handle, handle)); }
        /// <summary>Moves objects with meshes or only shapes. Applies all valid items; the exception names the first invalid one.</summary>
        public void SetTransforms(ObjectHandle[] objects, Transform[] transforms) {
            var count = Library.SameLength(objects, transforms);
            Library.Check(Native.crofton_world_set_transforms(Handle, objects, UIntPtr.Zero, transforms, UIntPtr.Zero, count));
        }
        /// <summary>Moves objects that were added with a bound; it becomes a box. Errors as in SetTransforms.</summary>
        public void SetBoxes(ObjectHandle[] objects, Obb[] boxes) {
            var count = Library.SameLength(objects, boxes);
            Library.Check(Native.crofton_world_set_boxes(Handle, objects, UIntPtr.Zero, boxes, UIntPtr.Zero, count));
        }
        /// <summary>Sets the bound of an object that was added with one.</summary>
        public void SetBound(ObjectHandle handle, Bound bound) {
            using (var memory = new Copies()) {
                IntPtr copy = memory.Copied(bound.Data);
                Set(handle, Native.SetBound, (ref Native.ObjectData d) => d.Bound = copy);
            }
        }
        /// <summary>Sets the mesh of an object that has one.</summary>
        public void SetMesh(ObjectHandle handle, MeshHandle mesh) {
            Set(handle, Native.SetMesh, (ref Native.ObjectData d) => { d.HasMesh = 1; d.Mesh = mesh; });
        }
        /// <summary>Hides or shows an object; no answer contains a hidden one.</summary>
        public void SetHidden(ObjectHandle handle, bool hidden) {
            Set(handle, Native.SetHidden, (ref Native.ObjectData d) => d.Hidden = Flag(hidden));
        }
        /// <summary>Sets the layers that the object is in.</summary>
        public void SetLayers(ObjectHandle handle, uint layers) {
            Set(handle, Native.SetLayers, (ref Native.ObjectData d) => d.Layers = layers);
        }
        /// <summary>Sets the layers that the object collides with.</summary>
        public void SetCollidesWith(ObjectHandle handle, uint layers) {
            Set(handle, Native.SetCollidesWith, (ref Native.ObjectData d) => d.CollidesWith = layers);
        }
        /// <summary>Sets the number that answers return with the object.</summary>
        public void SetUser(ObjectHandle handle, ulong user) {
            Set(handle, Native.SetUser, (ref Native.ObjectData d) => d.User = user);
        }
        /// <summary>Searches a mesh for occluders, which the next update applies. Takes a second or more for 100,000 triangles.</summary>
        public void FindOccluders(MeshHandle mesh, FindOptions options = null) {
            Native.FindOptionsData data = Native.crofton_default_find_options();
            if (options != null) {
                data.IsTwoSided = Flag(options.IsTwoSided);
                if (options.MaxOccluders != 0) data.MaxOccluders = options.MaxOccluders;
                if (options.LevelTriangles != 0) data.LevelTriangles = options.LevelTriangles;
            }
            Library.Check(Native.crofton_world_find_occluders(Handle, mesh, ref data));
        }
        /// <summary>Returns the number of a mesh's occluders.</summary>
        public int OccluderCount(MeshHandle mesh) {
            return (int)Info(mesh).OccluderCount;
        }
        /// <summary>Sets whether an object with a mesh hides others. The default is true; use false for transparent objects.</summary>
        public void SetOccludes(ObjectHandle handle, bool occludes) {
            Set(handle, Native.SetOccludes, (ref Native.ObjectData d) => d.Occludes = Flag(occludes));
        }

        /// <summary>Applies the changes and finds pairs and contacts. Call it once a frame. Error: more than MaxPairs pairs; all
        /// pairs are dropped, everything else is up to date.</summary>
        public void Update() { Update(1); }
        /// <summary>Does the same on several threads of the thread pool, with the same result.</summary>
        public void Update(int threads) { Change(() => Jobs.With(threads, jobs => Library.Check(Native.crofton_world_update(Handle, jobs)))); }

        /// <summary>Returns the statistics of the last update.</summary>
        public Statistics Statistics() {
            Native.WorldStatisticsData data = StatisticsData();
            return new Statistics {
                Objects = data.Objects, Resting = data.Resting, Moving = data.Moving, BoxesChanged = data.BoxesChanged, OutOfRange = data.OutOfRange,
                BoxPairsTested = data.BoxPairsTested, ContactPairsTested = data.ContactPairsTested, OccludersWaiting = data.OccludersWaiting
            };
        }
        /// <summary>The number of objects.</summary>
        public int Count { get { return (int)StatisticsData().ObjectCount; } }
        Native.WorldStatisticsData StatisticsData() {
            var data = new Native.WorldStatisticsData { Size = Native.SizeOf<Native.WorldStatisticsData>() };
            Library.Check(Native.crofton_world_get_statistics(Handle, ref data));
            return data;
        }
        /// <summary>Tests whether the world contains the object.</summary>
        public bool Contains(ObjectHandle handle) {
            var info = new Native.ObjectInfo { Size = Native.SizeOf<Native.ObjectInfo>() };
            int status = Native.crofton_world_get_object(Handle, handle, ref info);
            if (status != (int)Status.StaleHandle) Library.Check(status);
            return status == 0;
        }
        /// <summary>Tests whether the world contains the node.</summary>
        public bool Contains(NodeHandle node) {
            int contains;
            Library.Check(Native.crofton_world_contains_node(Handle, node, out contains));
            return contains != 0;
        }
        /// <summary>Tests whether the world contains the mesh.</summary>
        public bool Contains(MeshHandle mesh) {
            var info = new Native.MeshInfo { Size = Native.SizeOf<Native.MeshInfo>() };
            int status = Native.crofton_world_get_mesh(Handle, mesh, ref info);
            if (status != (int)Status.StaleHandle) Library.Check(status);
            return status == 0;
        }
        /// <summary>Returns the object's user number.</summary>
        public ulong User(ObjectHandle handle) { return Info(handle).User; }
        /// <summary>Returns the object's box. Error: there was no update since the object was added.</summary>
        public Obb Box(ObjectHandle handle) {
            Native.ObjectInfo info = Info(handle);
            if (info.HasBox == 0) throw new CroftonException(Status.Empty, "the object has no box before the next update", handle.Index);
            return info.Box;
        }
        /// <summary>Returns the transform of an object with a mesh, to the world.</summary>
        public Transform TransformOf(ObjectHandle handle) {
            Native.ObjectInfo info = Info(handle);
            if (info.HasTransform == 0)
                throw new CroftonException(Status.Empty, "the object is a bound, or there was no update since it was added", handle.Index);
            return info.Transform;
        }
        /// <summary>Returns the clusters of a mesh, as of the last update; null if it has none.</summary>
        public Clusters ClustersOf(MeshHandle mesh) {
            return Read(() => {
                Native.MeshInfo info = Info(mesh);
                return info.Clusters.ClusterCount == UIntPtr.Zero ? null : ClusteredMesh.Of(info.Clusters);
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

        // Reading a view's objects, pairs or contacts takes two calls on the world's memory. This lock keeps updates and
        // the world's end from coming between them.
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
        static Native.ObjectData Describe(ulong user, uint layers, uint collidesWith, bool hidden = false) {
            Native.ObjectData data = Native.crofton_default_object_description();
            data.User = user;
            data.Layers = layers;
            data.CollidesWith = collidesWith;
            data.Hidden = Flag(hidden);
            return data;
        }

        delegate void Put(ref Native.ObjectData data, IntPtr pointer);
        ObjectHandle Add<T>(Native.ObjectData data, T part, Put put) where T : struct {
            using (var memory = new Copies()) {
                put(ref data, memory.Copied(part));
                ObjectHandle handle;
                Library.Check(Native.crofton_world_add(Handle, ref data, out handle));
                return handle;
            }
        }

        static void WithMesh(float[] positions, uint[] indices, bool clusters, bool oneSided, ClusteredMesh precut, bool triangles, Func<Native.MeshData, int> call) {
            using (var memory = new Copies())
                Library.Check(call(memory.Of(new RegionMesh {
                    Positions = positions, Indices = indices, Clusters = clusters, OneSided = oneSided, Precut = precut, Triangles = triangles
                })));
        }
    }
}
