// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>The quantity that a box minimises: VolumeWeight V + AreaWeight F + MeanCurvatureWeight M. Weights are at least 0
    /// and not all 0.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Criterion {
        public double VolumeWeight, AreaWeight, MeanCurvatureWeight;

        /// <summary>The sum of the edges: for frusta that are large compared with the objects.</summary>
        public static Criterion MinimalPerimeter() {
            Library.Load();
            return Native.crofton_default_fit_options().Criterion;
        }
        /// <summary>Minimises the expected number of hits by rays and segments of this length.</summary>
        public static Criterion ForRays(double length) {
            Library.Load();
            Criterion criterion;
            Library.Check(Native.crofton_criterion_for_rays(length, out criterion));
            return criterion;
        }
        /// <summary>Minimises the expected number of boxes in the camera's frustum; its far distance must be finite.</summary>
        public static Criterion ForFrustum(Camera camera) {
            Library.NotNull(camera, "camera");
            var data = camera.Data();
            Criterion criterion;
            Library.Check(Native.crofton_criterion_for_frustum(ref data, out criterion));
            return criterion;
        }
    }

    /// <summary>The effort to fit a box: two passes over the points; convex hull and local search; the global optimum.</summary>
    public enum Quality : uint { Fast = 0, Tight = 1, Exact = 2 }

    /// <summary>Fits boxes around points.</summary>
    public static class Fit {
        /// <summary>Returns a box that contains every point (x, y, z each), the best by the criterion; null: the sum of the edges.</summary>
        public static Obb Box(float[] points, Quality quality = Quality.Tight, Criterion? criterion = null) {
            var options = Options(points, quality, criterion);
            Obb box;
            Library.Check(Native.crofton_fit_points(points, (UIntPtr)(points.Length / 3), 0, ref options, out box));
            return box;
        }
        /// <summary>The same in double precision.</summary>
        public static Obb Box(double[] points, Quality quality = Quality.Tight, Criterion? criterion = null) {
            var options = Options(points, quality, criterion);
            Obb box;
            Library.Check(Native.crofton_fit_points(points, (UIntPtr)(points.Length / 3), 1, ref options, out box));
            return box;
        }
        /// <summary>Returns a box that contains all the boxes.</summary>
        public static Obb Box(Obb[] boxes, Criterion? criterion = null) {
            Library.NotNull(boxes, "boxes");
            Criterion given = criterion ?? Criterion.MinimalPerimeter();
            Obb box;
            Library.Check(Native.crofton_fit_boxes(boxes, (UIntPtr)boxes.Length, ref given, out box));
            return box;
        }
        static Native.FitOptionsData Options(Array points, Quality quality, Criterion? criterion) {
            Library.NotNull(points, "points");
            if (points.Length % 3 != 0) throw new ArgumentException("points are x, y, z each", "points");
            return new Native.FitOptionsData {
                Size = Native.SizeOf<Native.FitOptionsData>(), Quality = (uint)quality,
                Criterion = criterion ?? Criterion.MinimalPerimeter()
            };
        }
    }

    /// <summary>The method of a triangulation: ear clipping, the fastest; constrained Delaunay; minimum total length of the diagonals.</summary>
    public enum Method : uint { Ear = 0, Delaunay = 1, MinimumWeight = 2 }

    /// <summary>A triangulated polygon.</summary>
    public sealed class Triangulation {
        /// <summary>Three indices of points per triangle, counter-clockwise.</summary>
        public int[] Indices;
        /// <summary>The total length of the diagonals.</summary>
        public double Weight;
        /// <summary>A proved bound of (weight - minimum) / minimum; infinite if unknown.</summary>
        public double Gap;
        /// <summary>True if the weight is proved to be minimal.</summary>
        public bool IsOptimal;
    }

    /// <summary>Triangulates polygons; keeps its memory from one polygon to the next. Use it from one thread at a time.</summary>
    public sealed class Triangulator : IDisposable {
        readonly TriangulatorHandle handle;
        public Triangulator() {
            Library.Load();
            Library.Check(Native.crofton_triangulator_create(out handle));
        }
        public void Dispose() { handle.Dispose(); }

        /// <summary>Triangulates a polygon. Points are x, y each. Ring r is the points from ringEnds[r - 1] to before ringEnds[r]; the first ring is the
        /// outer one, the others are holes; null: all points are one ring.</summary>
        public Triangulation Triangulate(double[] points, uint[] ringEnds = null, Method method = Method.MinimumWeight) {
            Library.NotNull(points, "points");
            if (points.Length % 2 != 0) throw new ArgumentException("points are x, y each", "points");
            ringEnds = ringEnds ?? new[] { (uint)(points.Length / 2) };
            var p = GCHandle.Alloc(points, GCHandleType.Pinned);
            var r = GCHandle.Alloc(ringEnds, GCHandleType.Pinned);
            try {
                var polygon = new Native.PolygonData {
                    Size = Native.SizeOf<Native.PolygonData>(), Points = p.AddrOfPinnedObject(), PointCount = (UIntPtr)(points.Length / 2),
                    RingEnds = r.AddrOfPinnedObject(), RingCount = (UIntPtr)ringEnds.Length
                };
                var data = new Native.TriangulationData { Size = Native.SizeOf<Native.TriangulationData>() };
                Library.Check(Native.crofton_triangulate(handle, ref polygon, (uint)method, ref data));
                var indices = new int[3 * (int)data.TriangleCount];
                if (indices.Length > 0) Marshal.Copy(data.Indices, indices, 0, indices.Length);
                GC.KeepAlive(this); // the indices are in the triangulator's memory
                return new Triangulation { Indices = indices, Weight = data.Weight, Gap = data.Gap, IsOptimal = data.Optimal != 0 };
            } finally {
                p.Free();
                r.Free();
            }
        }
    }
}
