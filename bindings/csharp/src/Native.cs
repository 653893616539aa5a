// SPDX-License-Identifier: MIT
// The C API as it is declared in crofton/capi/crofton.h: what the classes stand on.
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    internal static class Native {
        const string Library = "crofton", Bake = "crofton_bake";
        internal const uint ApiVersion = 3;

        [StructLayout(LayoutKind.Sequential)]
        internal struct CameraData {
            public UIntPtr Size;
            public Vector3 Position, Forward, Up;
            public uint Projection;
            public double FovY, Height, Aspect, Near, Far;
        }

        internal const int MaxPlanes = 12;

        [StructLayout(LayoutKind.Sequential)]
        internal struct FrustumData {
            public UIntPtr Size;
            public uint PlaneCount;
            public Vector3 Origin;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4 * MaxPlanes)] public double[] Planes;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct MeshData {
            public UIntPtr Size;
            public IntPtr Positions;
            public UIntPtr PositionCount, PositionStride;
            public IntPtr Indices;
            public UIntPtr IndexCount;
            public uint IsDouble, IsShort, Triangles;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct BoundData {
            public uint Kind;
            public Obb Box;
            public Vector3 Min, Max, Center;
            public double Radius;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ObjectData {
            public UIntPtr Size;
            public ulong User;
            public IntPtr Bound, Transform;
            public uint HasMesh, HasNode;
            public MeshHandle Mesh;
            public NodeHandle Node;
            public uint Layers, CollidesWith, Occludes, OnlyOccludes;
            public IntPtr Body;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct WorldOptionsData {
            public UIntPtr Size;
            public uint Pairs, Contacts, Containment, MeshDepth;
            public ulong MaxPairs, RebuildBudget;
            public uint UpdatesToRest;
            public double ContactMargin;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ClosestData {
            public UIntPtr Size;
            public ObjectHandle Object;
            public ulong User;
            public double Distance;
            public Vector3 OnShape, OnObject;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ContactData {
            public UIntPtr Size;
            public ObjectRef First, Second;
            public uint Phase, Inside;
            public Vector3 Normal;
            public double Depth;
            public IntPtr Points, Triangles;
            public UIntPtr PointCount, TriangleCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct OcclusionOptionsData {
            public UIntPtr Size;
            public uint Width, Height, MaxOccluders, ListOccluded;
            public float LeastCover;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ViewRequestData {
            public UIntPtr Size;
            public IntPtr Camera, Matrix, Volume;
            public uint Layers;
            public IntPtr Occlusion, Limits, CandidateMask;
            public UIntPtr CandidateWords;
            public uint Conservative, TreeOrder;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct FitOptionsData {
            public UIntPtr Size;
            public uint Quality;
            public Criterion Criterion;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct PolygonData {
            public UIntPtr Size;
            public IntPtr Points;
            public UIntPtr PointCount;
            public IntPtr RingEnds;
            public UIntPtr RingCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct TriangulationData {
            public UIntPtr Size;
            public IntPtr Indices;
            public UIntPtr TriangleCount;
            public double Weight, Gap;
            public uint Optimal;
        }

        internal static UIntPtr SizeOf<T>() { return (UIntPtr)Marshal.SizeOf(typeof(T)); }

        [DllImport(Library)] internal static extern IntPtr crofton_last_error();
        [DllImport(Library)] internal static extern ulong crofton_last_error_item();
        [DllImport(Library)] internal static extern uint crofton_api_version();
        [DllImport(Library)] internal static extern IntPtr crofton_version_string();
        [DllImport(Library)] internal static extern int crofton_set_thread_checks(int on);

        [DllImport(Library)] internal static extern CameraData crofton_default_camera();
        [DllImport(Library)] internal static extern WorldOptionsData crofton_default_world_options();
        [DllImport(Library)] internal static extern MeshData crofton_default_mesh_data();
        [DllImport(Library)] internal static extern ObjectData crofton_default_object_description();
        [DllImport(Library)] internal static extern OcclusionOptionsData crofton_default_occlusion_options();
        [DllImport(Library)] internal static extern ViewRequestData crofton_default_view_request();
        [DllImport(Library)] internal static extern int crofton_frustum_from_camera(ref CameraData camera, ref FrustumData frustum);
        [DllImport(Library)] internal static extern int crofton_frustum_from_matrix(double[] toClip, uint depth, ref Vector3 origin, ref FrustumData frustum);
        [DllImport(Library)] internal static extern int crofton_boxes_validate(Obb[] boxes, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_box_transform(ref Transform transform, ref Obb box, out Obb result);
        [DllImport(Library)] internal static extern int crofton_classify(ref FrustumData frustum, Obb[] boxes, UIntPtr count, [Out] byte[] verdicts);
        [DllImport(Library)] internal static extern int crofton_boxes_meet(ref Obb a, ref Obb b, out int meet);
        [DllImport(Library)] internal static extern int crofton_boxes_distance(ref Obb a, ref Obb b, out double distance, out Vector3 onA, out Vector3 onB);
        [DllImport(Library)] internal static extern int crofton_box_raycast(ref Obb box, ref Ray ray, out double t);

        [DllImport(Library)] internal static extern int crofton_criterion_minimal_perimeter(out Criterion criterion);
        [DllImport(Library)] internal static extern int crofton_criterion_for_rays(double length, out Criterion criterion);
        [DllImport(Library)] internal static extern int crofton_criterion_for_frustum(ref CameraData camera, out Criterion criterion);
        [DllImport(Library)] internal static extern int crofton_fit_floats(float[] points, UIntPtr count, ref FitOptionsData options, out Obb box);
        [DllImport(Library)] internal static extern int crofton_fit_doubles(double[] points, UIntPtr count, ref FitOptionsData options, out Obb box);

        [DllImport(Bake)] internal static extern int crofton_triangulator_create(out TriangulatorHandle triangulator);
        [DllImport(Bake)] internal static extern int crofton_triangulator_destroy(IntPtr triangulator);
        [DllImport(Bake)] internal static extern int crofton_triangulate(TriangulatorHandle triangulator, ref PolygonData polygon, uint method, ref TriangulationData result);

        [DllImport(Library)] internal static extern int crofton_world_create(ref WorldOptionsData options, out WorldHandle world);
        [DllImport(Library)] internal static extern int crofton_world_destroy(IntPtr world);
        [DllImport(Library)] internal static extern int crofton_world_add_mesh(WorldHandle world, ref MeshData data, out MeshHandle mesh);
        [DllImport(Library)] internal static extern int crofton_world_replace_mesh(WorldHandle world, MeshHandle mesh, ref MeshData data);
        [DllImport(Library)] internal static extern int crofton_world_set_vertices(WorldHandle world, MeshHandle mesh, ref MeshData data);
        [DllImport(Library)] internal static extern int crofton_world_remove_mesh(WorldHandle world, MeshHandle mesh);
        [DllImport(Library)] internal static extern int crofton_world_add_node(WorldHandle world, NodeHandle[] parent, ref Transform transform, uint layers, out NodeHandle node);
        [DllImport(Library)] internal static extern int crofton_world_remove_node(WorldHandle world, NodeHandle node);
        [DllImport(Library)] internal static extern int crofton_world_set_parent(WorldHandle world, NodeHandle node, NodeHandle[] parent);
        [DllImport(Library)] internal static extern int crofton_world_set_node_transforms(WorldHandle world, NodeHandle[] nodes, UIntPtr stride, Transform[] transforms, UIntPtr transformStride, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_add(WorldHandle world, ref ObjectData description, out ObjectHandle handle);
        [DllImport(Library)] internal static extern int crofton_world_remove(WorldHandle world, ObjectHandle handle);
        [DllImport(Library)] internal static extern int crofton_world_set_transforms(WorldHandle world, ObjectHandle[] objects, UIntPtr stride, Transform[] transforms, UIntPtr transformStride, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_set_boxes(WorldHandle world, ObjectHandle[] objects, UIntPtr stride, Obb[] boxes, UIntPtr boxStride, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_set_bound(WorldHandle world, ObjectHandle handle, ref BoundData bound);
        [DllImport(Library)] internal static extern int crofton_world_set_mesh(WorldHandle world, ObjectHandle handle, MeshHandle mesh);
        [DllImport(Library)] internal static extern int crofton_world_set_hidden(WorldHandle world, ObjectHandle handle, int hidden);
        [DllImport(Library)] internal static extern int crofton_world_set_layers(WorldHandle world, ObjectHandle handle, uint layers);
        [DllImport(Library)] internal static extern int crofton_world_set_collides_with(WorldHandle world, ObjectHandle handle, uint layers);
        [DllImport(Library)] internal static extern int crofton_world_set_user(WorldHandle world, ObjectHandle handle, ulong user);
        [DllImport(Library)] internal static extern int crofton_world_update(WorldHandle world, IntPtr jobs);
        [DllImport(Library)] internal static extern int crofton_world_object_count(WorldHandle world, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_contains(WorldHandle world, ObjectHandle handle, out int contains);
        [DllImport(Library)] internal static extern int crofton_world_get_user(WorldHandle world, ObjectHandle handle, out ulong user);
        [DllImport(Library)] internal static extern int crofton_world_get_box(WorldHandle world, ObjectHandle handle, out Obb box);
        [DllImport(Library)] internal static extern int crofton_world_get_transform(WorldHandle world, ObjectHandle handle, out Transform transform);
        [DllImport(Library)] internal static extern int crofton_world_find_occluders(WorldHandle world, MeshHandle mesh, IntPtr options);
        [DllImport(Library)] internal static extern int crofton_world_occluder_count(WorldHandle world, MeshHandle mesh, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_set_occludes(WorldHandle world, ObjectHandle handle, int occludes);

        [DllImport(Library)] internal static extern int crofton_view_result_create(out VisibleHandle visible);
        [DllImport(Library)] internal static extern int crofton_view_result_destroy(IntPtr visible);
        [DllImport(Library)] internal static extern int crofton_world_view(WorldHandle world, ref ViewRequestData request, IntPtr jobs, VisibleHandle visible);
        [DllImport(Library)] internal static extern int crofton_view_result_ids(VisibleHandle visible, out IntPtr ids, out UIntPtr count, IntPtr verdicts, IntPtr insideCount);
        [DllImport(Library)] internal static extern int crofton_view_result_list(VisibleHandle visible, WorldHandle world, UIntPtr first, [Out] ObjectRef[] objects, IntPtr viewMasks, UIntPtr capacity);

        [DllImport(Library)] internal static extern int crofton_found_create(out FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_found_destroy(IntPtr found);
        [DllImport(Library)] internal static extern int crofton_found_objects(FoundHandle found, out IntPtr objects, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_found_hits(FoundHandle found, out IntPtr hits, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_raycast(WorldHandle world, Ray[] rays, UIntPtr count, uint layers, [Out] Hit[] hits);
        [DllImport(Library)] internal static extern int crofton_world_raycast_any(WorldHandle world, ref Ray ray, uint layers, out int hit);
        [DllImport(Library)] internal static extern int crofton_world_raycast_all(WorldHandle world, ref Ray ray, uint layers, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_overlap_box(WorldHandle world, ref Obb box, uint layers, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_overlap_sphere(WorldHandle world, ref Vector3 center, double radius, uint layers, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_overlap_capsule(WorldHandle world, ref Vector3 begin, ref Vector3 end, double radius, uint layers, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_closest_to_sphere(WorldHandle world, ref Vector3 center, double radius, double maxDistance, uint layers, ref ClosestData closest);
        [DllImport(Library)] internal static extern int crofton_world_pairs(WorldHandle world, out IntPtr pairs, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_contact_count(WorldHandle world, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_contact(WorldHandle world, UIntPtr contact, ref ContactData result);
    }

    /// <summary>Owns something of the library; freed once, when nobody can use it any more.</summary>
    internal abstract class OwnedHandle : SafeHandle {
        protected OwnedHandle() : base(IntPtr.Zero, true) { }
        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        protected abstract int Destroy(IntPtr raw);
        protected override bool ReleaseHandle() { return Destroy(handle) == 0; }
    }
    internal sealed class WorldHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_world_destroy(raw); }
    }
    internal sealed class VisibleHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_view_result_destroy(raw); }
    }
    internal sealed class FoundHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_found_destroy(raw); }
    }
    internal sealed class TriangulatorHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_triangulator_destroy(raw); }
    }
}
