// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>A point or a direction, in right-handed world coordinates.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Vector3 : IEquatable<Vector3> {
        public double X, Y, Z;
        public Vector3(double x, double y, double z) { X = x; Y = y; Z = z; }
        public bool Equals(Vector3 other) { return X == other.X && Y == other.Y && Z == other.Z; }
        public override bool Equals(object other) { return other is Vector3 && Equals((Vector3)other); }
        public override int GetHashCode() { return X.GetHashCode() ^ (Y.GetHashCode() << 1) ^ (Z.GetHashCode() << 2); }
        public override string ToString() { return "(" + X + ", " + Y + ", " + Z + ")"; }
    }

    /// <summary>Three unit or column vectors of single precision.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Float3 {
        public float X, Y, Z;
        public Float3(float x, float y, float z) { X = x; Y = y; Z = z; }
    }

    /// <summary>An oriented box: the points Center + sum t_k HalfExtents_k Axis_k with |t_k| at most 1.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Obb {
        public Vector3 Center;
        /// <summary>Unit vectors.</summary>
        public Float3 Axis0, Axis1, Axis2;
        /// <summary>At least 0.</summary>
        public Float3 HalfExtents;

        /// <summary>Returns a box along the coordinate axes.</summary>
        public static Obb Aligned(Vector3 center, Float3 halfExtents) {
            return new Obb {
                Center = center, Axis0 = new Float3(1, 0, 0), Axis1 = new Float3(0, 1, 0), Axis2 = new Float3(0, 0, 1),
                HalfExtents = halfExtents
            };
        }
        /// <summary>Throws if the box is invalid.</summary>
        public void Validate() {
            Library.Load();
            Library.Check(Native.crofton_boxes_validate(new[] { this }, (UIntPtr)1));
        }
        /// <summary>Returns a box that contains this one under a transform.</summary>
        public Obb Transformed(Transform transform) {
            Library.Load();
            Obb result;
            Library.Check(Native.crofton_box_transform(ref transform, ref this, out result));
            return result;
        }
        /// <summary>Tests whether two boxes share a point, exactly; touching counts.</summary>
        public static bool Touches(Obb a, Obb b) {
            Library.Load();
            int meet;
            Library.Check(Native.crofton_boxes_meet(ref a, ref b, out meet));
            return meet != 0;
        }
        /// <summary>Returns the distance of two boxes, 0 if they overlap.</summary>
        public static double Distance(Obb a, Obb b, out Vector3 onA, out Vector3 onB) {
            Library.Load();
            double distance;
            Library.Check(Native.crofton_boxes_distance(ref a, ref b, out distance, out onA, out onB));
            return distance;
        }
        /// <summary>Returns where two boxes touch, at most eight points; null if they do not. Moving b by depth times normal ends the contact.</summary>
        public static ContactPoint[] Contacts(Obb a, Obb b, out Vector3 normal, out double depth) {
            Library.Load();
            var data = new Native.ManifoldData { Size = Native.SizeOf<Native.ManifoldData>(), Points = new ContactPoint[8] };
            Library.Check(Native.crofton_boxes_manifold(ref a, ref b, ref data));
            normal = data.Normal;
            depth = data.Depth;
            if (data.PointCount == 0) return null;
            Array.Resize(ref data.Points, (int)data.PointCount);
            return data.Points;
        }
        /// <summary>Returns the t at which the ray enters the box: 0 if it begins inside, null if it misses.</summary>
        public double? Enters(Ray ray) {
            Library.Load();
            double t;
            Library.Check(Native.crofton_box_raycast(ref this, ref ray, out t));
            return double.IsInfinity(t) ? (double?)null : t;
        }
    }

    /// <summary>The map x -> C0 x.X + C1 x.Y + C2 x.Z + Translation.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Transform {
        public Vector3 C0, C1, C2, Translation;
        /// <summary>Returns a translation.</summary>
        public static Transform At(double x, double y, double z) {
            return new Transform {
                C0 = new Vector3(1, 0, 0), C1 = new Vector3(0, 1, 0), C2 = new Vector3(0, 0, 1), Translation = new Vector3(x, y, z)
            };
        }
        /// <summary>The identity.</summary>
        public static readonly Transform Identity = At(0, 0, 0);
    }

    /// <summary>The points Origin + t Direction with t from 0 to MaxT, which may be infinite.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Ray {
        public Vector3 Origin, Direction;
        public double MaxT;
        public Ray(Vector3 origin, Vector3 direction, double maxT = double.PositiveInfinity) {
            Origin = origin;
            Direction = direction;
            MaxT = maxT;
        }
    }

    /// <summary>A right-handed camera. Angles are in radians.</summary>
    public sealed class Camera {
        public Vector3 Position, Forward, Up;
        /// <summary>The full height of the view volume of an orthographic camera; 0: a perspective camera.</summary>
        public double OrthographicHeight;
        /// <summary>The full vertical angle of a perspective camera.</summary>
        public double FovY;
        /// <summary>Width over height; the distances of the near and far planes. The far distance may be infinite in perspective.</summary>
        public double Aspect, Near, Far;

        /// <summary>Returns a camera at the origin that looks along -z: 60 degrees, 16:9, from 0.1 to 1000.</summary>
        public Camera() {
            Library.Load();
            Native.CameraData c = Native.crofton_default_camera();
            Position = c.Position;
            Forward = c.Forward;
            Up = c.Up;
            FovY = c.FovY;
            Aspect = c.Aspect;
            Near = c.Near;
            Far = c.Far;
        }
        internal Native.CameraData Data() {
            return new Native.CameraData {
                Size = Native.SizeOf<Native.CameraData>(), Position = Position, Forward = Forward, Up = Up,
                Projection = OrthographicHeight != 0 ? 1u : 0u, FovY = FovY, Height = OrthographicHeight, Aspect = Aspect, Near = Near,
                Far = Far
            };
        }
        /// <summary>Returns the frustum of this camera.</summary>
        public Frustum Frustum() {
            var data = Data();
            var frustum = new Frustum();
            Library.Check(Native.crofton_frustum_from_camera(ref data, ref frustum.Data));
            return frustum;
        }
    }

    /// <summary>The depth range of a projection matrix.</summary>
    public enum DepthRange { ReversedZeroToOne = 0, ZeroToOne = 1, MinusOneToOne = 2 }

    /// <summary>How a box lies relative to a frustum.</summary>
    public enum Verdict : byte { Outside = 0, Straddling = 1, Inside = 2 }

    /// <summary>A convex volume: up to twelve half-spaces.</summary>
    public sealed class Frustum {
        internal Native.FrustumData Data;
        internal Frustum() {
            Library.Load();
            Data = new Native.FrustumData { Size = Native.SizeOf<Native.FrustumData>(), Planes = new double[4 * Native.MaxPlanes] };
        }
        /// <summary>Makes a frustum of a column-major matrix that takes column vectors relative to the origin to clip space.</summary>
        public static Frustum FromMatrix(double[] toClip, DepthRange depth, Vector3 origin) {
            Library.NotNull(toClip, "toClip");
            if (toClip.Length != 16) throw new ArgumentException("a matrix has 16 numbers", "toClip");
            var frustum = new Frustum();
            Library.Check(Native.crofton_frustum_from_matrix(toClip, (uint)depth, ref origin, ref frustum.Data));
            return frustum;
        }
        /// <summary>Returns the exact verdict of each box.</summary>
        public Verdict[] Classify(Obb[] boxes) {
            Library.NotNull(boxes, "boxes");
            var bytes = new byte[boxes.Length];
            Library.Check(Native.crofton_classify(ref Data, boxes, (UIntPtr)boxes.Length, bytes));
            return Array.ConvertAll(bytes, b => (Verdict)b);
        }
    }
}
