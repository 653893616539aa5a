// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>The answer to a view. Reuse it from frame to frame.</summary>
    public sealed partial class ViewResult : IDisposable {
        internal readonly VisibleHandle Handle;
        ObjectRef[] objects = new ObjectRef[0];
        uint[] masks = new uint[0];

        public ViewResult() {
            Library.Load();
            Library.Check(Native.crofton_view_result_create(out Handle));
        }
        public void Dispose() { Handle.Dispose(); }

        /// <summary>The number of objects that the last view saw.</summary>
        public int Count { get; private set; }
        /// <summary>The objects and their user numbers, by index; only the first Count are of the last view.</summary>
        public ObjectRef[] Objects { get { return objects; } }

        /// <summary>After a view of several requests: bit v of each is set if view v sees the object.</summary>
        public uint[] ViewMasks { get { return masks; } }
        /// <summary>Indices of objects in the view's volume that are hidden; empty without OcclusionOptions.ListOccluded.</summary>
        public uint[] OccludedIds(int view = 0) {
            Native.ViewInfo info = Info(view);
            return Library.ToArray<uint>(info.OccludedIds, info.OccludedCount);
        }
        /// <summary>For a view with a Picture: the triangles to draw, by object, then by cluster (World.ClustersOf).</summary>
        public VisibleCluster[] Triangles(int view = 0) {
            Native.ViewInfo info = Info(view);
            return Library.ToArray<VisibleCluster>(info.Triangles, info.TriangleClusterCount);
        }
        /// <summary>Copies the depth buffer of a view. Error: it had no occlusion.</summary>
        public DepthBuffer Depth(int view = 0) {
            Native.ViewInfo info = Info(view);
            var nearness = new float[info.DepthWidth * info.DepthHeight];
            Library.Check(Native.crofton_view_result_depth(Handle, (UIntPtr)view, nearness, (UIntPtr)nearness.Length));
            return new DepthBuffer { Width = (int)info.DepthWidth, Height = (int)info.DepthHeight, Nearness = nearness };
        }
        Native.ViewInfo Info(int view) {
            var info = new Native.ViewInfo { Size = Native.SizeOf<Native.ViewInfo>() };
            Library.Check(Native.crofton_view_result_get_view(Handle, (UIntPtr)view, ref info));
            return info;
        }

        internal int Read(World world) {
            IntPtr ids;
            UIntPtr count;
            Library.Check(Native.crofton_view_result_ids(Handle, out ids, out count, IntPtr.Zero, IntPtr.Zero));
            var listed = objects.Length < (int)count ? new ObjectRef[(int)count + (int)count / 2] : objects;
            var seenBy = masks.Length < listed.Length ? new uint[listed.Length] : masks;
            Library.Check(Native.crofton_view_result_list(Handle, world.Handle, UIntPtr.Zero, listed, seenBy, count));
            objects = listed;
            masks = seenBy;
            return Count = (int)count;
        }
    }

    /// <summary>Where a ray hits an object.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectHit {
        public ObjectHandle Object;
        public ulong User;
        /// <summary>The parameter along the ray.</summary>
        public double T;
        public Vector3 Point;
        uint triangle;
        /// <summary>The child of a compound shape; else 0.</summary>
        public uint Child;
        /// <summary>The surface's unit normal, towards the ray's origin; 0 if the ray began inside.</summary>
        public Vector3 Normal;
        byte startedInside;
        /// <summary>True if the ray began in the shape, box or sphere; T is then 0.</summary>
        public bool StartedInside { get { return startedInside != 0; } }
        /// <summary>True if the ray hits anything; otherwise the other members are meaningless.</summary>
        public bool IsHit { get { return Object.Index != uint.MaxValue; } }
        /// <summary>The triangle of the object's mesh or its shape's surface.</summary>
        public uint? Triangle { get { return triangle == uint.MaxValue ? (uint?)null : triangle; } }
    }

    /// <summary>The object nearest to a shape.</summary>
    public struct Closest {
        public ObjectHandle Object;
        public ulong User;
        public double Distance;
        public Vector3 OnShape, OnObject;
        /// <summary>At OnObject: the triangle of the object's mesh or its shape's surface, uint.MaxValue where there is none; the child of a compound.</summary>
        public uint Triangle, Child;
    }

    /// <summary>Two objects whose boxes or spheres overlap; First has the lower index.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectPair { public ObjectRef First, Second; }

    /// <summary>The phase of a contact: it began in this update, began in an earlier one, or has ended.</summary>
    public enum Phase : uint { Began = 0, Stayed = 1, Ended = 2 }

    /// <summary>Which of two objects lies inside the other, if their surfaces do not overlap; Partly: some pieces of a mesh do.</summary>
    public enum Containment : byte { Nothing = 0, FirstInside = 1, SecondInside = 2, Partly = 3 }

    /// <summary>A contact point, midway between the surfaces, and its depth.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ContactPoint {
        public Vector3 Position;
        public double Depth;
    }

    /// <summary>The contact of two triangles: the ends of their common segment, and the unit normal of the second.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshContact {
        public uint FirstTriangle, SecondTriangle;
        public Vector3 Begin, End, Normal;
    }

    /// <summary>A vertex (Kind 0), an edge (1) or a face (2) of a shape, by its number.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Feature {
        public byte Kind;
        byte unused;
        public ushort Index;
    }

    /// <summary>Four numbers of yours.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Float4 { public float X, Y, Z, W; }

    /// <summary>A contact point of two shapes, for a physics engine. Features and parts are its id, which stays the same while the same features touch.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct TrackedPoint {
        /// <summary>Midway between the surfaces, in the world.</summary>
        public Vector3 Position;
        /// <summary>Along the normal; negative: a gap.</summary>
        public double Depth;
        public Feature OnA, OnB;
        public Part PartA, PartB;
        /// <summary>Unit, from first to second.</summary>
        public Vector3 Normal;
        byte began, unused0, unused1, unused2;
        /// <summary>Yours: 0 when the point begins, kept while it stays; World.SetMemories writes it.</summary>
        public Float4 Memory;
        /// <summary>True if no point of the last update has its id.</summary>
        public bool Began { get { return began != 0; } }
    }

    /// <summary>Two objects that touch, or that have ended touching in this update.</summary>
    public sealed class Contact {
        public ObjectRef First, Second;
        public Phase Phase;
        /// <summary>Whether one object lies inside the other.</summary>
        public Containment Inside;
        /// <summary>Unit, from first to second; 0 if no direction is known.</summary>
        public Vector3 Normal;
        /// <summary>Moving the second by Depth * Normal ends the contact; between meshes it is the deepest point's depth unless MeshDepth is set.</summary>
        public double Depth;
        public ContactPoint[] Points;
        public MeshContact[] Triangles;
        /// <summary>For two shapes.</summary>
        public TrackedPoint[] ShapePoints;
    }

    /// <summary>Options of occlusion culling.</summary>
    public sealed class OcclusionOptions {
        /// <summary>The size of the depth buffer in pixels.</summary>
        public uint Width = 480, Height = 270;
        /// <summary>Draws at most this many occluders, those that hide most.</summary>
        public uint MaxOccluders = 256;
        /// <summary>Does not draw occluders that cover a smaller part of the sphere of directions.</summary>
        public float LeastCover = 2e-5f;
        /// <summary>Also lists hidden objects: ViewResult.OccludedIds.</summary>
        public bool ListOccluded;

        internal Native.OcclusionOptionsData Data() {
            Native.OcclusionOptionsData data = Native.crofton_default_occlusion_options();
            data.Width = Width;
            data.Height = Height;
            data.MaxOccluders = MaxOccluders;
            data.LeastCover = LeastCover;
            data.ListOccluded = ListOccluded ? 1u : 0u;
            return data;
        }
    }

    /// <summary>Your engine's matrix, from positions relative to Origin to clip space, for column vectors.</summary>
    public sealed class ViewMatrix {
        /// <summary>Sixteen numbers, column by column unless IsRowMajor is set.</summary>
        public double[] ToClip;
        public bool IsRowMajor;
        public DepthRange Depth;
        public Vector3 Origin;
    }

    /// <summary>The picture that you draw.</summary>
    public sealed class PictureView {
        public uint Width = 1280, Height = 720;
        /// <summary>The depth range of the projection; with a ViewMatrix, the same as its.</summary>
        public DepthRange Depth;
        /// <summary>1 in each pixel, at its centre; 2, 4 or 8: for multisampling, at Vulkan's standard locations.</summary>
        public uint Samples = 1;
        /// <summary>0 for no limit. Otherwise a number of clusters that are tested and of triangles that are drawn, together; what is left after that is listed whole unless its box is hidden.</summary>
        public ulong WorkLimit;

        internal Native.PictureData Data() {
            Native.PictureData data = Native.crofton_default_picture_view();
            data.Width = Width;
            data.Height = Height;
            data.Depth = (uint)Depth;
            data.Samples = Samples;
            data.WorkLimit = WorkLimit;
            return data;
        }
    }

    /// <summary>What a camera sees, for the view of a light.</summary>
    public sealed class ShadowReceivers {
        /// <summary>The answer to the camera's view alone, which had a Picture; not the one that the light's answer goes to. It holds until an update changes something, or an object or a mesh is removed.</summary>
        public ViewResult Seen;
        /// <summary>0.5 to 1024: a lookup reads texels whose centres are at most this far from its point along each axis. 0.5 for the nearest texel, 1 for a bilinear comparison, r + 1 for one in each of (2 r + 1)² texels.</summary>
        public double Radius = 1;
    }

    /// <summary>Limits that leave out objects that are too small or too far away.</summary>
    public sealed class DrawLimits {
        /// <summary>The point that distances are measured from.</summary>
        public Vector3 Eye;
        /// <summary>Leaves out what is farther than this times its radius.</summary>
        public double MaxDistanceInRadii = double.PositiveInfinity;
        /// <summary>Leaves out what is smaller.</summary>
        public double LeastRadius;
        /// <summary>Leaves out what is farther than its layers' distances (32, or null), or than its own, by index (or null).</summary>
        public float[] LayerDistances, ItemDistances;
        /// <summary>Bit i % 64 of word i / 64 says whether the object with index i was drawn before; its limits are then Hysteresis times as long.</summary>
        public ulong[] DrawnBefore;
        public double Hysteresis = 1;

        /// <summary>Returns limits that leave out what is less than `pixels` wide in a picture pictureHeight pixels high.</summary>
        public static DrawLimits OfCamera(Camera camera, double pictureHeight, double pixels) {
            Library.NotNull(camera, "camera");
            Native.CameraData given = camera.Data();
            Native.DrawLimitsData data = Native.crofton_default_draw_limits();
            Library.Check(Native.crofton_draw_limits_of_camera(ref given, pictureHeight, pixels, ref data));
            return new DrawLimits { Eye = data.Eye, MaxDistanceInRadii = data.MaxDistanceInRadii, LeastRadius = data.LeastRadius };
        }
    }

    /// <summary>The request of a view.</summary>
    public sealed class ViewRequest {
        /// <summary>Set a camera,</summary>
        public Camera Camera;
        /// <summary>your engine's matrix,</summary>
        public ViewMatrix Matrix;
        /// <summary>or any convex volume. For occlusion also set a camera; objects are then tested against the volume instead of its frustum.</summary>
        public Frustum Volume;
        /// <summary>Lists objects that share a layer with these.</summary>
        public uint Layers = World.AllLayers;
        /// <summary>If set, leaves out objects that others hide.</summary>
        public OcclusionOptions Occlusion;
        /// <summary>If set, lists the triangles that this picture needs: ViewResult.Triangles. Use it instead of Occlusion.</summary>
        public PictureView Picture;
        /// <summary>If set, Picture is the shadow map of a light, and only the triangles are listed without which a shadow on what a camera sees would change.</summary>
        public ShadowReceivers Receivers;
        /// <summary>If set, leaves out objects that are too small or too far away.</summary>
        public DrawLimits Limits;
        /// <summary>If set, bit i % 64 of word i / 64 says whether the object with index i may be seen. Objects that have moved since their first update may always be seen.</summary>
        public ulong[] CandidateMask;
        /// <summary>Tests planes only, which keeps some boxes near the volume's corners.</summary>
        public bool Conservative;
        /// <summary>Lists objects in the order of the tree in memory instead of by index; faster where much is seen.</summary>
        public bool TreeOrder;

        public static implicit operator ViewRequest(Camera camera) { return camera == null ? null : new ViewRequest { Camera = camera }; }
        public static implicit operator ViewRequest(Frustum volume) { return volume == null ? null : new ViewRequest { Volume = volume }; }
    }

    /// <summary>Limits rays, overlaps, nearest objects and casts to some of the objects. A layer mask converts to one.</summary>
    public sealed class QueryFilter {
        /// <summary>Finds objects that share a layer with this mask; all.</summary>
        public uint Layers = World.AllLayers;
        /// <summary>Finds none of these, for example the object that asks and what it carries; or null. Pass a few, and use layers for many.</summary>
        public ObjectHandle[] Ignored;

        /// <summary>Converts a layer mask.</summary>
        public static implicit operator QueryFilter(uint layers) { return new QueryFilter { Layers = layers }; }
    }

    public sealed partial class World {
        /// <summary>Lists the objects whose boxes a view sees, exactly: no visible box is left out. With Occlusion, also leaves
        /// out hidden objects. A Camera or a Frustum converts to a request for all layers.</summary>
        public void View(ViewRequest request, ViewResult visible) {
            Library.NotNull(request, "request");
            Library.NotNull(visible, "visible");
            using (var memory = new Copies()) {
                Native.ViewRequestData data = memory.Of(request);
                Read(() => {
                    Library.Check(Native.crofton_world_view(Handle, ref data, (UIntPtr)1, IntPtr.Zero, visible.Handle));
                    return visible.Read(this);
                });
            }
        }
        /// <summary>Answers up to 32 views, each with its own options. Lists each object once; ViewResult.ViewMasks says which views see it.</summary>
        public void View(ViewRequest[] requests, ViewResult visible) {
            Library.NotNull(requests, "requests");
            Library.NotNull(visible, "visible");
            using (var memory = new Copies()) {
                var data = new Native.ViewRequestData[requests.Length];
                for (int v = 0; v < data.Length; ++v) {
                    Library.NotNull(requests[v], "requests");
                    data[v] = memory.Of(requests[v]);
                }
                Read(() => {
                    Library.Check(Native.crofton_world_view(Handle, data, (UIntPtr)data.Length, IntPtr.Zero, visible.Handle));
                    return visible.Read(this);
                });
            }
        }

        /// <summary>Returns the nearest hit of a ray with triangles of meshes, boxes and spheres.</summary>
        public ObjectHit Raycast(Ray ray, QueryFilter filter = null) { return Raycast(new[] { ray }, filter)[0]; }
        /// <summary>Returns the nearest hit of each ray.</summary>
        public ObjectHit[] Raycast(Ray[] rays, QueryFilter filter = null) {
            Library.NotNull(rays, "rays");
            var hits = new ObjectHit[rays.Length];
            using (var memory = new Copies()) {
                var given = memory.Of(filter);
                Library.Check(Native.crofton_world_raycast(Handle, rays, (UIntPtr)rays.Length, ref given, hits));
            }
            return hits;
        }
        /// <summary>Tests whether the ray hits anything; faster than Raycast.</summary>
        public bool RaycastAny(Ray ray, QueryFilter filter = null) {
            int hit;
            using (var memory = new Copies()) {
                var given = memory.Of(filter);
                Library.Check(Native.crofton_world_raycast_any(Handle, ref ray, ref given, out hit));
            }
            return hit != 0;
        }
        /// <summary>Lists the nearest hit of each object that the ray hits, in order of T, then of index.</summary>
        public ObjectHit[] RaycastAll(Ray ray, QueryFilter filter = null) {
            using (var memory = new Copies())
            using (var found = Find()) {
                IntPtr hits;
                UIntPtr count;
                var given = memory.Of(filter);
                Library.Check(Native.crofton_world_raycast_all(Handle, ref ray, ref given, found));
                Library.Check(Native.crofton_found_hits(found, out hits, out count));
                return Library.ToArray<ObjectHit>(hits, count);
            }
        }

        /// <summary>The objects that overlap a box, by index: their shapes, triangles, spheres or boxes.</summary>
        public ObjectRef[] Overlap(Obb box, QueryFilter filter = null) {
            return Overlap(new Native.QueryShapeData { Kind = Native.QueryShapeBox, Box = box }, filter);
        }
        /// <summary>The objects that overlap a sphere.</summary>
        public ObjectRef[] OverlapSphere(Vector3 center, double radius, QueryFilter filter = null) {
            return Overlap(new Native.QueryShapeData { Kind = Native.QueryShapeSphere, Begin = center, Radius = radius }, filter);
        }
        /// <summary>The objects that overlap a capsule: all points no farther than the radius from a segment.</summary>
        public ObjectRef[] OverlapCapsule(Vector3 begin, Vector3 end, double radius, QueryFilter filter = null) {
            return Overlap(new Native.QueryShapeData { Kind = Native.QueryShapeCapsule, Begin = begin, End = end, Radius = radius }, filter);
        }
        /// <summary>The object nearest to a box, no farther than a distance; null where there is none.</summary>
        public Closest? Closest(Obb box, double maxDistance = double.PositiveInfinity, QueryFilter filter = null) {
            return Closest(new Native.QueryShapeData { Kind = Native.QueryShapeBox, Box = box }, maxDistance, filter);
        }
        /// <summary>The object nearest to a sphere.</summary>
        public Closest? ClosestToSphere(Vector3 center, double radius, double maxDistance = double.PositiveInfinity, QueryFilter filter = null) {
            return Closest(new Native.QueryShapeData { Kind = Native.QueryShapeSphere, Begin = center, Radius = radius }, maxDistance, filter);
        }
        /// <summary>The object nearest to a capsule.</summary>
        public Closest? ClosestToCapsule(Vector3 begin, Vector3 end, double radius, double maxDistance = double.PositiveInfinity, QueryFilter filter = null) {
            return Closest(new Native.QueryShapeData { Kind = Native.QueryShapeCapsule, Begin = begin, End = end, Radius = radius }, maxDistance, filter);
        }
        Closest? Closest(Native.QueryShapeData shape, double maxDistance, QueryFilter filter) {
            var data = new Native.ClosestData { Size = Native.SizeOf<Native.ClosestData>() };
            using (var memory = new Copies()) {
                var given = memory.Of(filter);
                Library.Check(Native.crofton_world_closest(Handle, ref shape, maxDistance, ref given, ref data));
            }
            if (data.Object.Index == uint.MaxValue) return null;
            return new Closest {
                Object = data.Object, User = data.User, Distance = data.Distance, OnShape = data.OnShape, OnObject = data.OnObject,
                Triangle = data.Triangle, Child = data.Child
            };
        }

        /// <summary>Returns the pairs of objects whose boxes or spheres overlap, in order.</summary>
        public ObjectPair[] Pairs() {
            return Read(() => {
                IntPtr pairs;
                UIntPtr count;
                Library.Check(Native.crofton_world_pairs(Handle, out pairs, out count));
                return Library.ToArray<ObjectPair>(pairs, count);
            });
        }
        /// <summary>Returns the contacts, and those that have ended, in the order of the pairs.</summary>
        public Contact[] Contacts() {
            return Read(() => {
                IntPtr contacts;
                UIntPtr count;
                Library.Check(Native.crofton_world_contacts(Handle, out contacts, out count));
                Native.ContactData[] all = Library.ToArray<Native.ContactData>(contacts, count);
                return Array.ConvertAll(all, c => new Contact {
                    First = c.First, Second = c.Second, Phase = (Phase)c.Phase, Inside = (Containment)c.Inside, Normal = c.Normal, Depth = c.Depth,
                    Points = Library.ToArray<ContactPoint>(c.Points, c.PointCount),
                    Triangles = Library.ToArray<MeshContact>(c.Triangles, c.TriangleCount),
                    ShapePoints = Library.ToArray<TrackedPoint>(c.ShapePoints, c.ShapePointCount)
                });
            });
        }

        /// <summary>Sets the Memory of the contact points of all pairs of shapes, such as impulses for a warm start.</summary>
        public void SetMemories(Func<ObjectRef, ObjectRef, TrackedPoint, Float4> memoryOf) {
            Library.NotNull(memoryOf, "memoryOf");
            Change(() => {
                IntPtr contacts;
                UIntPtr count;
                Library.Check(Native.crofton_world_contacts(Handle, out contacts, out count));
                int size = Marshal.SizeOf(typeof(TrackedPoint)), place = (int)Marshal.OffsetOf(typeof(TrackedPoint), "Memory");
                foreach (var c in Library.ToArray<Native.ContactData>(contacts, count)) {
                    TrackedPoint[] points = Library.ToArray<TrackedPoint>(c.ShapePoints, c.ShapePointCount);
                    for (int i = 0; i < points.Length; ++i)
                        Marshal.StructureToPtr(memoryOf(c.First, c.Second, points[i]), new IntPtr(c.ShapePoints.ToInt64() + (long)i * size + place), false);
                }
            });
        }

        static FoundHandle Find() {
            FoundHandle found;
            Library.Check(Native.crofton_found_create(out found));
            return found;
        }
        ObjectRef[] Overlap(Native.QueryShapeData shape, QueryFilter filter) {
            using (var memory = new Copies())
            using (var found = Find()) {
                IntPtr objects;
                UIntPtr count;
                var given = memory.Of(filter);
                Library.Check(Native.crofton_world_overlap(Handle, ref shape, ref given, found));
                Library.Check(Native.crofton_found_objects(found, out objects, out count));
                return Library.ToArray<ObjectRef>(objects, count);
            }
        }
    }
}
