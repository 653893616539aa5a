// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>The answer to a view. Reuse it from frame to frame.</summary>
    public sealed class ViewResult : IDisposable {
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
    }

    /// <summary>Two objects whose boxes or spheres overlap; First has the lower index.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectPair { public ObjectRef First, Second; }

    /// <summary>The phase of a contact: it began in this update, began in an earlier one, or has ended.</summary>
    public enum Phase : uint { Began = 0, Stayed = 1, Ended = 2 }

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

    /// <summary>Two objects that touch, or that have ended touching in this update.</summary>
    public sealed class Contact {
        public ObjectRef First, Second;
        public Phase Phase;
        /// <summary>Unit, from first to second; 0 if no direction is known.</summary>
        public Vector3 Normal;
        /// <summary>Moving the second by Depth * Normal ends the contact; between meshes it is the deepest point's depth unless MeshDepth is set.</summary>
        public double Depth;
        public ContactPoint[] Points;
        public MeshContact[] Triangles;
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
    }

    /// <summary>A cluster with triangles to draw: bit k of Triangles stands for triangle FirstTriangle + k of the cluster.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct VisibleCluster {
        public uint Object, Cluster;
        public ulong Triangles;
    }

    /// <summary>A group of neighbouring triangles.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Cluster {
        public uint FirstTriangle, TriangleCount;
    }

    /// <summary>A mesh cut into clusters. Permute the index buffer that you draw by TriangleOrder: each cluster is then one range.</summary>
    public sealed class Clusters {
        public Cluster[] All;
        public uint[] TriangleOrder;
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
        // Holds what requests point to during a call.
        sealed class Copies : IDisposable {
            readonly System.Collections.Generic.List<IntPtr> memory = new System.Collections.Generic.List<IntPtr>();
            readonly System.Collections.Generic.List<GCHandle> pinned = new System.Collections.Generic.List<GCHandle>();
            readonly System.Collections.Generic.List<SafeHandle> held = new System.Collections.Generic.List<SafeHandle>();

            internal Native.ViewRequestData Of(ViewRequest request) {
                Native.ViewRequestData data = Native.crofton_default_view_request();
                data.Layers = request.Layers;
                data.Conservative = request.Conservative ? 1u : 0u;
                data.TreeOrder = request.TreeOrder ? 1u : 0u;
                if (request.Camera != null) data.Camera = Copied(request.Camera.Data());
                if (request.Matrix != null) data.Matrix = Copied(Of(request.Matrix));
                if (request.Volume != null) data.Volume = Copied(request.Volume.Data);
                if (request.Occlusion != null) data.Occlusion = Copied(request.Occlusion.Data());
                if (request.Limits != null) data.Limits = Copied(Of(request.Limits));
                if (request.Picture != null) {
                    Native.PictureData picture = Native.crofton_default_picture_view();
                    picture.Width = request.Picture.Width;
                    picture.Height = request.Picture.Height;
                    picture.Depth = (uint)request.Picture.Depth;
                    picture.Samples = request.Picture.Samples;
                    picture.WorkLimit = request.Picture.WorkLimit;
                    data.Picture = Copied(picture);
                }
                if (request.Receivers != null) data.Receivers = Copied(Of(request.Receivers));
                if (request.CandidateMask != null) {
                    data.CandidateMask = Pinned(request.CandidateMask);
                    data.CandidateWords = (UIntPtr)request.CandidateMask.Length;
                }
                return data;
            }
            Native.ShadowReceiversData Of(ShadowReceivers receivers) {
                Library.NotNull(receivers.Seen, "Seen");
                Native.ShadowReceiversData data = Native.crofton_default_shadow_receivers();
                data.Seen = Held(receivers.Seen.Handle);
                data.Radius = receivers.Radius;
                return data;
            }
            Native.ViewMatrixData Of(ViewMatrix matrix) {
                if (matrix.ToClip == null || matrix.ToClip.Length != 16) throw new ArgumentException("a matrix has sixteen numbers", "Matrix");
                Native.ViewMatrixData data = Native.crofton_default_view_matrix();
                data.Doubles = Pinned(matrix.ToClip);
                data.IsRowMajor = matrix.IsRowMajor ? 1u : 0u;
                data.Depth = (uint)matrix.Depth;
                data.Origin = matrix.Origin;
                return data;
            }
            Native.DrawLimitsData Of(DrawLimits limits) {
                if (limits.LayerDistances != null && limits.LayerDistances.Length != 32)
                    throw new ArgumentException("there are 32 layers", "LayerDistances");
                Native.DrawLimitsData data = Native.crofton_default_draw_limits();
                data.Eye = limits.Eye;
                if (!double.IsPositiveInfinity(limits.MaxDistanceInRadii)) data.MaxDistanceInRadii = limits.MaxDistanceInRadii;
                data.LeastRadius = limits.LeastRadius;
                data.Hysteresis = limits.Hysteresis;
                if (limits.LayerDistances != null) data.LayerDistances = Pinned(limits.LayerDistances);
                if (limits.ItemDistances != null) {
                    data.ItemDistances = Pinned(limits.ItemDistances);
                    data.ItemCount = (UIntPtr)limits.ItemDistances.Length;
                }
                if (limits.DrawnBefore != null) {
                    data.DrawnBefore = Pinned(limits.DrawnBefore);
                    data.DrawnWordCount = (UIntPtr)limits.DrawnBefore.Length;
                }
                return data;
            }
            IntPtr Copied<T>(T data) where T : struct {
                IntPtr copy = Marshal.AllocHGlobal(Marshal.SizeOf(typeof(T)));
                memory.Add(copy);
                Marshal.StructureToPtr(data, copy, false);
                return copy;
            }
            IntPtr Held(SafeHandle handle) {
                bool isHeld = false;
                handle.DangerousAddRef(ref isHeld);
                held.Add(handle);
                return handle.DangerousGetHandle();
            }
            IntPtr Pinned(Array numbers) {
                var handle = GCHandle.Alloc(numbers, GCHandleType.Pinned);
                pinned.Add(handle);
                return handle.AddrOfPinnedObject();
            }
            public void Dispose() {
                foreach (IntPtr copy in memory) Marshal.FreeHGlobal(copy);
                foreach (GCHandle handle in pinned) handle.Free();
                foreach (SafeHandle handle in held) handle.DangerousRelease();
            }
        }

        /// <summary>Returns the nearest hit of a ray with triangles of meshes, boxes and spheres.</summary>
        public ObjectHit Raycast(Ray ray, uint layers = AllLayers) { return Raycast(new[] { ray }, layers)[0]; }
        /// <summary>Returns the nearest hit of each ray.</summary>
        public ObjectHit[] Raycast(Ray[] rays, uint layers = AllLayers) {
            Library.NotNull(rays, "rays");
            var hits = new ObjectHit[rays.Length];
            Library.Check(Native.crofton_world_raycast(Handle, rays, (UIntPtr)rays.Length, layers, hits));
            return hits;
        }
        /// <summary>Tests whether the ray hits anything; faster than Raycast.</summary>
        public bool RaycastAny(Ray ray, uint layers = AllLayers) {
            int hit;
            Library.Check(Native.crofton_world_raycast_any(Handle, ref ray, layers, out hit));
            return hit != 0;
        }
        /// <summary>Lists the nearest hit of each object that the ray hits, in order of T, then of index.</summary>
        public ObjectHit[] RaycastAll(Ray ray, uint layers = AllLayers) {
            using (var found = Find()) {
                IntPtr hits;
                UIntPtr count;
                Library.Check(Native.crofton_world_raycast_all(Handle, ref ray, layers, found));
                Library.Check(Native.crofton_found_hits(found, out hits, out count));
                return Library.ToArray<ObjectHit>(hits, count);
            }
        }

        /// <summary>The objects that overlap a box, by index: their shapes, triangles, spheres or boxes.</summary>
        public ObjectRef[] Overlap(Obb box, uint layers = AllLayers) {
            return Overlap(new Native.QueryShapeData { Kind = Native.QueryShapeBox, Box = box }, layers);
        }
        /// <summary>The objects that overlap a sphere.</summary>
        public ObjectRef[] OverlapSphere(Vector3 center, double radius, uint layers = AllLayers) {
            return Overlap(new Native.QueryShapeData { Kind = Native.QueryShapeSphere, Begin = center, Radius = radius }, layers);
        }
        /// <summary>The objects that overlap a capsule: all points no farther than the radius from a segment.</summary>
        public ObjectRef[] OverlapCapsule(Vector3 begin, Vector3 end, double radius, uint layers = AllLayers) {
            return Overlap(new Native.QueryShapeData { Kind = Native.QueryShapeCapsule, Begin = begin, End = end, Radius = radius }, layers);
        }
        /// <summary>The object nearest to a sphere, no farther than a distance; null where there is none.</summary>
        public Closest? ClosestToSphere(Vector3 center, double radius, double maxDistance = double.PositiveInfinity, uint layers = AllLayers) {
            var data = new Native.ClosestData { Size = Native.SizeOf<Native.ClosestData>() };
            var shape = new Native.QueryShapeData { Kind = Native.QueryShapeSphere, Begin = center, Radius = radius };
            Library.Check(Native.crofton_world_closest(Handle, ref shape, maxDistance, layers, ref data));
            if (data.Object.Index == uint.MaxValue) return null;
            return new Closest {
                Object = data.Object, User = data.User, Distance = data.Distance, OnShape = data.OnShape, OnObject = data.OnObject
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
                    First = c.First, Second = c.Second, Phase = (Phase)c.Phase, Normal = c.Normal, Depth = c.Depth,
                    Points = Library.ToArray<ContactPoint>(c.Points, c.PointCount),
                    Triangles = Library.ToArray<MeshContact>(c.Triangles, c.TriangleCount)
                });
            });
        }

        static FoundHandle Find() {
            FoundHandle found;
            Library.Check(Native.crofton_found_create(out found));
            return found;
        }
        ObjectRef[] Overlap(Native.QueryShapeData shape, uint layers) {
            using (var found = Find()) {
                IntPtr objects;
                UIntPtr count;
                Library.Check(Native.crofton_world_overlap(Handle, ref shape, layers, found));
                Library.Check(Native.crofton_found_objects(found, out objects, out count));
                return Library.ToArray<ObjectRef>(objects, count);
            }
        }
    }
}
