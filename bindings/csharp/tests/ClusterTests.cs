// SPDX-License-Identifier: MIT
using System;
using System.Linq;
using Crofton;

static class ClusterTests {
    static readonly float[] Corners = { -3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0 };
    static readonly uint[] Faces = { 0, 1, 2, 0, 2, 3 };
    static readonly PictureView Small = new PictureView { Width = 160, Height = 90 };

    // Reversed depth to infinity: w = -z, near plane 1. Column-major.
    static float[] Place(float x, float z) { return new float[] { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, x, 0, 1, -z }; }

    [Test] static void AMeshIsCutAndStored() {
        using (var mesh = new ClusteredMesh(Corners, Faces)) {
            Clusters cut = mesh.Clusters();
            Expect.Equal(2u, cut.All.Single().TriangleCount);
            Expect.Sequence(new uint[] { 0, 1 }, cut.TriangleOrder.OrderBy(t => t).ToArray());
            ClusterBox box = mesh.BoxOf(0);
            double reach = Math.Abs(box.HalfEdge0.X) + Math.Abs(box.HalfEdge1.X) + Math.Abs(box.HalfEdge2.X);
            Expect.True(box.Center.X - reach <= -3 && box.Center.X + reach >= 3 && reach < 3.01);
            Expect.Fails(Status.OutOfRange, () => mesh.BoxOf(1));
            Expect.Fails(Status.OutOfRange, () => mesh.BoxOf(-1));

            Expect.Throws<ArgumentNullException>(() => new Clusters { All = cut.All }.Permute(Faces));
            Expect.Throws<ArgumentNullException>(() => new Clusters { TriangleOrder = cut.TriangleOrder }.Permute(Faces));

            byte[] bytes = mesh.ToBytes();
            using (var stored = new ClusteredMesh(bytes)) {
                Expect.Sequence(cut.TriangleOrder, stored.Clusters().TriangleOrder);
                Expect.Sequence(bytes, stored.ToBytes());
            }
            Expect.Fails(Status.Parse, () => new ClusteredMesh(bytes.Skip(1).ToArray()));
            Expect.Fails(Status.Parse, () => new ClusteredMesh(new byte[0]));
        }
    }
    [Test] static void ACullerOfItsOwnListsWhatAPictureNeeds() {
        using (var mesh = new ClusteredMesh(Corners, Faces))
        using (var culler = new DepthCuller()) {
            // Of three walls the second is hidden.
            Func<float, float, DepthObject> wall = (x, z) => new DepthObject { Mesh = mesh, ToClip = Place(x, z) };
            Expect.Fails(Status.OutOfRange, () => culler.Nearness(0, 0));
            var walls = new[] { wall(0, -10), wall(0, -40), wall(20, -40) };
            VisibleCluster[] listed = culler.FindVisible(walls, Small);
            Expect.Sequence(new uint[] { 0, 2 }, listed.Select(c => c.Object).ToArray());
            Expect.True(listed.All(c => c.Cluster == 0 && c.Triangles == 3));
            Expect.Near(0.1, culler.Nearness(80, 45), 1e-6);
            Expect.True(float.IsNegativeInfinity(culler.Nearness(0, 0)));
            Expect.Fails(Status.OutOfRange, () => culler.Nearness(160, 0));

            walls[0].Hides = false;
            Expect.Equal(3, culler.FindVisible(walls, Small).Length);
            walls[0].Hides = true;
            walls[1].PositionError = -1; // unknown: listed, and hides nothing
            Expect.Equal(3, culler.FindVisible(walls, Small).Length);
            walls[1].PositionError = 0;
            walls[2].ToClip[0] = -1; // mirrored: its back is seen
            walls[2].OneSided = true;
            Expect.Equal(1, culler.FindVisible(walls, Small).Length);
            Expect.Equal(0, culler.FindVisible(new DepthObject[0], Small).Length);

            Expect.Fails(Status.OutOfRange, () => culler.FindVisible(walls, new PictureView { Width = 0 }));
            Expect.Throws<ArgumentNullException>(() => culler.FindVisible(walls, null));
            Expect.Throws<ArgumentNullException>(() => culler.FindVisible(new DepthObject[1], Small));
            Expect.Throws<ArgumentNullException>(() => culler.FindVisible(new[] { new DepthObject { ToClip = Place(0, -9) } }, Small));
            Expect.Throws<ArgumentException>(() => culler.FindVisible(new[] { new DepthObject { Mesh = mesh, ToClip = new float[3] } }, Small));
        }
    }
    [Test] static void AMapNeedsWhatThrowsShadowsOnWhatIsSeen() {
        using (var mesh = new ClusteredMesh(Corners, Faces))
        using (var camera = new DepthCuller())
        using (var light = new DepthCuller()) {
            // The camera sees one wall. The light is where the camera is: of two casters, one is before that wall, and one beside it.
            Expect.Equal(1, camera.FindVisible(new[] { new DepthObject { Mesh = mesh, ToClip = Place(0, -20) } }, Small).Length);
            var casters = new[] { new DepthObject { Mesh = mesh, ToClip = Place(0, -10) }, new DepthObject { Mesh = mesh, ToClip = Place(30, -35) } };
            var map = new PictureView { Width = 256, Height = 256 };
            Expect.Equal(2, light.FindVisible(casters, map).Length);
            var receiver = new DepthReceiver { Mesh = mesh, ToMap = Place(0, -20) };
            Expect.Equal(0u, light.FindCasters(casters, map, camera, new[] { receiver }).Single().Object);
            using (var other = new ClusteredMesh(Corners, Faces))
                Expect.Equal((ulong?)0, Expect.Fails(Status.InvalidArgument, () => light.FindCasters(casters, map, camera, new[] { new DepthReceiver { Mesh = other, ToMap = Place(0, -20) } })).Item);
            Expect.Fails(Status.InvalidArgument, () => light.FindCasters(casters, map, camera, new DepthReceiver[0]));
            Expect.Fails(Status.OutOfRange, () => light.FindCasters(casters, map, camera, new[] { receiver }, 0));
            Expect.Throws<ArgumentNullException>(() => light.FindCasters(casters, map, null, new[] { receiver }));
            Expect.Throws<ArgumentNullException>(() => light.FindCasters(casters, map, camera, null));
            Expect.Throws<ArgumentException>(() => light.FindCasters(casters, map, camera, new[] { new DepthReceiver { Mesh = mesh } }));
        }
    }
    [Test] static void WorldsAndRegionsTakeClustersThatWereCutBefore() {
        var mesh = new ClusteredMesh(Corners, Faces, 1); // a World would cut one cluster
        Expect.Equal(2, mesh.Clusters().All.Length);
        using (var world = new World())
        using (var visible = new ViewResult()) {
            MeshHandle placed = world.AddMesh(Corners, Faces, true, precut: mesh);
            world.Update();
            Expect.Equal(2, world.ClustersOf(placed).All.Length);
            Expect.Fails(Status.InvalidArgument, () => world.AddMesh(Corners, new uint[] { 0, 1, 2 }, true, precut: mesh));
            world.ReplaceMesh(placed, Corners, Faces, true);
            world.Update();
            Expect.Equal(1, world.ClustersOf(placed).All.Length);

            var shared = new RegionMesh { Positions = Corners, Indices = Faces, Clusters = true, Precut = mesh };
            var region = new Region(new[] { RegionObject.Of(0, Transform.At(0, 0, -9)) }, new[] { shared });
            mesh.Dispose(); // what was made of it keeps what it needs
            Expect.Throws<ObjectDisposedException>(() => mesh.Clusters());
            Expect.Throws<ObjectDisposedException>(() => world.AddMesh(Corners, Faces, true, precut: mesh));
            Expect.Throws<ObjectDisposedException>(() => new Region(new RegionObject[0], new[] { shared }));
            world.Attach(region, new Vector3());
            world.Update();
            world.View(new ViewRequest { Camera = new Camera(), Picture = new PictureView() }, visible);
            Expect.Sequence(new uint[] { 0, 1 }, visible.Triangles().Select(c => c.Cluster).ToArray());
            region.Dispose();
        }
    }
    [Test] static void WithoutTrianglesQueriesTestTheBox() {
        using (var world = new World()) {
            var corner = new float[] { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
            var beside = new Ray(new Vector3(0.9, 0.9, 5), new Vector3(0, 0, -1));
            foreach (bool triangles in new[] { true, false }) {
                ObjectHandle one = world.Add(world.AddMesh(corner, null, triangles: triangles), Transform.Identity);
                world.Update();
                Expect.Equal(!triangles, world.RaycastAny(beside));
                world.Remove(one);
            }
        }
    }
}
