// SPDX-License-Identifier: MIT
using System;
using System.IO;
using System.Linq;
using System.Text.RegularExpressions;
using Crofton;

static class ShapeTests {
    static Obb Cube(double x) { return Obb.Aligned(new Vector3(x, 0, 0), new Float3(0.5f, 0.5f, 0.5f)); }

    [Test] static void BoxesThatTouchMeet() {
        Expect.True(Obb.Touches(Cube(0), Cube(1)));
        Expect.True(!Obb.Touches(Cube(0), Cube(1 + 1e-12)));
    }
    [Test] static void BoxesApartHaveADistance() {
        Vector3 a, b;
        Expect.Near(2, Obb.Distance(Cube(0), Cube(3), out a, out b));
        Expect.Near(0.5, a.X);
        Expect.Near(2.5, b.X);
        Expect.Equal(0.0, Obb.Distance(Cube(0), Cube(0.7), out a, out b));
    }
    [Test] static void ARayEntersABox() {
        var forth = new Vector3(1, 0, 0);
        Expect.Equal((double?)1.5, Cube(0).Enters(new Ray(new Vector3(-2, 0, 0), forth)));
        Expect.Equal((double?)0, Cube(0).Enters(new Ray(new Vector3(0, 0, 0), forth)));
        Expect.Equal((double?)null, Cube(0).Enters(new Ray(new Vector3(0, 2, 0), forth)));
    }
    [Test] static void ABadBoxSaysWhy() {
        var bad = Cube(0);
        bad.Axis0 = new Float3(0, 0, 0);
        Expect.Throws<CroftonException>(bad.Validate);
        Expect.Throws<CroftonException>(() => Obb.Touches(bad, Cube(0)));
        Cube(0).Validate();
    }
    [Test] static void ABoxIsTransformed() {
        Expect.Equal(new Vector3(1, 2, 0), Cube(1).Transformed(Transform.At(0, 2, 0)).Center);
        Expect.Throws<CroftonException>(() => Cube(1).Transformed(Transform.At(double.NaN, 0, 0)));
    }
    [Test] static void AnOrthographicCameraSeesABlock() {
        var camera = new Camera { OrthographicHeight = 2, Aspect = 1 };
        var boxes = new[] { 0.0, 1.2, 1.6 }.Select(x => Obb.Aligned(new Vector3(x, 0, -5), new Float3(0.5f, 0.5f, 0.5f))).ToArray();
        Expect.Sequence(new[] { Verdict.Inside, Verdict.Straddling, Verdict.Outside }, camera.Frustum().Classify(boxes));
    }
    [Test] static void ABadCameraIsAnError() {
        Expect.Throws<CroftonException>(() => new Camera { FovY = 4 }.Frustum());
        Expect.Throws<CroftonException>(() => new Camera { Forward = new Vector3() }.Frustum());
        Expect.Throws<ArgumentException>(() => Frustum.FromMatrix(new double[4], DepthRange.ZeroToOne, new Vector3()));
    }
    [Test] static void AFrustumIsMadeOfAMatrix() {
        var identity = new double[16];
        for (int i = 0; i < 4; ++i) identity[5 * i] = 1;
        var clip = Frustum.FromMatrix(identity, DepthRange.MinusOneToOne, new Vector3());
        Expect.Sequence(new[] { Verdict.Inside, Verdict.Outside }, clip.Classify(new[] { Cube(0), Cube(2.5) }));
    }
    [Test] static void ABoxAroundPointsHoldsThemAndNoMore() {
        var points = Enumerable.Range(0, 24).Select(i => (double)((i / 3 >> i % 3 & 1) * (3 - i % 3))).ToArray();
        foreach (var quality in new[] { Quality.Fast, Quality.Tight, Quality.Exact }) {
            var h = Fit.Box(points, quality).HalfExtents;
            var sides = new[] { 2 * h.X, 2 * h.Y, 2 * h.Z }.OrderBy(s => s).ToArray();
            for (int k = 0; k < 3; ++k) Expect.Near(k + 1, sides[k], 1e-5);
        }
        Expect.Fails(Status.Empty, () => Fit.Box(new float[0]));
        Expect.Throws<ArgumentException>(() => Fit.Box(new float[4]));
    }
    [Test] static void CriteriaComeFromWhatAsks() {
        Expect.True(Criterion.ForRays(10).AreaWeight > 0);
        Expect.True(Criterion.ForFrustum(new Camera { Far = 100 }).MeanCurvatureWeight > 0);
        Expect.Throws<CroftonException>(() => Fit.Box(new float[] { 0, 0, 0, 1, 1, 1 }, Quality.Tight, new Criterion()));
    }
    [Test] static void ASquareIsCutOnce() {
        using (var triangulator = new Triangulator()) {
            var square = new double[] { 0, 0, 1, 0, 1, 1, 0, 1 };
            foreach (Method method in Enum.GetValues(typeof(Method))) {
                var t = triangulator.Triangulate(square, null, method);
                Expect.Equal(6, t.Indices.Length);
                Expect.Near(Math.Sqrt(2), t.Weight);
            }
            Expect.True(triangulator.Triangulate(square).IsOptimal);
        }
    }
    [Test] static void AHoleAddsTriangles() {
        using (var triangulator = new Triangulator()) {
            var t = triangulator.Triangulate(new double[] { 0, 0, 4, 0, 4, 4, 0, 4, 1, 1, 1, 3, 3, 3, 3, 1 }, new uint[] { 4, 8 });
            Expect.Equal(3 * 8, t.Indices.Length); // n + 2 h - 2 triangles
        }
    }
    [Test] static void APolygonThatCrossesItselfIsAnError() {
        using (var triangulator = new Triangulator()) {
            Expect.Throws<CroftonException>(() => triangulator.Triangulate(new double[] { 0, 0, 1, 1, 1, 0, 0, 1 }));
            Expect.Throws<CroftonException>(() => triangulator.Triangulate(new double[0]));
            Expect.Throws<ArgumentException>(() => triangulator.Triangulate(new double[3]));
        }
    }
    [Test] static void EveryDeclaredFunctionIsExported() {
        var root = Environment.GetEnvironmentVariable("CROFTON_ROOT") ?? ".";
        var lists = new[] { "engine/c_api/symbols.txt", "engine/bake/c_api/symbols.txt" }.Select(list => File.ReadAllText(Path.Combine(root, list)));
        var exported = string.Concat(lists).Split((char[])null, StringSplitOptions.RemoveEmptyEntries);
        var source = File.ReadAllText(Path.Combine(root, "bindings/csharp/src/Native.cs"));
        var declared = Regex.Matches(source, @"extern \w+ (crofton_\w+)\(").Cast<Match>().Select(m => m.Groups[1].Value).ToArray();
        Expect.True(declared.Length > 60);
        Expect.Sequence(new string[0], declared.Except(exported).ToArray());
    }
    [Test] static void VersionsAgree() {
        Expect.Equal("0.3.0", Library.Version);
    }
}
