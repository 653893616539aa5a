// SPDX-License-Identifier: MIT
using System.Linq;
using System.Threading;
using Crofton;

static class RegionTests {
    static RegionObject Ball(double x, ulong user) { return RegionObject.Of(Bound.Sphere(new Vector3(x, 0, 0), 1), user); }
    static ulong[] Seen(World world) {
        return world.RaycastAll(new Ray(new Vector3(-50, 0, 0), new Vector3(1, 0, 0))).Select(hit => hit.User).ToArray();
    }

    [Test] static void ObjectsOfARegionAreThereFromAttachToDetachAtEachOrigin() {
        Region region = null;
        var loader = new Thread(() => region = new Region(new[] { Ball(0, 5), Ball(10, 6) }));
        loader.Start();
        loader.Join();
        using (var world = new World()) {
            AttachedRegion near = world.Attach(region, new Vector3(0, 0, 0)), far = world.Attach(region, new Vector3(100, 0, 0));
            region.Dispose();
            world.Update();
            Expect.Sequence(new ulong[] { 5, 6, 5, 6 }, Seen(world));
            ObjectHandle handle = world.ObjectIn(far, 1);
            int place;
            Expect.Equal(far, world.RegionOf(handle, out place));
            Expect.Equal(1, place);
            Expect.Equal(110.0, world.Box(handle).Center.X);
            world.SetHidden(handle, true);
            world.Update();
            Expect.Sequence(new ulong[] { 5, 6, 5 }, Seen(world));
            world.Detach(near);
            world.Update();
            Expect.Sequence(new ulong[] { 5 }, Seen(world));
            Expect.Fails(Status.StaleHandle, () => world.Detach(near));
        }
    }
    [Test] static void ObjectsShareTheMeshesOfARegion() {
        var mesh = new RegionMesh { Positions = new float[] { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 }, Indices = new uint[] { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 }, Clusters = true };
        var objects = new[] { RegionObject.Of(0, Transform.Identity), RegionObject.Of(0, Transform.At(0, 0, -9)) };
        using (var region = new Region(objects, new[] { mesh }))
        using (var world = new World()) {
            AttachedRegion attached = world.Attach(region, new Vector3(50, 0, 0));
            world.Update();
            Transform transform = world.TransformOf(world.ObjectIn(attached, 1));
            Expect.Equal(new Vector3(50, 0, -9), transform.Translation);
        }
    }
    [Test] static void WhatARegionRefusesIsNamedByItsPlace() {
        Expect.Equal(1, (int)Expect.Fails(Status.NonFinite, () => new Region(new[] { Ball(0, 1), Ball(double.NaN, 2) })).Item);
        Expect.Equal(0, (int)Expect.Fails(Status.InvalidArgument, () => new Region(new[] { RegionObject.Of(3, Transform.Identity) })).Item);
        Expect.Throws<System.ArgumentNullException>(() => new Region(null));
        Expect.Throws<System.ArgumentNullException>(() => new Region(new RegionObject[0], new RegionMesh[1]));
        using (var world = new World()) {
            var region = new Region(new[] { Ball(0, 1) });
            Expect.Fails(Status.NonFinite, () => world.Attach(region, new Vector3(double.NaN, 0, 0)));
            region.Dispose();
            Expect.Throws<System.ObjectDisposedException>(() => world.Attach(region, new Vector3(0, 0, 0)));
            world.Update();
            Expect.Equal(0, world.Count);
        }
    }
}
