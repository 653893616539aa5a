// SPDX-License-Identifier: MIT
using System;
using System.Collections.Generic;
using System.Linq;
using Crofton;

static class BoxTests {
    static Obb[] Row(int count, double gap) {
        return Enumerable.Range(0, count).Select(i => Obb.Aligned(new Vector3(gap * i, 0, 0), new Float3(1, 1, 1))).ToArray();
    }

    [Test] static void ManyObjectsAreAddedAtOnceAndThoseThatAreRefusedAreNamed() {
        using (var world = new World()) {
            world.Reserve(1000);
            Expect.Throws<ArgumentOutOfRangeException>(() => world.Reserve(-1));
            Bound[] bounds = Enumerable.Range(0, 1000).Select(i => Bound.Sphere(new Vector3(i, 0, 0), 0.25)).ToArray();
            var objects = new ObjectHandle[1000];
            world.AddMany(bounds, objects, Enumerable.Range(0, 1000).Select(i => (ulong)i).ToArray(), layers: 2);
            world.Update(2);
            Expect.Equal(1000, world.Count);
            for (int i = 0; i < 1000; ++i) {
                Expect.Equal((ulong)i, world.User(objects[i]));
                Expect.Equal((double)i, world.Box(objects[i]).Center.X);
            }
            var ray = new Ray(new Vector3(-5, 0, 0), new Vector3(1, 0, 0));
            Expect.True(world.RaycastAny(ray, 2) && !world.RaycastAny(ray, 1));
            bounds = new[] { bounds[0], Bound.Sphere(new Vector3(double.NaN, 0, 0), 1), bounds[2] };
            objects = new ObjectHandle[3];
            Expect.Equal(1ul, Expect.Fails(Status.NonFinite, () => world.AddMany(bounds, objects)).Item.Value);
            Expect.Equal(1002, world.Count);
            Expect.True(world.Contains(objects[0]) && !world.Contains(objects[1]) && world.Contains(objects[2]));
            Expect.Throws<ArgumentException>(() => world.AddMany(bounds, new ObjectHandle[2]));
            Expect.Throws<ArgumentException>(() => world.AddMany(bounds, objects, new ulong[2]));
        }
    }
    [Test] static void UpdatesHaveTheSameResultOnAnyNumberOfThreads() {
        var boxes = new Obb[5000];
        var random = new Random(7);
        for (int i = 0; i < boxes.Length; ++i)
            boxes[i] = Obb.Aligned(new Vector3(40 * random.NextDouble(), 40 * random.NextDouble(), 40 * random.NextDouble()), new Float3(1, 1, 1));
        List<ulong> expected = null;
        foreach (int threads in new[] { 1, 2, 5 })
            using (var world = new World()) {
                world.AddMany(boxes.Select(Bound.Box).ToArray(), new ObjectHandle[boxes.Length]);
                world.Update(threads);
                List<ulong> pairs = world.Pairs().Select(p => ((ulong)p.First.Object.Index << 32) + p.Second.Object.Index).ToList();
                Expect.True(pairs.Count > 1000);
                Expect.True(expected == null || pairs.SequenceEqual(expected));
                expected = pairs;
                Expect.Throws<ArgumentOutOfRangeException>(() => world.Update(0));
            }
    }
    [Test] static void PairsOfBoxesBeginStayAndEndWithoutAWorld() {
        using (var broadphase = new Broadphase()) {
            broadphase.Update(Row(4, 1.5));
            Expect.Sequence(new[] { "0 1", "1 2", "2 3" }, Text(broadphase.Pairs(Pairs.Began)));
            Filter one = new Filter { Layers = 1, CollidesWith = 1 }, two = new Filter { Layers = 2, CollidesWith = 2 };
            broadphase.Update(Row(4, 1.5), new[] { one, two, two, one }, 2);
            Expect.Sequence(new[] { "1 2" }, Text(broadphase.Pairs(Pairs.Stayed)));
            Expect.Sequence(new[] { "0 1", "2 3" }, Text(broadphase.Pairs(Pairs.Ended)));
            Expect.Throws<ArgumentException>(() => broadphase.Update(Row(4, 1.5), new[] { one }));
            broadphase.Update(Row(4, 3));
            Expect.Equal(0, broadphase.Pairs().Length);
        }
    }
    static string[] Text(Pair[] pairs) { return pairs.Select(p => p.First + " " + p.Second).ToArray(); }

