// SPDX-License-Identifier: MIT
using System;
using System.Linq;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>A convex part of a shape: a child of a compound, or a triangle of a mesh or a height field.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Part { public uint Child, Triangle; }

    /// <summary>A motion: Pivot, in the shape's frame, moves by Velocity * t, and the shape turns about it by |Spin| * t radians around Spin, in world axes.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Motion { public Vector3 Velocity, Spin, Pivot; }

    /// <summary>Options of a cast.</summary>
    public sealed class CastOptions {
        /// <summary>At least 0.</summary>
        public double Duration = 1;
        /// <summary>How far apart the shapes may still be at the time of a hit; 0: 1e-6.</summary>
        public double Tolerance;
        /// <summary>0: 500.</summary>
        public uint MaxSteps;
        /// <summary>Skips what overlaps, or is within the tolerance, at time 0.</summary>
        public bool IgnoreInitialOverlaps;

        internal static Native.CastOptionsData Data(CastOptions given) {
            given = given ?? new CastOptions();
            return new Native.CastOptionsData {
                Size = Native.SizeOf<Native.CastOptionsData>(), Duration = given.Duration, Tolerance = given.Tolerance, MaxSteps = given.MaxSteps,
                IgnoreInitialOverlaps = given.IgnoreInitialOverlaps ? 1u : 0u
            };
        }
    }

    /// <summary>Mass properties for density 1, in the shape's frame; the inertia is about the center of mass.</summary>
    public struct MassProperties {
        public double Volume;
        public Vector3 Center, Inertia0, Inertia1, Inertia2;
    }

    /// <summary>How deep two shapes overlap: moving the second by Depth * Normal ends the overlap.</summary>
    public struct Penetration {
        public double Depth;
        public Vector3 Normal;
    }

    /// <summary>When and where two moving shapes meet.</summary>
    public struct Impact {
        /// <summary>When they are within the tolerance and about to touch; the gap then. Negative: how deep they overlap, from the start.</summary>
        public double Time, Distance;
        /// <summary>Points on the surfaces; the unit normal from the first to the second.</summary>
        public Vector3 OnA, OnB, Normal;
        /// <summary>True if MaxSteps was too small: they do not touch before Time.</summary>
        public bool IsUnresolved;
    }

    /// <summary>The first point of a shape on a ray.</summary>
    public struct ShapeRayHit {
        public double T;
        public Vector3 Point;
        /// <summary>Unit, towards the ray's origin; 0 if the ray began inside.</summary>
        public Vector3 Normal;
        public Part Part;
        public bool StartedInside;
    }

    /// <summary>A solid or a surface. It never changes; what uses it keeps what it needs of it. Solids of revolution have y as axis, with the
    /// origin half way up.</summary>
    public sealed class Shape : IDisposable {
        internal readonly ShapeHandle Handle;
        delegate void Fill(ref Native.ShapeDescriptionData data, Copies memory);

        Shape(uint kind, Fill fill) {
            Library.Load();
            using (var memory = new Copies()) {
                Native.ShapeDescriptionData data = Native.crofton_default_shape_description();
                data.Kind = kind;
                fill(ref data, memory);
                Library.Check(Native.crofton_shape_create(ref data, out Handle));
            }
        }
        /// <summary>Frees the shape; a World, compound or rounded shape that uses it keeps what it needs.</summary>
        public void Dispose() { Handle.Dispose(); }

        static Shape Round(uint kind, float radius, float halfHeight) {
            return new Shape(kind, (ref Native.ShapeDescriptionData d, Copies m) => { d.Radius = radius; d.HalfHeight = halfHeight; });
        }
        public static Shape Sphere(float radius) { return Round(Native.ShapeSphere, radius, 0); }
        /// <summary>A capsule; halfHeight is without its caps.</summary>
        public static Shape Capsule(float radius, float halfHeight) { return Round(Native.ShapeCapsule, radius, halfHeight); }
        public static Shape Cylinder(float radius, float halfHeight) { return Round(Native.ShapeCylinder, radius, halfHeight); }
        /// <summary>A cone, its tip up.</summary>
        public static Shape Cone(float radius, float halfHeight) { return Round(Native.ShapeCone, radius, halfHeight); }
        public static Shape Box(Float3 halfExtents) {
            return new Shape(Native.ShapeBox, (ref Native.ShapeDescriptionData d, Copies m) => d.HalfExtents = halfExtents);
        }
        /// <summary>A triangle, its corners counter-clockwise seen from the front.</summary>
        public static Shape Triangle(Float3 a, Float3 b, Float3 c) {
            return new Shape(Native.ShapeTriangle, (ref Native.ShapeDescriptionData d, Copies m) => {
                d.CornersA = a;
                d.CornersB = b;
                d.CornersC = c;
            });
        }
        /// <summary>The convex hull of points, x, y, z each. One with more than maxVertices, 4 to 256, is replaced by a larger one.</summary>
        public static Shape Hull(float[] points, uint maxVertices = 256) {
            UIntPtr count = Copies.Triples(points, "points");
            return new Shape(Native.ShapeHull, (ref Native.ShapeDescriptionData d, Copies memory) => {
                d.Points = memory.Pinned(points);
                d.PointCount = count;
                d.MaxVertices = maxVertices;
            });
        }
        /// <summary>The points x with dot(normal, x) + offset at least 0; the normal has any length but 0.</summary>
        public static Shape HalfSpace(Vector3 normal, double offset) {
            return new Shape(Native.ShapeHalfSpace, (ref Native.ShapeDescriptionData d, Copies m) => { d.PlaneNormal = normal; d.PlaneOffset = offset; });
        }
        /// <summary>The surface of triangles: x, y, z of each vertex, three indices per triangle. frontOnly: contacts push to the front only, and
        /// casts from behind pass.</summary>
        public static Shape Mesh(float[] positions, uint[] indices, bool frontOnly = false) {
            return new Shape(Native.ShapeMesh, (ref Native.ShapeDescriptionData d, Copies memory) => {
                d.Mesh = memory.Copied(memory.Of(positions, indices));
                d.FrontOnly = frontOnly ? 1u : 0u;
            });
        }
        /// <summary>A grid: corner (i, j) is at (i spacingX, heights[j, i], j spacingZ). materials: of the cells, 255 is a hole; null: all 0.
        /// frontOnly, for up, as in Mesh.</summary>
        public static Shape HeightField(float[,] heights, double spacingX = 1, double spacingZ = 1, byte[,] materials = null, bool frontOnly = false) {
            Library.NotNull(heights, "heights");
            int rows = heights.GetLength(0), columns = heights.GetLength(1);
            if (materials != null && (materials.GetLength(0) != rows - 1 || materials.GetLength(1) != columns - 1))
                throw new ArgumentException("there is one material for each cell", "materials");
            return new Shape(Native.ShapeHeightField, (ref Native.ShapeDescriptionData d, Copies memory) => {
                d.HeightField = memory.Copied(new Native.HeightFieldData {
                    Size = Native.SizeOf<Native.HeightFieldData>(), Columns = (uint)columns, Rows = (uint)rows, Heights = memory.Pinned(heights),
                    Materials = materials == null ? IntPtr.Zero : memory.Pinned(materials), SpacingX = spacingX, SpacingZ = spacingZ
                });
                d.FrontOnly = frontOnly ? 1u : 0u;
            });
        }
        /// <summary>The points no farther than a radius from a convex shape other than a half-space.</summary>
        public static Shape Rounded(Shape core, float radius) {
            Library.NotNull(core, "core");
            return new Shape(Native.ShapeRounded, (ref Native.ShapeDescriptionData d, Copies memory) => {
                d.Core = memory.Held(core.Handle);
                d.Radius = radius;
            });
        }
        /// <summary>Several shapes as one.</summary>
        public static Shape Compound(params Placed[] children) {
            Library.NotNull(children, "children");
            return new Shape(Native.ShapeCompound, (ref Native.ShapeDescriptionData d, Copies memory) => {
                d.Children = memory.Pinned(children.Select(c => memory.Held(c.Given.Handle)).ToArray());
                d.Poses = memory.Pinned(children.Select(c => c.Pose).ToArray());
                d.ChildCount = (UIntPtr)children.Length;
            });
        }

        /// <summary>Returns the shape at a pose: a rotation and a translation.</summary>
        public Placed At(Transform pose) { return new Placed { Shape = this, Pose = pose }; }
        /// <summary>Returns the box along the axes that contains the shape in its frame; infinite for half-spaces.</summary>
        public void Bounds(out Vector3 min, out Vector3 max) {
            var info = new Native.ShapeInfo { Size = Native.SizeOf<Native.ShapeInfo>() };
            Library.Check(Native.crofton_shape_get_info(Handle, ref info));
            min = info.Min;
            max = info.Max;
        }
        /// <summary>Returns the mass properties. Error: surfaces have no mass.</summary>
        public MassProperties Mass() {
            var m = new Native.MassPropertiesData { Size = Native.SizeOf<Native.MassPropertiesData>() };
            Library.Check(Native.crofton_shape_get_mass(Handle, ref m));
            return new MassProperties { Volume = m.Volume, Center = m.Center, Inertia0 = m.Inertia0, Inertia1 = m.Inertia1, Inertia2 = m.Inertia2 };
        }
    }

    /// <summary>A shape at a pose. All queries are exact where they say yes or no; touching counts.</summary>
    public struct Placed {
        public Shape Shape;
        public Transform Pose;
        internal Shape Given {
            get {
                Library.NotNull(Shape, "Shape");
                return Shape;
            }
        }

        delegate int Query(ref Native.PlacedData a, ref Native.PlacedData b);
        static void Ask(Placed a, Placed b, Query query) {
            using (var memory = new Copies()) {
                Native.PlacedData first = memory.Of(a), second = memory.Of(b);
                Library.Check(query(ref first, ref second));
            }
        }
        /// <summary>Tests whether the shapes share a point.</summary>
        public bool Touches(Placed other) {
            int meet = 0;
            Ask(this, other, (ref Native.PlacedData a, ref Native.PlacedData b) => Native.crofton_shapes_meet(ref a, ref b, IntPtr.Zero, out meet));
            return meet != 0;
        }
        /// <summary>Returns the distance, 0 if the shapes overlap, and the nearest points.</summary>
        public double Distance(Placed other, out Vector3 onA, out Vector3 onB) {
            var data = new Native.ShapeDistanceData { Size = Native.SizeOf<Native.ShapeDistanceData>() };
            Ask(this, other, (ref Native.PlacedData a, ref Native.PlacedData b) => Native.crofton_shapes_distance(ref a, ref b, IntPtr.Zero, ref data));
            onA = data.OnA;
            onB = data.OnB;
            return data.Distance;
        }
        /// <summary>Returns how deep the shapes overlap; null if they do not.</summary>
        public Penetration? Penetration(Placed other) {
            var data = new Native.ShapePenetrationData { Size = Native.SizeOf<Native.ShapePenetrationData>() };
            Ask(this, other, (ref Native.PlacedData a, ref Native.PlacedData b) => Native.crofton_shapes_penetration(ref a, ref b, IntPtr.Zero, ref data));
            return data.Overlapping == 0 ? (Penetration?)null : new Penetration { Depth = data.Depth, Normal = data.Normal };
        }
        /// <summary>Returns where the shapes touch: up to maxPoints points, 1 to 8; none if they are farther apart than a margin.</summary>
        public ShapeContact Contacts(Placed other, double margin = 0, uint maxPoints = 4) {
            var options = new Native.ManifoldOptionsData { Size = Native.SizeOf<Native.ManifoldOptionsData>(), Margin = margin, MaxPoints = maxPoints };
            var data = new Native.ShapeManifoldData { Size = Native.SizeOf<Native.ShapeManifoldData>() };
            Ask(this, other, (ref Native.PlacedData a, ref Native.PlacedData b) => Native.crofton_shapes_manifold(ref a, ref b, ref options, IntPtr.Zero, ref data));
            return new ShapeContact { Normal = data.Normal, Depth = data.Depth, Points = data.Points.Take((int)data.PointCount).ToArray() };
        }
        /// <summary>Returns the distance of a point, 0 inside a solid, and the nearest point of the shape.</summary>
        public double ClosestPoint(Vector3 point, out Vector3 onShape) {
            var data = new Native.ShapeDistanceData { Size = Native.SizeOf<Native.ShapeDistanceData>() };
            using (var memory = new Copies()) {
                Native.PlacedData placed = memory.Of(this);
                Library.Check(Native.crofton_shape_closest_point(ref placed, ref point, ref data));
            }
            onShape = data.OnB; // a is the point
            return data.Distance;
        }
        /// <summary>Returns when this shape, moving, first touches another; null if it does not in that time.</summary>
        public Impact? Cast(Motion motion, Placed other, Motion otherMotion = default(Motion), CastOptions options = null) {
            var given = CastOptions.Data(options);
            var data = new Native.ImpactData { Size = Native.SizeOf<Native.ImpactData>() };
            Ask(this, other, (ref Native.PlacedData a, ref Native.PlacedData b) => Native.crofton_shapes_cast(ref a, ref motion, ref b, ref otherMotion, ref given, ref data));
            if (data.Result == Native.CastMiss) return null;
            return new Impact {
                Time = data.Time, Distance = data.Distance, OnA = data.OnA, OnB = data.OnB, Normal = data.Normal,
                IsUnresolved = data.Result == Native.CastUnresolved
            };
        }
        /// <summary>Returns the first hit of a ray; null if it misses. Triangles, meshes and height fields have no inside.</summary>
        public ShapeRayHit? Raycast(Ray ray) {
            var data = new Native.ShapeRayHitData { Size = Native.SizeOf<Native.ShapeRayHitData>() };
            using (var memory = new Copies()) {
                Native.PlacedData placed = memory.Of(this);
                Library.Check(Native.crofton_shape_raycast(ref placed, ref ray, ref data));
            }
            if (double.IsInfinity(data.T)) return null;
            return new ShapeRayHit { T = data.T, Point = data.Point, Normal = data.Normal, Part = data.Part, StartedInside = data.StartedInside != 0 };
        }
    }

    /// <summary>A contact point of two shapes. Features and parts stay the same while the same features touch.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ShapePoint {
        /// <summary>Midway between the surfaces, in the world.</summary>
        public Vector3 Position;
        /// <summary>Along the normal; negative: a gap.</summary>
        public double Depth;
        public Feature OnA, OnB;
        public Part PartA, PartB;
    }

    /// <summary>Where two shapes touch: their deepest contact. Normal is a unit vector from the first to the second.</summary>
    public sealed class ShapeContact {
        public Vector3 Normal;
        public double Depth;
        public ShapePoint[] Points;
    }

    /// <summary>The first object that a moving shape meets.</summary>
    public struct ShapeHit {
        public ObjectHandle Object;
        public ulong User;
        /// <summary>When they are within the tolerance and about to touch; the gap then. Negative: how deep they overlap, from the start.</summary>
        public double Time, Distance;
        /// <summary>Unit, from the shape to the object; a point on the object's surface.</summary>
        public Vector3 Normal, Point;
        /// <summary>The triangle of the object's mesh or its shape's surface, uint.MaxValue where there is none; the child of a compound.</summary>
        public uint Triangle, Child;
        /// <summary>True if MaxSteps was too small: the shape meets nothing before Time.</summary>
        public bool IsUnresolved;
    }

    /// <summary>Where a shape touches an object, in one direction. The contact's normal leads from the shape to the object.</summary>
    public sealed class ObjectManifold {
        public ObjectHandle Object;
        public ulong User;
        public ShapeContact Contact;
    }

    public sealed partial class World {
        /// <summary>Adds an object with only a shape, under a node or in the world. Half-spaces, and compounds that contain some, are infinite
        /// ground. The transform scales the shape.</summary>
        public ObjectHandle Add(Shape shape, Transform transform, ulong user = 0, NodeHandle? node = null, uint layers = AllLayers, uint collidesWith = AllLayers,
                                bool hidden = false) {
            Library.NotNull(shape, "shape");
            using (var memory = new Copies()) {
                var data = Describe(user, layers, collidesWith, hidden);
                data.Shape = memory.Held(shape.Handle);
                data.HasNode = Flag(node.HasValue);
                data.Node = node.GetValueOrDefault();
                return Add(data, transform, (ref Native.ObjectData d, IntPtr p) => d.Transform = p);
            }
        }
        /// <summary>Sets the shape of an object: rays, casts and contacts use it in place of the mesh or bound. Null removes it; not of one that was
        /// added with only a shape.</summary>
        public void SetShape(ObjectHandle handle, Shape shape) {
            using (var memory = new Copies()) {
                IntPtr raw = shape == null ? IntPtr.Zero : memory.Held(shape.Handle);
                Set(handle, Native.SetShape, (ref Native.ObjectData d) => d.Shape = raw);
            }
        }
        /// <summary>The objects that overlap a shape other than a half-space.</summary>
        public ObjectRef[] Overlap(Placed shape, QueryFilter filter = null) {
            using (var memory = new Copies()) return Overlap(memory.Probe(shape), filter);
        }
        /// <summary>The object nearest to a shape, no farther than a distance; null where there is none.</summary>
        public Closest? Closest(Placed shape, double maxDistance = double.PositiveInfinity, QueryFilter filter = null) {
            using (var memory = new Copies()) return Closest(memory.Probe(shape), maxDistance, filter);
        }
        /// <summary>Finds the first object that a moving shape meets; the objects are at rest. Null where there is none.</summary>
        public ShapeHit? Cast(Placed shape, Motion motion, CastOptions options = null, QueryFilter filter = null) {
            var given = CastOptions.Data(options);
            var data = new Native.ShapeHitData { Size = Native.SizeOf<Native.ShapeHitData>() };
            Ask(shape, filter, (ref Native.PlacedData placed, ref Native.QueryFilterData accepted) =>
                Native.crofton_world_cast(Handle, ref placed, ref motion, ref given, ref accepted, ref data));
            if (data.Object.Index == uint.MaxValue) return null;
            return HitOf(data);
        }
        /// <summary>Lists the first hit of each object that a moving shape meets, in order of Time, then of index.</summary>
        public ShapeHit[] CastAll(Placed shape, Motion motion, CastOptions options = null, QueryFilter filter = null) {
            var given = CastOptions.Data(options);
            using (var found = Find()) {
                IntPtr hits;
                UIntPtr count;
                Ask(shape, filter, (ref Native.PlacedData placed, ref Native.QueryFilterData accepted) =>
                    Native.crofton_world_cast_all(Handle, ref placed, ref motion, ref given, ref accepted, found));
                Library.Check(Native.crofton_found_shape_hits(found, out hits, out count));
                return Library.ToArray<Native.ShapeHitData>(hits, count).Select(HitOf).ToArray();
            }
        }
        /// <summary>Lists where a shape, which need not be an object, touches the objects, up to a margin, in order of index: up to maxPoints points a
        /// direction, 1 to 8.</summary>
        public ObjectManifold[] ContactManifolds(Placed shape, double margin = 0, uint maxPoints = 4, QueryFilter filter = null) {
            var options = new Native.ManifoldOptionsData { Size = Native.SizeOf<Native.ManifoldOptionsData>(), Margin = margin, MaxPoints = maxPoints };
            using (var found = Find()) {
                IntPtr manifolds;
                UIntPtr count;
                Ask(shape, filter, (ref Native.PlacedData placed, ref Native.QueryFilterData accepted) =>
                    Native.crofton_world_manifolds(Handle, ref placed, ref options, ref accepted, found));
                Library.Check(Native.crofton_found_manifolds(found, out manifolds, out count));
                var result = new ObjectManifold[(int)count];
                for (int i = 0; i < result.Length; ++i) {
                    var m = Marshal.PtrToStructure<Native.ObjectManifoldData>(new IntPtr(manifolds.ToInt64() + (long)i * Marshal.SizeOf(typeof(Native.ObjectManifoldData))));
                    result[i] = new ObjectManifold {
                        Object = m.Object, User = m.User,
                        Contact = new ShapeContact { Normal = m.Normal, Depth = m.Depth, Points = m.Points.Take((int)m.PointCount).ToArray() }
                    };
                }
                return result;
            }
        }
        delegate int Question(ref Native.PlacedData placed, ref Native.QueryFilterData accepted);
        static void Ask(Placed shape, QueryFilter filter, Question question) {
            using (var memory = new Copies()) {
                Native.PlacedData placed = memory.Of(shape);
                Native.QueryFilterData accepted = memory.Of(filter);
                Library.Check(question(ref placed, ref accepted));
            }
        }
        static ShapeHit HitOf(Native.ShapeHitData data) {
            return new ShapeHit {
                Object = data.Object, User = data.User, Time = data.Time, Distance = data.Distance, Normal = data.Normal, Point = data.Point,
                Triangle = data.Triangle, Child = data.Child, IsUnresolved = data.Result == Native.CastUnresolved
            };
        }
    }
}
