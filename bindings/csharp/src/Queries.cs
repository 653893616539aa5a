// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>Memory for the answer to a view; keep it from frame to frame.</summary>
    public sealed class ViewResult : IDisposable {
        internal readonly VisibleHandle Handle;
        ObjectRef[] objects = new ObjectRef[0];

        public ViewResult() {
            Library.Load();
            Library.Check(Native.crofton_view_result_create(out Handle));
        }
        public void Dispose() { Handle.Dispose(); }

        /// <summary>How many objects the last view saw.</summary>
        public int Count { get; private set; }
        /// <summary>The objects and the caller's numbers, by index; only the first Count are of the last view.</summary>
        public ObjectRef[] Objects { get { return objects; } }

        internal int Read(World world) {
            IntPtr ids;
            UIntPtr count;
            Library.Check(Native.crofton_view_result_ids(Handle, out ids, out count, IntPtr.Zero, IntPtr.Zero));
            var listed = objects.Length < (int)count ? new ObjectRef[(int)count + (int)count / 2] : objects;
            Library.Check(Native.crofton_view_result_list(Handle, world.Handle, UIntPtr.Zero, listed, IntPtr.Zero, count));
            objects = listed;
            return Count = (int)count;
        }
    }

    /// <summary>Where a ray meets an object.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Hit {
        public ObjectHandle Object;
        public ulong User;
        /// <summary>The ray's.</summary>
        public double T;
        public Vector3 Point;
        uint triangle;
        /// <summary>Of a body that is a compound: which.</summary>
        public uint Child;
        /// <summary>Of unit length, of the surface, to the side that the ray comes from; 0 if it began inside.</summary>
        public Vector3 Normal;
        byte startedInside;
        /// <summary>Whether the ray began in the body, box or sphere: T is 0.</summary>
        public bool StartedInside { get { return startedInside != 0; } }
        /// <summary>Whether the ray meets anything; the other members count only then.</summary>
        public bool IsHit { get { return Object.Index != uint.MaxValue; } }
        /// <summary>Of the object's mesh or its body's surface.</summary>
        public uint? Triangle { get { return triangle == uint.MaxValue ? (uint?)null : triangle; } }
    }

    /// <summary>The nearest object to a shape.</summary>
    public struct Closest {
        public ObjectHandle Object;
        public ulong User;
        public double Distance;
        public Vector3 OnShape, OnObject;
    }

    /// <summary>Two objects whose boxes or spheres meet; First has the lower index.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ObjectPair { public ObjectRef First, Second; }

    /// <summary>Since when two objects touch: since this update, since an earlier one, or no longer.</summary>
    public enum Phase : uint { Began = 0, Stayed = 1, Ended = 2 }

    /// <summary>A point where two bodies touch: midway between the surfaces, and how deep.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ContactPoint {
        public Vector3 Position;
        public double Depth;
    }

    /// <summary>Where two triangles meet: the ends of their common segment, and the unit normal of the second's.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshContact {
        public uint FirstTriangle, SecondTriangle;
        public Vector3 Begin, End, Normal;
    }

    /// <summary>Two objects that touch, or that did in the update before.</summary>
    public sealed class Contact {
        public ObjectRef First, Second;
        public Phase Phase;
        /// <summary>Unit, from first to second; 0 where no direction is known.</summary>
        public Vector3 Normal;
        /// <summary>Moving the second by Depth * Normal parts them; between meshes the deepest point's depth unless options ask for a way out.</summary>
        public double Depth;
        public ContactPoint[] Points;
        public MeshContact[] Triangles;
    }

    /// <summary>How a view leaves out what other objects hide.</summary>
    public sealed class OcclusionOptions {
        /// <summary>Of the depth buffer, in pixels.</summary>
        public uint Width = 480, Height = 270;
        /// <summary>Draws at most so many.</summary>
        public uint MaxOccluders = 256;

        internal Native.OcclusionOptionsData Data() {
            Native.OcclusionOptionsData data = Native.crofton_default_occlusion_options();
            data.Width = Width;
            data.Height = Height;
            data.MaxOccluders = MaxOccluders;
            return data;
        }
    }

    /// <summary>What a view asks: where it looks from, and what it lists.</summary>
    public sealed class ViewRequest {
        /// <summary>Set a camera,</summary>
        public Camera Camera;
        /// <summary>or any convex volume. For occlusion set a camera as well: objects are tested against the volume instead of its frustum.</summary>
        public Frustum Volume;
        /// <summary>Lists objects that share a layer with these.</summary>
        public uint Layers = World.AllLayers;
        /// <summary>If set, leaves out objects that others hide; never one that is seen.</summary>
        public OcclusionOptions Occlusion;

        public static implicit operator ViewRequest(Camera camera) { return camera == null ? null : new ViewRequest { Camera = camera }; }
        public static implicit operator ViewRequest(Frustum volume) { return volume == null ? null : new ViewRequest { Volume = volume }; }
    }

    public sealed partial class World {
        /// <summary>What a view sees, by the objects' boxes, exactly: no visible box is left out. With Occlusion also without
        /// what other objects hide. A Camera or a Frustum stands for a request with all layers.</summary>
        public void View(ViewRequest request, ViewResult visible) {
            Library.NotNull(request, "request");
            Library.NotNull(visible, "visible");
            Native.ViewRequestData data = Native.crofton_default_view_request();
            data.Layers = request.Layers;
            try {
                if (request.Camera != null) data.Camera = Copied(request.Camera.Data());
                if (request.Volume != null) data.Volume = Copied(request.Volume.Data);
                if (request.Occlusion != null) data.Occlusion = Copied(request.Occlusion.Data());
                Read(() => {
                    Library.Check(Native.crofton_world_view(Handle, ref data, IntPtr.Zero, visible.Handle));
                    return visible.Read(this);
                });
            } finally {
                foreach (IntPtr memory in new[] { data.Camera, data.Volume, data.Occlusion }) Marshal.FreeHGlobal(memory);
            }
        }
        static IntPtr Copied<T>(T data) where T : struct {
            IntPtr memory = Marshal.AllocHGlobal(Marshal.SizeOf(typeof(T)));
            Marshal.StructureToPtr(data, memory, false);
            return memory;
        }

        /// <summary>The nearest hit of a ray: triangles of meshes, boxes and spheres.</summary>
        public Hit Raycast(Ray ray, uint layers = AllLayers) { return Raycast(new[] { ray }, layers)[0]; }
        /// <summary>The nearest hit of each ray.</summary>
        public Hit[] Raycast(Ray[] rays, uint layers = AllLayers) {
            Library.NotNull(rays, "rays");
            var hits = new Hit[rays.Length];
            Library.Check(Native.crofton_world_raycast(Handle, rays, (UIntPtr)rays.Length, layers, hits));
            return hits;
        }
        /// <summary>Whether the ray hits anything: quicker than what.</summary>
        public bool RaycastAny(Ray ray, uint layers = AllLayers) {
            int hit;
            Library.Check(Native.crofton_world_raycast_any(Handle, ref ray, layers, out hit));
            return hit != 0;
        }
        /// <summary>The nearest hit of every object that the ray meets, by T, then by index.</summary>
        public Hit[] RaycastAll(Ray ray, uint layers = AllLayers) {
            using (var found = Find()) {
                IntPtr hits;
                UIntPtr count;
                Library.Check(Native.crofton_world_raycast_all(Handle, ref ray, layers, found));
                Library.Check(Native.crofton_found_hits(found, out hits, out count));
                return Library.ToArray<Hit>(hits, count);
            }
        }

        /// <summary>Whose box or sphere meets a box, by index. A mesh's box stands for it.</summary>
        public ObjectRef[] Overlap(Obb box, uint layers = AllLayers) {
            return Overlap(found => Native.crofton_world_overlap_box(Handle, ref box, layers, found));
        }
        /// <summary>Whose box or sphere meets a sphere.</summary>
        public ObjectRef[] OverlapSphere(Vector3 center, double radius, uint layers = AllLayers) {
            return Overlap(found => Native.crofton_world_overlap_sphere(Handle, ref center, radius, layers, found));
        }
        /// <summary>Whose box or sphere meets the points no farther than the radius from a segment.</summary>
        public ObjectRef[] OverlapCapsule(Vector3 begin, Vector3 end, double radius, uint layers = AllLayers) {
            return Overlap(found => Native.crofton_world_overlap_capsule(Handle, ref begin, ref end, radius, layers, found));
        }
        /// <summary>The box or sphere nearest to a sphere, no farther than a distance; null where there is none.</summary>
        public Closest? ClosestToSphere(Vector3 center, double radius, double maxDistance = double.PositiveInfinity, uint layers = AllLayers) {
            var data = new Native.ClosestData { Size = Native.SizeOf<Native.ClosestData>() };
            Library.Check(Native.crofton_world_closest_to_sphere(Handle, ref center, radius, maxDistance, layers, ref data));
            if (data.Object.Index == uint.MaxValue) return null;
            return new Closest {
                Object = data.Object, User = data.User, Distance = data.Distance, OnShape = data.OnShape, OnObject = data.OnObject
            };
        }

        /// <summary>Objects whose boxes or spheres meet, in order.</summary>
        public ObjectPair[] Pairs() {
            return Read(() => {
                IntPtr pairs;
                UIntPtr count;
                Library.Check(Native.crofton_world_pairs(Handle, out pairs, out count));
                return Library.ToArray<ObjectPair>(pairs, count);
            });
        }
        /// <summary>What touches, and what has ceased to, in the order of the pairs.</summary>
        public Contact[] Contacts() {
            return Read(() => {
                UIntPtr count;
                Library.Check(Native.crofton_world_contact_count(Handle, out count));
                var result = new Contact[(int)count];
                for (int i = 0; i < result.Length; ++i) result[i] = ContactAt(i);
                return result;
            });
        }
        Contact ContactAt(int place) {
            var c = new Native.ContactData { Size = Native.SizeOf<Native.ContactData>() };
            Library.Check(Native.crofton_world_contact(Handle, (UIntPtr)place, ref c));
            return new Contact {
                First = c.First, Second = c.Second, Phase = (Phase)c.Phase, Normal = c.Normal, Depth = c.Depth,
                Points = Library.ToArray<ContactPoint>(c.Points, c.PointCount),
                Triangles = Library.ToArray<MeshContact>(c.Triangles, c.TriangleCount)
            };
        }

        static FoundHandle Find() {
            FoundHandle found;
            Library.Check(Native.crofton_found_create(out found));
            return found;
        }
        static ObjectRef[] Overlap(Func<FoundHandle, int> call) {
            using (var found = Find()) {
                IntPtr objects;
                UIntPtr count;
                Library.Check(call(found));
                Library.Check(Native.crofton_found_objects(found, out objects, out count));
                return Library.ToArray<ObjectRef>(objects, count);
            }
        }
    }
}
