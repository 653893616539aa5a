// SPDX-License-Identifier: MIT
using System;
using System.Collections.Generic;
using System.Linq;
using System.Threading;
using Crofton;

static class WorldTests {
    static readonly float[] Tetrahedron = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    static readonly uint[] Faces = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    static readonly Vector3 Forth = new Vector3(0, 0, -1);

    static Bound Sphere(double x, double y, double z, double radius) { return Bound.Sphere(new Vector3(x, y, z), radius); }

    // Spheres of radius 0.25 along x at 0, 1, 2, …, five units before the default camera.
    static World Row(int count, out ObjectHandle[] objects) {
        var world = new World();
        objects = Enumerable.Range(0, count).Select(i => world.Add(Sphere(i, 0, -5, 0.25), (ulong)i)).ToArray();
        world.Update();
        return world;
    }
    static ulong[] Users(ViewResult visible) { return visible.Objects.Take(visible.Count).Select(o => o.User).ToArray(); }

    [Test] static void AnObjectIsThereFromAddToRemove() {
        ObjectHandle[] o;
        using (var world = Row(3, out o)) {
            Expect.Equal(3, world.Count);
            world.Remove(o[1]);
            Expect.True(!world.Contains(o[1]) && world.Contains(o[2]));
            Expect.Equal(2, world.Count);
        }
    }
    [Test] static void QueriesIgnoreObjects() {
        ObjectHandle[] o;
        using (var world = Row(3, out o))
        using (var shape = Shape.Sphere(0.1f)) {
            var ray = new Ray(new Vector3(-10, 0, -5), new Vector3(1, 0, 0));
            var filter = new QueryFilter { Ignored = new[] { o[0] } };
            Expect.Equal(o[1], world.Raycast(ray, filter).Object);
            Expect.Equal(2, world.RaycastAll(ray, filter).Length);
            Expect.True(!world.RaycastAny(ray, new QueryFilter { Ignored = o }));
            Expect.True(world.RaycastAny(ray, new QueryFilter { Ignored = new ObjectHandle[0] }));
            Expect.Equal(0, world.OverlapSphere(new Vector3(0, 0, -5), 0.1, filter).Length);
            Expect.Equal(o[1], world.ClosestToSphere(new Vector3(0, 0, -5), 0.1, double.PositiveInfinity, filter).Value.Object);
            var motion = new Motion { Velocity = new Vector3(20, 0, 0) };
            Expect.Equal(o[1], world.Cast(shape.At(Transform.At(-10, 0, -5)), motion, null, filter).Value.Object);
        }
    }
    [Test] static void AnObjectInsideAClosedMeshSaysSo() {
        using (var world = new World()) {
            MeshHandle mesh = world.AddMesh(Tetrahedron, Faces);
            world.Add(mesh, Transform.At(0, 0, 0));
            world.Add(mesh, new Transform { C0 = new Vector3(0.1, 0, 0), C1 = new Vector3(0, 0.1, 0), C2 = new Vector3(0, 0, 0.1), Translation = new Vector3(0.1, 0.1, 0.1) });
            NodeHandle node = world.AddNode(null, Transform.At(9, 0, 0));
            world.SetNodeLayers(node, 2);
            world.Add(mesh, Transform.At(0, 0, 0), 7, node);
            world.Update();
            Expect.Equal(Containment.SecondInside, world.Contacts().Single().Inside);
            var ray = new Ray(new Vector3(9.1, 0.1, 5), Forth);
            Expect.True(world.RaycastAny(ray, 2) && !world.RaycastAny(ray, 1));
        }
    }
    // A wall of two triangles in clusters, one behind it, one beside it; three units wide each, ten units and more away.
    static World Walls(out ObjectHandle[] objects, out MeshHandle mesh) {
        var world = new World();
        mesh = world.AddMesh(new float[] { -3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0 }, new uint[] { 0, 1, 2, 0, 2, 3 }, true);
        var wall = mesh;
        objects = new[] { Transform.At(0, 0, -10), Transform.At(0, 0, -40), Transform.At(20, 0, -40) }
            .Select((at, i) => world.Add(wall, at, (ulong)i)).ToArray();
        world.Update();
        return world;
    }
    [Test] static void APictureListsTheTrianglesThatItNeeds() {
        ObjectHandle[] o;
        MeshHandle mesh;
        using (var world = Walls(out o, out mesh))
        using (var visible = new ViewResult()) {
            var request = new ViewRequest { Camera = new Camera(), Picture = new PictureView { Width = 160, Height = 90 } };
            world.View(request, visible);
            Expect.Sequence(new[] { 0ul, 2ul }, Users(visible));
            Expect.Sequence(new[] { o[0].Index, o[2].Index }, visible.Triangles().Select(t => t.Object).ToArray());
            Expect.True(visible.Triangles().All(t => t.Cluster == 0 && t.Triangles == 3));
            Clusters clusters = world.ClustersOf(mesh);
            Expect.Equal(1, clusters.All.Length);
            Expect.Equal(2u, clusters.All[0].TriangleCount);
            Expect.Sequence(new[] { 0u, 1u }, clusters.TriangleOrder.OrderBy(t => t).ToArray());
            Expect.True(world.ClustersOf(world.AddMesh(Tetrahedron, Faces)) == null);
            request.Occlusion = new OcclusionOptions();
            Expect.Fails(Status.InvalidArgument, () => world.View(request, visible));
        }
    }
    [Test] static void ALightListsWhatThrowsAShadowOnWhatTheCameraSees() {
        ObjectHandle[] o;
        MeshHandle mesh;
        using (var world = Walls(out o, out mesh))
        using (var seen = new ViewResult())
        using (var casters = new ViewResult()) {
            var picture = new PictureView { Width = 160, Height = 90 };
            world.View(new ViewRequest { Camera = new Camera(), Picture = picture }, seen);
            var request = new ViewRequest {
                Camera = new Camera { Position = new Vector3(1, 0, 1) }, Picture = picture,
                Receivers = new ShadowReceivers { Seen = seen, Radius = 2 }
            };
            world.View(request, casters);
            Expect.True(Users(casters).Contains(0ul) && !Users(casters).Contains(1ul));
            Expect.True(casters.Triangles().Length > 0);
            Expect.Fails(Status.InvalidArgument, () => world.View(request, seen));
            request.Receivers.Radius = 0;
            Expect.Fails(Status.OutOfRange, () => world.View(request, casters));
            request.Receivers.Radius = 2;
            world.Remove(o[2]);
            Expect.Fails(Status.InvalidArgument, () => world.View(request, casters));
        }
    }
    [Test] static void EachOfManyViewsIsObeyed() {
        ObjectHandle[] o;
        MeshHandle mesh;
        using (var world = Walls(out o, out mesh))
        using (var visible = new ViewResult()) {
            for (int i = 0; i < 40; ++i) world.Update(); // candidates say nothing about what may have moved since
            var camera = new Camera();
            double f = 1 / Math.Tan(camera.FovY / 2), near = camera.Near, far = camera.Far;
            var rows = new[] { f / camera.Aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, near / (far - near), far * near / (far - near), 0, 0, -1, 0 };
            var requests = new[] {
                new ViewRequest { Camera = camera },
                new ViewRequest { Camera = camera, Picture = new PictureView { Width = 160, Height = 90 } },
                new ViewRequest { Camera = camera, Limits = new DrawLimits { MaxDistanceInRadii = 5 } },
                new ViewRequest { Camera = camera, Limits = new DrawLimits { ItemDistances = new[] { 1f, 100f, 1f } } },
                new ViewRequest { Camera = camera, CandidateMask = new[] { 2ul } },
                new ViewRequest { Matrix = new ViewMatrix { ToClip = rows, IsRowMajor = true } },
                new ViewRequest { Camera = camera, Conservative = true },
                new ViewRequest { Camera = camera, Layers = 0 }
            };
            var expected = new[] { "012", "02", "0", "1", "1", "012", "012", "" };
            world.View(requests, visible);
            Func<int, string> seen = v => string.Concat(Enumerable.Range(0, visible.Count)
                .Where(i => (visible.ViewMasks[i] >> v & 1) != 0).Select(i => visible.Objects[i].User.ToString()));
            for (int v = 0; v < requests.Length; ++v) Expect.Equal(expected[v], seen(v));
            Expect.Equal(2, visible.Triangles(1).Length);
            Expect.Equal(0, visible.Triangles(0).Length);
            Expect.Fails(Status.OutOfRange, () => visible.Triangles(8));
            for (int v = 0; v < requests.Length; ++v) {
                world.View(requests[v], visible);
                Expect.Equal(expected[v], string.Concat(Users(visible)));
                requests[v].TreeOrder = true;
                world.View(requests[v], visible);
                Expect.Equal(expected[v], string.Concat(Users(visible).OrderBy(u => u)));
            }
            Expect.Fails(Status.InvalidArgument, () => world.View(new[] { requests[0], new ViewRequest() }, visible));
        }
    }
    [Test] static void AStaleHandleIsANamedError() {
        ObjectHandle[] o;
        using (var world = Row(1, out o)) {
            world.Remove(o[0]);
            world.Update();
            var next = world.Add(Sphere(0, 0, 0, 1), 9);
            Expect.Equal(o[0].Index, next.Index);
            Expect.Fails(Status.StaleHandle, () => world.SetUser(o[0], 1));
            Expect.Equal(9ul, world.User(next));
        }
    }
    [Test] static void AHandleThatWasNeverSetNamesNothing() {
        ObjectHandle[] o;
        using (var world = Row(1, out o)) {
            Expect.True(!world.Contains(default(ObjectHandle)));
            Expect.Fails(Status.StaleHandle, () => world.Remove(new ObjectHandle()));
            world.AddMesh(Tetrahedron, Faces);
            Expect.Fails(Status.StaleHandle, () => world.RemoveMesh(new MeshHandle()));
            Expect.Equal(1, world.Count);
        }
    }
    [Test] static void UserDataIsGivenBack() {
        ObjectHandle[] o;
        using (var world = Row(1, out o)) {
            world.SetUser(o[0], ulong.MaxValue);
            Expect.Equal(ulong.MaxValue, world.User(o[0]));
        }
    }
    [Test] static void ABoxIsKnownAfterTheFirstUpdateOnly() {
        using (var world = new World()) {
            var o = world.Add(Sphere(1, 2, 3, 0.5));
            Expect.Fails(Status.Empty, () => world.Box(o));
            world.Update();
            Expect.Equal(new Vector3(1, 2, 3), world.Box(o).Center);
        }
    }
    [Test] static void ANaNIsRefusedAndChangesNothing() {
        ObjectHandle[] o;
        using (var world = Row(1, out o)) {
            Expect.Fails(Status.NonFinite, () => world.SetBound(o[0], Sphere(double.NaN, 0, 0, 1)));
            Expect.Throws<CroftonException>(() => world.Add(Sphere(double.NaN, 0, 0, 1)));
            world.Update();
            Expect.Equal(1, world.Count);
            Expect.Equal(new Vector3(0, 0, -5), world.Box(o[0]).Center);
        }
    }
    [Test] static void OfManyBoxesTheBadOneIsNamed() {
        ObjectHandle[] o;
        using (var world = Row(3, out o)) {
            var boxes = Enumerable.Repeat(Obb.Aligned(new Vector3(9, 0, 0), new Float3(1, 1, 1)), 3).ToArray();
            boxes[1].HalfExtents.X = -1;
            var e = Expect.Throws<CroftonException>(() => world.SetBoxes(o, boxes));
            Expect.Equal((ulong?)1, e.Item);
            world.Update();
            Expect.Equal(9.0, world.Box(o[0]).Center.X);
            Expect.Equal(1.0, world.Box(o[1]).Center.X);
            Expect.Equal(9.0, world.Box(o[2]).Center.X);
        }
    }
    [Test] static void ArraysOfTwoLengthsAreRefused() {
        ObjectHandle[] o;
        using (var world = Row(2, out o)) {
            Expect.Throws<ArgumentException>(() => world.SetBoxes(o, new Obb[1]));
            Expect.Throws<ArgumentNullException>(() => world.SetBoxes(o, null));
        }
    }
    [Test] static void ANodeMovesWhatIsBelowIt() {
        using (var world = new World()) {
            var mesh = world.AddMesh(Tetrahedron, Faces);
            var top = world.AddNode(null, Transform.At(10, 0, 0));
            var below = world.AddNode(top, Transform.At(0, 1, 0));
            var o = world.Add(mesh, Transform.Identity, 0, below);
            world.Update();
            Expect.Equal(new Vector3(10, 1, 0), world.TransformOf(o).Translation);
            world.SetNodeTransforms(new[] { top }, new[] { Transform.At(-4, 0, 0) });
            world.Update();
            Expect.Equal(new Vector3(-4, 1, 0), world.TransformOf(o).Translation);
        }
    }
    [Test] static void ANodeIsNotItsOwnAncestor() {
        using (var world = new World()) {
            var top = world.AddNode(null, Transform.Identity);
            var below = world.AddNode(top, Transform.Identity);
            Expect.Throws<CroftonException>(() => world.SetParent(top, below));
            world.SetParent(below, null);
            world.SetParent(top, below);
        }
    }
    [Test] static void ANodeTakesAllBelowItAlong() {
        using (var world = new World()) {
            var mesh = world.AddMesh(Tetrahedron, Faces);
            var node = world.AddNode(null, Transform.Identity);
            var o = world.Add(mesh, Transform.Identity, 0, node);
            world.RemoveNode(node);
            Expect.True(!world.Contains(o));
        }
    }
    [Test] static void AMeshInUseStays() {
        using (var world = new World()) {
            var mesh = world.AddMesh(Tetrahedron, Faces);
            var o = world.Add(mesh, Transform.Identity);
            Expect.Throws<CroftonException>(() => world.RemoveMesh(mesh));
            world.Remove(o);
            world.RemoveMesh(mesh);
        }
    }
    [Test] static void BadMeshesAreRefused() {
        using (var world = new World()) {
            Expect.Throws<CroftonException>(() => world.AddMesh(Tetrahedron, new uint[] { 0, 1, 4 }));
            Expect.Throws<ArgumentException>(() => world.AddMesh(new float[7], null));
            Expect.Throws<ArgumentNullException>(() => world.AddMesh(null, Faces));
        }
    }
    [Test] static void AMeshThatDeformsTakesItsObjectAlong() {
        using (var world = new World()) {
            var mesh = world.AddMesh(Tetrahedron, Faces);
            var o = world.Add(mesh, Transform.Identity);
            world.Update();
            world.SetVertices(mesh, Tetrahedron.Select((v, i) => i % 3 == 0 ? v + 100 : v).ToArray());
            world.Update();
            Expect.True(world.Box(o).Center.X > 99);
            Expect.Throws<CroftonException>(() => world.SetVertices(mesh, new float[9]));
        }
    }
    [Test] static void AViewListsWhatIsBeforeIt() {
        ObjectHandle[] o;
        using (var world = Row(3, out o))
        using (var visible = new ViewResult()) {
            world.Add(Sphere(0, 0, 5, 0.25), 99);
            world.Update();
            world.View(new Camera(), visible);
            Expect.Sequence(new ulong[] { 0, 1, 2 }, Users(visible));
        }
    }
    [Test] static void LayersChoose() {
        ObjectHandle[] o;
        using (var world = Row(3, out o))
        using (var visible = new ViewResult()) {
            world.SetLayers(o[1], 2);
            world.Update();
            world.View(new ViewRequest { Camera = new Camera(), Layers = 1 }, visible);
            Expect.Sequence(new ulong[] { 0, 2 }, Users(visible));
        }
    }
    [Test] static void HiddenObjectsAreNotSeen() {
        ObjectHandle[] o;
        using (var world = Row(2, out o))
        using (var visible = new ViewResult()) {
            world.SetHidden(o[0], true);
            var late = world.Add(Bound.Sphere(new Vector3(0, 0, -5), 1), 7, hidden: true);
            world.Update();
            world.View(new Camera(), visible);
            Expect.Sequence(new ulong[] { 1 }, Users(visible));
            world.SetHidden(late, false);
            world.Update();
            world.View(new Camera(), visible);
            Expect.Sequence(new ulong[] { 1, 7 }, Users(visible));
        }
    }
    [Test] static void WhatAWallHidesIsNotSeen() {
        using (var world = new World())
        using (var visible = new ViewResult()) {
            var corners = Enumerable.Range(0, 24).Select(i => (i / 3 >> i % 3 & 1) == 1 ? 1f : -1f).ToArray();
            var faces = new uint[] { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
            var mesh = world.AddMesh(corners, faces);
            world.FindOccluders(mesh);
            Expect.True(world.OccluderCount(mesh) > 0);
            var wide = Transform.At(0, 0, -5);
            wide.C0.X = wide.C1.Y = 4;
            var wall = world.Add(mesh, wide, 1);
            world.Add(Sphere(0, 0, -20, 0.5), 2);
            world.Add(Sphere(0, 0, -3, 0.2), 3);
            world.Update();
            world.View(new ViewRequest { Camera = new Camera(), Occlusion = new OcclusionOptions() }, visible);
            Expect.Sequence(new ulong[] { 1, 3 }, Users(visible));
            world.SetOccludes(wall, false);
            world.Update();
            world.View(new ViewRequest { Camera = new Camera(), Occlusion = new OcclusionOptions() }, visible);
            Expect.Equal(3, visible.Count);
        }
    }
    [Test] static void ARayMeetsTheNearest() {
        ObjectHandle[] o;
        using (var world = Row(2, out o)) {
            var hit = world.Raycast(new Ray(new Vector3(1, 0, 0), Forth));
            Expect.Equal(o[1], hit.Object);
            Expect.Near(4.75, hit.T);
            Expect.True(hit.Triangle == null);
            Expect.True(!world.Raycast(new Ray(new Vector3(0.5, 0, 0), Forth)).IsHit);
            Expect.True(!world.RaycastAny(new Ray(new Vector3(0, 0, 0), Forth, 4.7)));
            Expect.True(world.RaycastAny(new Ray(new Vector3(0, 0, 0), Forth, 4.8)));
        }
    }
    [Test] static void ARayNamesTheTriangle() {
        using (var world = new World()) {
            world.Add(world.AddMesh(Tetrahedron, Faces), Transform.Identity);
            world.Update();
            var hit = world.Raycast(new Ray(new Vector3(0.2, 0.2, -3), new Vector3(0, 0, 1)));
            Expect.Equal((uint?)0, hit.Triangle);
            Expect.Equal(3.0, hit.T);
        }
    }
    [Test] static void ARayMeetsAll() {
        ObjectHandle[] o;
        using (var world = Row(5, out o)) {
            var hits = world.RaycastAll(new Ray(new Vector3(-10, 0, -5), new Vector3(1, 0, 0)));
            Expect.Sequence(o, hits.Select(h => h.Object).ToArray());
        }
    }
    [Test] static void ARayWithoutDirectionIsAnError() {
        ObjectHandle[] o;
        using (var world = Row(1, out o)) {
            Expect.Throws<CroftonException>(() => world.Raycast(new Ray(new Vector3(), new Vector3())));
            Expect.Equal(0, world.Raycast(new Ray[0]).Length);
        }
    }
    [Test] static void ShapesFindWhatTheyMeet() {
        ObjectHandle[] o;
        using (var world = Row(5, out o)) {
            var middle = new Vector3(1.5, 0, -5);
            var expected = new[] { o[1], o[2] };
            Expect.Sequence(expected, world.Overlap(Obb.Aligned(middle, new Float3(0.3f, 0.3f, 0.3f))).Select(r => r.Object).ToArray());
            Expect.Sequence(expected, world.OverlapSphere(middle, 0.26).Select(r => r.Object).ToArray());
            Expect.Sequence(expected, world.OverlapCapsule(new Vector3(1.1, 0.5, -5), new Vector3(1.9, 0.5, -5), 0.3).Select(r => r.Object).ToArray());
        }
    }
    [Test] static void TheClosestIsFoundWithinADistance() {
        ObjectHandle[] o;
        using (var world = Row(3, out o)) {
            var closest = world.ClosestToSphere(new Vector3(2, 4, -5), 0.5).Value;
            Expect.Equal(o[2], closest.Object);
            Expect.Near(3.25, closest.Distance);
            Expect.True(world.ClosestToSphere(new Vector3(2, 4, -5), 0.5, 3) == null);
        }
    }
    [Test] static void ContactsBeginStayAndEnd() {
        using (var world = new World()) {
            world.Add(Sphere(0, 0, 0, 1), 1);
            var b = world.Add(Sphere(1.5, 0, 0, 1), 2);
            world.Update();
            Expect.Equal(1, world.Pairs().Length);
            var contact = world.Contacts().Single();
            Expect.Equal(Phase.Began, contact.Phase);
            Expect.Near(0.5, contact.Depth);
            Expect.Near(1, contact.Normal.X);
            Expect.True(contact.Points.Length > 0);
            world.Update();
            Expect.Equal(Phase.Stayed, world.Contacts().Single().Phase);
            world.SetBound(b, Sphere(5, 0, 0, 1));
            world.Update();
            Expect.Equal(Phase.Ended, world.Contacts().Single().Phase);
            world.Update();
            Expect.Equal(0, world.Contacts().Length);
        }
    }
    [Test] static void TwoMeshesNameTheTrianglesThatTouch() {
        using (var world = new World()) {
            var mesh = world.AddMesh(Tetrahedron, Faces);
            world.Add(mesh, Transform.Identity);
            world.Add(mesh, Transform.At(0.1, 0.1, 0.1));
            world.Update();
            var triangles = world.Contacts().Single().Triangles;
            Expect.True(triangles.Length > 0 && triangles.All(t => t.FirstTriangle < 4 && t.SecondTriangle < 4));
        }
    }
    [Test] static void NoIndicesAreNoTriangles() {
        using (var world = new World()) Expect.Throws<ArgumentException>(() => world.AddMesh(new float[18], new uint[0]));
    }
    [Test] static void ALimitOfPairsIsKept() {
        using (var world = new World(new WorldOptions { MaxPairs = 1 })) {
            for (int i = 0; i < 3; ++i) world.Add(Sphere(0, 0, 0, 1));
            Expect.Fails(Status.BudgetExceeded, world.Update);
            Expect.Equal(0, world.Pairs().Length);
        }
    }
    [Test] static void ADisposedWorldSaysSo() {
        var world = new World();
        world.Dispose();
        world.Dispose();
        Expect.Throws<ObjectDisposedException>(world.Update);
        Expect.Throws<ObjectDisposedException>(() => world.Add(Sphere(0, 0, 0, 1)));
        var visible = new ViewResult();
        visible.Dispose();
        using (var other = new World()) Expect.Throws<ObjectDisposedException>(() => other.View(new Camera().Frustum(), visible));
    }
    [Test] static void TheCollectorMayRunAtAnyTime() {
        var stop = false;
        var collector = new Thread(() => { while (!Volatile.Read(ref stop)) GC.Collect(); });
        collector.Start();
        try {
            for (int i = 0; i < 200; ++i) {
                var world = new World(); // dropped, not disposed
                var o = world.Add(world.AddMesh(Tetrahedron.ToArray(), Faces.ToArray()), Transform.At(0, 0, -5), 7);
                world.Update();
                var visible = new ViewResult();
                world.View(new Camera(), visible);
                Expect.Sequence(new ulong[] { 7 }, Users(visible));
                Expect.True(world.Contains(o));
            }
        } finally {
            Volatile.Write(ref stop, true);
            collector.Join();
        }
    }
    [Test] static void AWorldIsAskedFromManyThreads() {
        ObjectHandle[] o;
        using (var world = Row(50, out o)) {
            var failures = new List<Exception>();
            var threads = Enumerable.Range(0, 6).Select(t => new Thread(() => {
                try {
                    var frustum = new Camera().Frustum();
                    using (var visible = new ViewResult())
                        for (int i = 0; i < 100; ++i) {
                            world.View(frustum, visible);
                            Expect.True(visible.Count > 3);
                            Expect.Equal(o[t], world.Raycast(new Ray(new Vector3(t, 0, 0), Forth)).Object);
                        }
                } catch (Exception e) {
                    lock (failures) failures.Add(e);
                }
            })).ToList();
            threads.ForEach(t => t.Start());
            threads.ForEach(t => t.Join());
            if (failures.Count > 0) throw failures[0];
        }
    }
    [Test] static void AChangeFromTwoThreadsIsAnErrorAndNoCrash() {
        ObjectHandle[] o;
        using (var world = Row(1, out o)) {
            int busy = 0;
            var threads = Enumerable.Range(0, 4).Select(t => new Thread(() => {
                for (int i = 0; i < 2000; ++i) {
                    try {
                        world.SetBound(o[0], Sphere(i % 7, 0, -5, 0.25));
                        world.Update();
                    } catch (CroftonException e) {
                        if (e.Status != Status.Busy) throw;
                        Interlocked.Increment(ref busy);
                    }
                }
            })).ToList();
            threads.ForEach(t => t.Start());
            threads.ForEach(t => t.Join());
            world.Update();
            Expect.Equal(1, world.Count);
        }
    }
}