    [Test] static void BoxesAloneAreViewedAndLimitsComeFromACamera() {
        Obb[] boxes = Enumerable.Range(0, 100).Select(i => Obb.Aligned(new Vector3(0, 0, 200 - 4 * i), new Float3(0.5f, 0.5f, 0.5f))).ToArray();
        var camera = new Camera();
        Verdict[] verdicts = camera.Frustum().Classify(boxes);
        uint[] expected = Enumerable.Range(0, 100).Where(i => verdicts[i] != Verdict.Outside).Select(i => (uint)i).ToArray();
        Expect.True(expected.Length > 40);
        using (var result = new ViewResult()) {
            Expect.Sequence(expected, result.OfBoxes(boxes, camera));
            uint[] layers = Enumerable.Range(0, 100).Select(i => 1u << i % 2).ToArray();
            Expect.Sequence(expected.Where(i => i % 2 == 0).ToArray(), result.OfBoxes(boxes, new ViewRequest { Camera = camera, Layers = 1 }, layers));
            Expect.Throws<ArgumentException>(() => result.OfBoxes(boxes, camera, new uint[3]));
            Expect.Fails(Status.Unsupported, () => result.OfBoxes(boxes, new ViewRequest { Camera = camera, Occlusion = new OcclusionOptions() }));
            // A sphere around a box has radius sqrt(3) / 2. One pixel of 1000 is d * 2 tan(30 degrees) / 1000 wide at distance d.
            DrawLimits limits = DrawLimits.OfCamera(camera, 1000, 10);
            double farthest = Math.Sqrt(0.75) * 2 * 1000 / (10 * 2 * Math.Tan(Math.PI / 6));
            uint[] near = expected.Where(i => -boxes[i].Center.Z < farthest).ToArray();
            Expect.True(near.Length < expected.Length && near.Length > 10);
            Expect.Sequence(near, result.OfBoxes(boxes, new ViewRequest { Camera = camera, Limits = limits }));
            Expect.Throws<CroftonException>(() => DrawLimits.OfCamera(camera, 1000, -1));
        }
    }
    [Test] static void TwoBoxesTouchAtPointsAndOneBoxGoesAroundMany() {
        Obb[] row = Row(3, 1.5);
        Vector3 normal;
        double depth;
        ContactPoint[] points = Obb.Contacts(row[0], row[1], out normal, out depth);
        Expect.Equal(new Vector3(1, 0, 0), normal);
        Expect.Near(0.5, depth);
        Expect.Equal(4, points.Length);
        Expect.True(points.All(p => Math.Abs(p.Depth - 0.5) < 1e-9 && Math.Abs(Math.Abs(p.Position.Y) - 1) < 1e-9));
        Expect.True(Obb.Contacts(row[0], row[2], out normal, out depth) == null);
        Obb around = Fit.Box(row);
        Expect.Near(1.5, around.Center.X, 1e-5);
        Expect.Near(5 + 2 + 2, 2 * (around.HalfExtents.X + around.HalfExtents.Y + around.HalfExtents.Z), 1e-4);
    }
    [Test] static void ClustersReadArraysThatAreLentAndIndicesArePutInTheirOrder() {
        var corners = new float[] { -3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0 };
        var indices = new uint[] { 0, 1, 2, 0, 2, 3 };
        using (var mesh = new ClusteredMesh(corners, indices, 1)) {
            Clusters clusters = mesh.Clusters();
            uint[] permuted = clusters.Permute(indices);
            Expect.Sequence(clusters.TriangleOrder.SelectMany(t => indices.Skip(3 * (int)t).Take(3)).ToArray(), permuted);
            Expect.Throws<CroftonException>(() => clusters.Permute(new uint[] { 0, 1, 2 }));
            Expect.True(Expect.Fails(Status.InvalidArgument, () => mesh.Lend(corners, new uint[] { 0, 1, 2, 0, 2, 1 }, IndexOrder.Original)).Item.HasValue);
            mesh.Lend(corners, indices, IndexOrder.Original);
            Expect.Equal(2, mesh.Clusters().TriangleOrder.Length);
            mesh.Lend((float[])corners.Clone(), permuted);
            GC.Collect(); // the arrays are pinned
            Expect.Equal(0, mesh.Clusters().TriangleOrder.Length);
            using (var culler = new DepthCuller()) {
                var place = new float[] { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 10 };
                Expect.Equal(2, culler.FindVisible(new[] { new DepthObject { Mesh = mesh, ToClip = place } }, new PictureView { Width = 160, Height = 90 }).Length);
            }
        }
    }
    [Test] static void ALoggerGetsTheMessages() {
        var heard = new List<string>();
        Library.SetLogger((level, message) => heard.Add(level + " " + message));
        GC.Collect();
        Library.Log(LogLevel.Info, "from the game é");
        Library.SetLogger((level, message) => { throw new Exception("does not pass through the library"); });
        var error = Console.Error;
        Console.SetError(System.IO.TextWriter.Null);
        Library.Log(LogLevel.Error, "goes to a logger that throws");
        Console.SetError(error);
        Library.SetLogger(null);
        Library.Log(LogLevel.Info, "not heard");
        Expect.Sequence(new[] { "Info from the game é" }, heard.ToArray());
        Expect.Throws<ArgumentException>(() => Library.Log(LogLevel.Info, "a\0b"));
    }
    [Test] static void OptionsAreThoseOfTheLibraryAndNodesAndMeshesAreContained() {
        using (var world = new World(new WorldOptions { UpdatesToRest = 2, RebuildBudget = 0 })) {
            world.Add(Bound.Sphere(new Vector3(0, 0, 0), 1));
            NodeHandle node = world.AddNode(null, Transform.Identity);
            MeshHandle mesh = world.AddMesh(new float[] { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, null);
            Expect.True(world.Contains(node) && world.Contains(mesh));
            world.FindOccluders(mesh, new FindOptions { IsTwoSided = true, MaxOccluders = 1 });
            world.RemoveNode(node);
            world.RemoveMesh(mesh);
            Expect.True(!world.Contains(node) && !world.Contains(mesh));
            for (int i = 0; i < 4; ++i) world.Update();
            Expect.Equal(1ul, world.Statistics().Resting);
        }
    }
}
