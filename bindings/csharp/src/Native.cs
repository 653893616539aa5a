// SPDX-License-Identifier: MIT
// The C API as declared in crofton/capi/crofton.h, used by the classes.
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
            public uint IsDouble, IsShort, Triangles, Clusters, OneSided;
            public IntPtr Precut;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct BoundData {
            public uint Kind;
            public Obb Box;
            public Vector3 Min, Max, Center;
            public double Radius;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct RegionObjectData {
            public BoundData Bound;
            public ulong User;
            public uint Layers, CollidesWith, Mesh, Occludes, OnlyOccludes;
            public IntPtr Transform, Shape;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct RegionOptionsData {
            public UIntPtr Size;
            public ulong MaxObjects;
            public IntPtr ShouldStop, StopUser, Meshes;
            public UIntPtr MeshCount;
            public uint FindOccluders;
            public double MaxOrigin;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct RegionInfoData {
            public UIntPtr Size;
            public ulong ObjectCount, Bytes;
            public Vector3 Min, Max;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct BakedRegionOptionsData {
            public UIntPtr Size;
            public uint Triangles, Occluders, CollidesWith, TrustContents;
            public ulong MaxObjects;
            public double MaxOrigin;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct RegionFileData {
            public IntPtr Name;
            public Vector3 Origin, Min, Max;
            public ulong Objects, Bytes;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct BakedMeshData {
            public UIntPtr Size;
            public IntPtr Positions;
            public UIntPtr VertexCount;
            public IntPtr Colors, Indices;
            public UIntPtr IndexCount;
            public IntPtr Name;
            public UIntPtr NameLength;
            public Obb Box;
            public uint OneSided, Flat, Unlit, Reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct FindOptionsData {
            public UIntPtr Size;
            public uint IsTwoSided, MaxOccluders, MaxEdges, MaxBoxesAPiece, Grid;
            public double LeastGain, Flatness;
            public uint MaxPatchTriangles, LevelTriangles;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ManifoldData {
            public UIntPtr Size;
            public Vector3 Normal;
            public double Depth;
            public uint PointCount;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 8)] public ContactPoint[] Points;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct JobsData {
            public UIntPtr Size;
            public IntPtr User;
            public uint Concurrency;
            public IntPtr ParallelFor;
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
            public IntPtr Shape;
            public uint Hidden;
        }

        // Members of crofton_world_set.
        internal const uint SetUser = 1, SetLayers = 2, SetCollidesWith = 4, SetHidden = 8, SetOccludes = 16, SetMesh = 32, SetBound = 64, SetShape = 128;

        [StructLayout(LayoutKind.Sequential)]
        internal struct ObjectInfo {
            public UIntPtr Size;
            public ulong User;
            public uint HasBox, HasTransform;
            public Obb Box;
            public Transform Transform;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct MeshInfo {
            public UIntPtr Size, OccluderCount;
            public ClustersData Clusters;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ClustersData {
            public IntPtr Clusters;
            public UIntPtr ClusterCount;
            public IntPtr TriangleOrder;
            public UIntPtr TriangleCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct DepthObjectData {
            public UIntPtr Size;
            public IntPtr Mesh;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 16)] public float[] ToClip;
            public uint OneSided, Hides;
            public float PositionError;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct DepthReceiverData {
            public IntPtr Mesh;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 16)] public float[] ToMap;
            public uint Solid;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct DepthReceiversData {
            public UIntPtr Size;
            public IntPtr Seen, Objects;
            public UIntPtr ObjectCount;
            public double Radius;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct WorldStatisticsData {
            public UIntPtr Size;
            public ulong Objects, Resting, Moving, BoxPairsTested, ContactPairsTested;
            public uint BoxesChanged, NodesUpdated, OutOfRange, TreeBuilt;
            public ulong ObjectCount, OccludersWaiting;
        }

        internal const uint QueryShapeBox = 0, QueryShapeSphere = 1, QueryShapeCapsule = 2, QueryShapeShape = 3;
        internal const uint ShapeSphere = 0, ShapeCapsule = 1, ShapeCylinder = 2, ShapeCone = 3, ShapeBox = 4, ShapeTriangle = 5, ShapeHull = 6, ShapeHalfSpace = 7,
            ShapeMesh = 8, ShapeHeightField = 9, ShapeCompound = 10, ShapeRounded = 11;
        internal const uint CastMiss = 0, CastUnresolved = 2;

        [StructLayout(LayoutKind.Sequential)]
        internal struct PlainMeshData {
            public UIntPtr Size;
            public IntPtr Positions;
            public UIntPtr VertexCount;
            public IntPtr Indices;
            public UIntPtr IndexCount;
            public IntPtr Name;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct HeightFieldData {
            public UIntPtr Size;
            public uint Columns, Rows;
            public IntPtr Heights, Materials;
            public double SpacingX, SpacingZ;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapeDescriptionData {
            public UIntPtr Size;
            public uint Kind;
            public float Radius, HalfHeight;
            public Float3 HalfExtents, CornersA, CornersB, CornersC;
            public Vector3 PlaneNormal;
            public double PlaneOffset;
            public IntPtr Points;
            public UIntPtr PointCount;
            public uint MaxVertices;
            public float FaceTolerance;
            public IntPtr Mesh, HeightField;
            public uint FrontOnly;
            public IntPtr Core, Children, Poses;
            public UIntPtr ChildCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapeInfo {
            public UIntPtr Size;
            public uint Kind, VertexCount, FaceCount, PartCount;
            public Vector3 Min, Max;
            public double MaxOvershoot;
            public IntPtr Vertices, Indices;
            public UIntPtr IndexCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct MassPropertiesData {
            public UIntPtr Size;
            public double Volume;
            public Vector3 Center, Inertia0, Inertia1, Inertia2;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct PlacedData { public IntPtr Shape, Pose; }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapeDistanceData {
            public UIntPtr Size;
            public double Distance, Lower, Upper;
            public Vector3 OnA, OnB, Normal;
            public Part PartA, PartB;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapePenetrationData {
            public UIntPtr Size;
            public double Depth, Lower, Upper;
            public Vector3 OnA, OnB, Normal;
            public Part PartA, PartB;
            public uint Overlapping;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapeManifoldData {
            public UIntPtr Size;
            public Vector3 Normal;
            public double Depth;
            public uint PointCount;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 8)] public ShapePoint[] Points;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ManifoldOptionsData {
            public UIntPtr Size;
            public double Margin;
            public uint MaxPoints;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct QueryFilterData {
            public UIntPtr Size;
            public uint Layers;
            public IntPtr Ignored;
            public UIntPtr IgnoredCount;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct CastOptionsData {
            public UIntPtr Size;
            public double Duration, Tolerance;
            public uint MaxSteps, IgnoreInitialOverlaps;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ImpactData {
            public UIntPtr Size;
            public double Time, Distance;
            public Vector3 OnA, OnB, Normal;
            public Part PartA, PartB;
            public uint Result, Steps;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapeRayHitData {
            public UIntPtr Size;
            public double T;
            public Vector3 Point, Normal;
            public Part Part;
            public uint StartedInside;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShapeHitData {
            public UIntPtr Size;
            public ObjectHandle Object;
            public ulong User;
            public double Time;
            public Vector3 Normal, Point;
            public uint Triangle, Result;
            public double Distance;
            public uint Child;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ObjectManifoldData {
            public ObjectHandle Object;
            public ulong User;
            public Vector3 Normal;
            public double Depth;
            public uint PointCount;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 8)] public ShapePoint[] Points;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct OccluderData {
            public UIntPtr Size;
            public uint Kind, IsOneSided;
            public IntPtr Positions;
            public UIntPtr PositionCount;
            public IntPtr Indices;
            public UIntPtr IndexCount;
            public Obb Box;
            public uint Edges, HasPiece, HasEyes;
            public Vector3 PieceMin, PieceMax, EyesMin, EyesMax;
            public double MeanShadow, Gain;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct QueryShapeData {
            public uint Kind;
            public Obb Box;
            public Vector3 Begin, End;
            public double Radius;
            public PlacedData Shape;
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
            public uint Triangle, Child;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ContactData {
            public ObjectRef First, Second;
            public byte Phase, Inside;
            public Vector3 Normal;
            public double Depth;
            public IntPtr Points;
            public UIntPtr PointCount;
            public IntPtr Triangles;
            public UIntPtr TriangleCount;
            public IntPtr ShapePoints;
            public UIntPtr ShapePointCount;
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
            public IntPtr Picture, Receivers;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ViewMatrixData {
            public UIntPtr Size;
            public IntPtr Doubles, Floats;
            public uint IsRowMajor, Depth;
            public Vector3 Origin;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct DrawLimitsData {
            public UIntPtr Size;
            public Vector3 Eye;
            public double MaxDistanceInRadii, LeastRadius;
            public IntPtr LayerDistances, ItemDistances;
            public UIntPtr ItemCount;
            public IntPtr DrawnBefore;
            public UIntPtr DrawnWordCount;
            public double Hysteresis;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct PictureData {
            public UIntPtr Size;
            public uint Width, Height, Depth, Samples;
            public ulong WorkLimit;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ShadowReceiversData {
            public UIntPtr Size;
            public IntPtr Seen;
            public double Radius;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ViewInfo {
            public UIntPtr Size;
            public ulong NodesTested, BoxesTested, AcceptedWhole, Straddling, ExactTests, FalsePositives;
            public ulong OccludersDrawn, OccluderPiecesDrawn, OccluderTrianglesDrawn;
            public ulong OcclusionNodesTested, OcclusionNodesOutside, OcclusionNodesHidden, OcclusionItemsTested, OcclusionItemsHidden;
            public IntPtr OccludedIds;
            public UIntPtr OccludedCount;
            public uint DepthWidth, DepthHeight;
            public IntPtr Triangles;
            public UIntPtr TriangleClusterCount;
            public ulong ObjectsListed, ObjectsAsked, ClustersAsked, ClustersDrawn, TrianglesDrawn, TrianglesListed;
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

        [DllImport(Library)] internal static extern int crofton_set_log_hook(IntPtr hook, IntPtr user);
        [DllImport(Library)] internal static extern int crofton_log(uint level, byte[] message);

        [DllImport(Library)] internal static extern CameraData crofton_default_camera();
        [DllImport(Library)] internal static extern WorldOptionsData crofton_default_world_options();
        [DllImport(Library)] internal static extern MeshData crofton_default_mesh_data();
        [DllImport(Library)] internal static extern ObjectData crofton_default_object_description();
        [DllImport(Library)] internal static extern OcclusionOptionsData crofton_default_occlusion_options();
        [DllImport(Library)] internal static extern ViewRequestData crofton_default_view_request();
        [DllImport(Library)] internal static extern ViewMatrixData crofton_default_view_matrix();
        [DllImport(Library)] internal static extern DrawLimitsData crofton_default_draw_limits();
        [DllImport(Library)] internal static extern PictureData crofton_default_picture_view();
        [DllImport(Library)] internal static extern ShadowReceiversData crofton_default_shadow_receivers();
        [DllImport(Library)] internal static extern FitOptionsData crofton_default_fit_options();
        [DllImport(Library)] internal static extern int crofton_frustum_from_camera(ref CameraData camera, ref FrustumData frustum);
        [DllImport(Library)] internal static extern int crofton_frustum_from_matrix(double[] toClip, uint depth, ref Vector3 origin, ref FrustumData frustum);
        [DllImport(Library)] internal static extern int crofton_boxes_validate(Obb[] boxes, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_box_transform(ref Transform transform, ref Obb box, out Obb result);
        [DllImport(Library)] internal static extern int crofton_classify(ref FrustumData frustum, Obb[] boxes, UIntPtr count, [Out] byte[] verdicts);
        [DllImport(Library)] internal static extern int crofton_boxes_meet(ref Obb a, ref Obb b, out int meet);
        [DllImport(Library)] internal static extern int crofton_view_boxes(Obb[] boxes, uint[] layerMasks, UIntPtr count, ref ViewRequestData request, IntPtr jobs, VisibleHandle visible);
        [DllImport(Library)] internal static extern int crofton_draw_limits_of_camera(ref CameraData camera, double pictureHeight, double pixels, ref DrawLimitsData limits);
        [DllImport(Library)] internal static extern int crofton_broadphase_create(out BroadphaseHandle broadphase);
        [DllImport(Library)] internal static extern int crofton_broadphase_destroy(IntPtr broadphase);
        [DllImport(Library)] internal static extern int crofton_broadphase_update(BroadphaseHandle broadphase, Obb[] boxes, Filter[] filters, UIntPtr count, IntPtr jobs);
        [DllImport(Library)] internal static extern int crofton_broadphase_pairs(BroadphaseHandle broadphase, uint which, out IntPtr pairs, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_boxes_manifold(ref Obb a, ref Obb b, ref ManifoldData manifold);
        [DllImport(Library)] internal static extern int crofton_boxes_distance(ref Obb a, ref Obb b, out double distance, out Vector3 onA, out Vector3 onB);
        [DllImport(Library)] internal static extern int crofton_box_raycast(ref Obb box, ref Ray ray, out double t);

        [DllImport(Library)] internal static extern int crofton_criterion_for_rays(double length, out Criterion criterion);
        [DllImport(Library)] internal static extern int crofton_criterion_for_frustum(ref CameraData camera, out Criterion criterion);
        [DllImport(Library)] internal static extern int crofton_fit_boxes(Obb[] boxes, UIntPtr count, ref Criterion criterion, out Obb box);
        [DllImport(Library)] internal static extern int crofton_fit_points(float[] points, UIntPtr count, uint isDouble, ref FitOptionsData options, out Obb box);
        [DllImport(Library)] internal static extern int crofton_fit_points(double[] points, UIntPtr count, uint isDouble, ref FitOptionsData options, out Obb box);

        [DllImport(Library)] internal static extern ShapeDescriptionData crofton_default_shape_description();
        [DllImport(Library)] internal static extern int crofton_shape_create(ref ShapeDescriptionData description, out ShapeHandle shape);
        [DllImport(Library)] internal static extern int crofton_shape_destroy(IntPtr shape);
        [DllImport(Library)] internal static extern int crofton_shape_get_info(ShapeHandle shape, ref ShapeInfo info);
        [DllImport(Library)] internal static extern int crofton_shape_get_mass(ShapeHandle shape, ref MassPropertiesData mass);
        [DllImport(Library)] internal static extern int crofton_shapes_meet(ref PlacedData a, ref PlacedData b, IntPtr cache, out int meet);
        [DllImport(Library)] internal static extern int crofton_shapes_distance(ref PlacedData a, ref PlacedData b, IntPtr cache, ref ShapeDistanceData distance);
        [DllImport(Library)] internal static extern int crofton_shapes_penetration(ref PlacedData a, ref PlacedData b, IntPtr cache, ref ShapePenetrationData penetration);
        [DllImport(Library)] internal static extern int crofton_shapes_manifold(ref PlacedData a, ref PlacedData b, ref ManifoldOptionsData options, IntPtr cache, ref ShapeManifoldData manifold);
        [DllImport(Library)] internal static extern int crofton_shape_closest_point(ref PlacedData shape, ref Vector3 point, ref ShapeDistanceData distance);
        [DllImport(Library)] internal static extern int crofton_shapes_cast(ref PlacedData a, ref Motion motionA, ref PlacedData b, ref Motion motionB, ref CastOptionsData options, ref ImpactData impact);
        [DllImport(Library)] internal static extern int crofton_shape_raycast(ref PlacedData shape, ref Ray ray, ref ShapeRayHitData hit);

        [DllImport(Library)] internal static extern DepthObjectData crofton_default_depth_object();
        [DllImport(Library)] internal static extern DepthReceiversData crofton_default_depth_receivers();
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_create(ref PlainMeshData mesh, uint maxTriangles, out ClusteredMeshHandle clustered);
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_lend(ClusteredMeshHandle clustered, ref PlainMeshData mesh, uint order);
        [DllImport(Library)] internal static extern int crofton_permute_triangles(ref ClustersData clusters, uint[] indices, UIntPtr indexCount, [Out] uint[] permuted);
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_destroy(IntPtr clustered);
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_get(ClusteredMeshHandle clustered, out ClustersData clusters);
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_box(ClusteredMeshHandle clustered, UIntPtr cluster, out ClusterBox box);
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_serialise(ClusteredMeshHandle clustered, [Out] byte[] bytes, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_clustered_mesh_deserialise(byte[] bytes, UIntPtr count, out ClusteredMeshHandle clustered);
        [DllImport(Library)] internal static extern int crofton_depth_culler_create(out DepthCullerHandle culler);
        [DllImport(Library)] internal static extern int crofton_depth_culler_destroy(IntPtr culler);
        [DllImport(Library)] internal static extern int crofton_depth_culler_find_visible(DepthCullerHandle culler, DepthObjectData[] objects, UIntPtr count, ref PictureData picture, IntPtr jobs, out IntPtr clusters, out UIntPtr clusterCount, IntPtr statistics);
        [DllImport(Library)] internal static extern int crofton_depth_culler_find_casters(DepthCullerHandle culler, DepthObjectData[] objects, UIntPtr count, ref PictureData map, ref DepthReceiversData receivers, IntPtr jobs, out IntPtr clusters, out UIntPtr clusterCount, IntPtr statistics);
        [DllImport(Library)] internal static extern int crofton_depth_culler_nearness(DepthCullerHandle culler, uint x, uint y, out float nearness);

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
        [DllImport(Library)] internal static extern int crofton_world_set_node_layers(WorldHandle world, NodeHandle node, uint layers);
        [DllImport(Library)] internal static extern int crofton_world_set_node_transforms(WorldHandle world, NodeHandle[] nodes, UIntPtr stride, Transform[] transforms, UIntPtr transformStride, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_add(WorldHandle world, ref ObjectData description, out ObjectHandle handle);
        [DllImport(Library)] internal static extern int crofton_world_add_many(WorldHandle world, ObjectData[] descriptions, UIntPtr count, [Out] ObjectHandle[] objects);
        [DllImport(Library)] internal static extern int crofton_world_reserve(WorldHandle world, UIntPtr objects);
        [DllImport(Library)] internal static extern int crofton_world_contains_node(WorldHandle world, NodeHandle node, out int contains);
        [DllImport(Library)] internal static extern RegionObjectData crofton_default_region_object();
        [DllImport(Library)] internal static extern RegionOptionsData crofton_default_region_options();
        [DllImport(Library)] internal static extern int crofton_region_prepare(RegionObjectData[] objects, UIntPtr count, ref RegionOptionsData options, IntPtr jobs, out RegionHandle region);
        [DllImport(Library)] internal static extern int crofton_region_destroy(IntPtr region);
        [DllImport(Library)] internal static extern int crofton_region_get_info(RegionHandle region, ref RegionInfoData info);
        [DllImport(Library)] internal static extern int crofton_region_mesh_of(RegionHandle region, uint place, out uint mesh);
        [DllImport(Library)] internal static extern int crofton_region_clusters_of(RegionHandle region, uint mesh, out ClustersData clusters);
        [DllImport(Bake)] internal static extern BakedRegionOptionsData crofton_default_baked_region_options();
        [DllImport(Bake)] internal static extern int crofton_baked_region_open(byte[] path, ref BakedRegionOptionsData options, IntPtr jobs, out RegionHandle region);
        [DllImport(Bake)] internal static extern int crofton_region_index_open(byte[] folder, out RegionIndexHandle index);
        [DllImport(Bake)] internal static extern int crofton_region_index_destroy(IntPtr index);
        [DllImport(Bake)] internal static extern int crofton_region_index_files(RegionIndexHandle index, out IntPtr files, out UIntPtr count);
        [DllImport(Bake)] internal static extern int crofton_region_index_prepare(RegionIndexHandle index, UIntPtr place, ref BakedRegionOptionsData options, IntPtr jobs, out RegionHandle region);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_read(byte[] path, IntPtr jobs, out BakedSceneHandle baked, out TreeHandle tree);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_destroy(IntPtr baked);
        [DllImport(Bake)] internal static extern int crofton_tree_destroy(IntPtr tree);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_mesh_count(BakedSceneHandle baked, out UIntPtr count);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_mesh(BakedSceneHandle baked, uint mesh, ref BakedMeshData data);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_clusters(BakedSceneHandle baked, uint mesh, out ClusteredMeshHandle clustered);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_instances(BakedSceneHandle baked, out IntPtr instances, out UIntPtr count);
        [DllImport(Bake)] internal static extern int crofton_baked_scene_nodes(BakedSceneHandle baked, out IntPtr nodes, out UIntPtr count);
        [DllImport(Bake)] internal static extern int crofton_pvs_open(byte[] path, out PvsHandle pvs);
        [DllImport(Bake)] internal static extern int crofton_pvs_read(byte[] bytes, UIntPtr count, out PvsHandle pvs);
        [DllImport(Bake)] internal static extern int crofton_pvs_destroy(IntPtr pvs);
        [DllImport(Bake)] internal static extern int crofton_pvs_counts(PvsHandle pvs, out UIntPtr cells, out UIntPtr objects);
        [DllImport(Bake)] internal static extern int crofton_pvs_find_cell(PvsHandle pvs, ref Vector3 eye, out uint cell);
        [DllImport(Bake)] internal static extern int crofton_pvs_visible(PvsHandle pvs, ref Vector3 eye, uint mode, out IntPtr words, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_attach(WorldHandle world, RegionHandle region, ref Vector3 origin, out AttachedRegion attached);
        [DllImport(Library)] internal static extern int crofton_world_detach(WorldHandle world, AttachedRegion region);
        [DllImport(Library)] internal static extern int crofton_world_object_in(WorldHandle world, AttachedRegion region, uint place, out ObjectHandle handle);
        [DllImport(Library)] internal static extern int crofton_world_place_of(WorldHandle world, ObjectHandle handle, out AttachedRegion region, out uint place);
        [DllImport(Library)] internal static extern int crofton_world_remove(WorldHandle world, ObjectHandle handle);
        [DllImport(Library)] internal static extern int crofton_world_set_transforms(WorldHandle world, ObjectHandle[] objects, UIntPtr stride, Transform[] transforms, UIntPtr transformStride, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_set_boxes(WorldHandle world, ObjectHandle[] objects, UIntPtr stride, Obb[] boxes, UIntPtr boxStride, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_set(WorldHandle world, ObjectHandle handle, uint members, ref ObjectData description);
        [DllImport(Library)] internal static extern int crofton_world_update(WorldHandle world, IntPtr jobs);
        [DllImport(Library)] internal static extern int crofton_world_get_statistics(WorldHandle world, ref WorldStatisticsData statistics);
        [DllImport(Library)] internal static extern int crofton_world_get_object(WorldHandle world, ObjectHandle handle, ref ObjectInfo info);
        [DllImport(Library)] internal static extern int crofton_world_get_mesh(WorldHandle world, MeshHandle mesh, ref MeshInfo info);
        [DllImport(Library)] internal static extern int crofton_found_shape_hits(FoundHandle found, out IntPtr hits, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_found_manifolds(FoundHandle found, out IntPtr manifolds, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_cast_all(WorldHandle world, ref PlacedData probe, ref Motion motion, ref CastOptionsData options, ref QueryFilterData filter, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_manifolds(WorldHandle world, ref PlacedData probe, ref ManifoldOptionsData options, ref QueryFilterData filter, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_cast(WorldHandle world, ref PlacedData probe, ref Motion motion, ref CastOptionsData options, ref QueryFilterData filter, ref ShapeHitData hit);
        [DllImport(Library)] internal static extern int crofton_world_set_occluders(WorldHandle world, MeshHandle mesh, OccluderData[] occluders, UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_get_occluder(WorldHandle world, MeshHandle mesh, UIntPtr place, ref OccluderData occluder);
        [DllImport(Library)] internal static extern int crofton_view_result_occluders(VisibleHandle visible, WorldHandle world, ObjectHandle[] hidden, [Out] OccluderRef[] occluders, UIntPtr capacity, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_view_result_depth(VisibleHandle visible, UIntPtr view, [Out] float[] nearness, UIntPtr capacity);
        [DllImport(Library)] internal static extern int crofton_world_find_occluders(WorldHandle world, MeshHandle mesh, ref FindOptionsData options);
        [DllImport(Library)] internal static extern FindOptionsData crofton_default_find_options();

        [DllImport(Library)] internal static extern int crofton_view_result_create(out VisibleHandle visible);
        [DllImport(Library)] internal static extern int crofton_view_result_destroy(IntPtr visible);
        [DllImport(Library)] internal static extern int crofton_world_view(WorldHandle world, ref ViewRequestData request, UIntPtr count, IntPtr jobs, VisibleHandle visible);
        [DllImport(Library)] internal static extern int crofton_world_view(WorldHandle world, [In] ViewRequestData[] requests, UIntPtr count, IntPtr jobs, VisibleHandle visible);
        [DllImport(Library)] internal static extern int crofton_view_result_ids(VisibleHandle visible, out IntPtr ids, out UIntPtr count, IntPtr verdicts, IntPtr insideCount);
        [DllImport(Library)] internal static extern int crofton_view_result_list(VisibleHandle visible, WorldHandle world, UIntPtr first, [Out] ObjectRef[] objects, [Out] uint[] viewMasks, UIntPtr capacity);
        [DllImport(Library)] internal static extern int crofton_view_result_get_view(VisibleHandle visible, UIntPtr view, ref ViewInfo info);

        [DllImport(Library)] internal static extern int crofton_found_create(out FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_found_destroy(IntPtr found);
        [DllImport(Library)] internal static extern int crofton_found_objects(FoundHandle found, out IntPtr objects, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_found_hits(FoundHandle found, out IntPtr hits, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_raycast(WorldHandle world, Ray[] rays, UIntPtr count, ref QueryFilterData filter, [Out] ObjectHit[] hits);
        [DllImport(Library)] internal static extern int crofton_world_raycast_any(WorldHandle world, ref Ray ray, ref QueryFilterData filter, out int hit);
        [DllImport(Library)] internal static extern int crofton_world_raycast_all(WorldHandle world, ref Ray ray, ref QueryFilterData filter, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_overlap(WorldHandle world, ref QueryShapeData shape, ref QueryFilterData filter, FoundHandle found);
        [DllImport(Library)] internal static extern int crofton_world_closest(WorldHandle world, ref QueryShapeData shape, double maxDistance, ref QueryFilterData filter, ref ClosestData closest);
        [DllImport(Library)] internal static extern int crofton_world_pairs(WorldHandle world, out IntPtr pairs, out UIntPtr count);
        [DllImport(Library)] internal static extern int crofton_world_contacts(WorldHandle world, out IntPtr contacts, out UIntPtr count);
    }

    /// <summary>Owns a handle of the library; freed once, when nothing can use it any more.</summary>
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
    internal sealed class RegionHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_region_destroy(raw); }
    }
    internal sealed class ShapeHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_shape_destroy(raw); }
    }
    internal sealed class FoundHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_found_destroy(raw); }
    }
    internal sealed class ClusteredMeshHandle : OwnedHandle {
        Copies lent; // arrays that the library reads
        internal void Keep(Copies arrays) {
            if (lent != null) lent.Dispose();
            lent = arrays;
        }
        protected override int Destroy(IntPtr raw) {
            int status = Native.crofton_clustered_mesh_destroy(raw);
            Keep(null);
            return status;
        }
    }
    internal sealed class DepthCullerHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_depth_culler_destroy(raw); }
    }
    internal sealed class TriangulatorHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_triangulator_destroy(raw); }
    }
    internal sealed class BroadphaseHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_broadphase_destroy(raw); }
    }
    internal sealed class BakedSceneHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_baked_scene_destroy(raw); }
    }
    internal sealed class TreeHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_tree_destroy(raw); }
    }
    internal sealed class RegionIndexHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_region_index_destroy(raw); }
    }
    internal sealed class PvsHandle : OwnedHandle {
        protected override int Destroy(IntPtr raw) { return Native.crofton_pvs_destroy(raw); }
    }
}
