// SPDX-License-Identifier: MIT
// Shapes by themselves, on objects of a World, and as its probes; given occluders and the depth buffer.
using System;
using System.Collections.Generic;
using System.Linq;
using Crofton;

static class SolidTests {
    static readonly float[] Tetrahedron = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    static readonly uint[] Faces = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    static readonly float[] Cube = Enumerable.Range(0, 24).Select(i => (i / 3 >> i % 3 & 1) * 2 - 1f).ToArray();
    static readonly Float3 One = new Float3(1, 1, 1);
    static readonly Transform Here = Transform.At(0, 0, 0);
    static Motion Along(double x, double y, double z) { return new Motion { Velocity = new Vector3(x, y, z) }; }
    static readonly CastOptions Long = new CastOptions { Duration = 10 };

    [Test] static void EachKindOfShapeHasItsVolume() {
        using (var cube = Shape.Box(One)) {
            var volumes = new Dictionary<Shape, double> {
                { Shape.Sphere(2), 4.0 / 3 * Math.PI * 8 },
                { Shape.Capsule(1, 3), 4.0 / 3 * Math.PI + Math.PI * 6 },
                { Shape.Cylinder(2, 1.5f), Math.PI * 4 * 3 },
                { Shape.Cone(2, 1.5f), Math.PI * 4 * 3 / 3 },
                { Shape.Box(new Float3(1, 2, 3)), 48 },
                { Shape.Hull(Cube), 8 },
                // A cube, its faces, a quarter of a cylinder at each edge, and a sphere in eight parts.
                { Shape.Rounded(cube, 1), 8 + 6 * 4 + 12 * 2 * Math.PI / 4 + 4.0 / 3 * Math.PI },
                { Shape.Compound(cube.At(Transform.At(-2, 0, 0)), cube.At(Transform.At(2, 0, 0))), 16 },
                { Shape.Triangle(new Float3(0, 0, 0), new Float3(1, 0, 0), new Float3(0, 1, 0)), 0 },
            };
            foreach (var one in volumes) {
                Expect.Near(one.Value, one.Key.Mass().Volume, 1e-4 * (one.Value + 1));
                one.Key.Dispose();
            }
            MassProperties mass = cube.Mass();
            Expect.Near(8.0 / 12 * (4 + 4), mass.Inertia0.X, 1e-5);
            Vector3 min, max;
            cube.Bounds(out min, out max);
            Expect.Near(-1, min.Y, 1e-3);
            Expect.Near(1, max.Z, 1e-3);
        }
    }
    [Test] static void SurfacesAndHalfSpacesHaveSides() {
        using (var floor = Shape.HalfSpace(new Vector3(0, -2, 0), 0)) // solid below
        using (var ball = Shape.Sphere(1))
        using (var surface = Shape.Mesh(Tetrahedron, Faces))
        using (var slope = Shape.HeightField(new float[,] { { 0, 1, 2 }, { 0, 1, 2 } }, 1, 1, new byte[,] { { 255, 0 } }, true)) {
            Vector3 a, b;
            Expect.Near(2, floor.At(Here).Distance(ball.At(Transform.At(0, 3, 0)), out a, out b));
            Expect.Near(2, b.Y);
            Penetration deep = floor.At(Here).Penetration(ball.At(Transform.At(0, 0.25, 0))).Value;
            Expect.Near(0.75, deep.Depth, 1e-6);
            Expect.Near(1, deep.Normal.Y, 1e-6);
            Expect.True(floor.At(Here).Penetration(ball.At(Transform.At(0, 3, 0))) == null);
            Expect.Fails(Status.Unsupported, () => surface.Mass());
            Expect.True(surface.At(Here).Touches(surface.At(Transform.At(1, 0, 0))) && !surface.At(Here).Touches(surface.At(Transform.At(1.5, 0, 0))));
            Func<double, ShapeRayHit?> down = x => slope.At(Here).Raycast(new Ray(new Vector3(x, 5, 0.5), new Vector3(0, -1, 0)));
            Expect.True(down(0.5) == null);
            Expect.Near(3.5, down(1.5).Value.T);
            Expect.Near(-Math.Sqrt(0.5), down(1.5).Value.Normal.X);
        }
    }
    [Test] static void ABoxOnAFloorHasFourContactPoints() {
        using (var floor = Shape.HalfSpace(new Vector3(0, -1, 0), 0))
        using (var cube = Shape.Box(new Float3(1, 2, 3))) {
            Placed ground = floor.At(Here);
            Func<double, Placed> at = y => cube.At(Transform.At(0, y, 0));
            ShapeContact contact = ground.Contacts(at(1.75));
            Expect.Equal(4, contact.Points.Length);
            Expect.Near(0.25, contact.Depth);
            Expect.Near(1, contact.Normal.Y);
            foreach (ShapePoint point in contact.Points) {
                Expect.Near(0.25, point.Depth);
                Expect.Near(1, Math.Abs(point.Position.X), 1e-6);
                Expect.Near(-0.125, point.Position.Y, 1e-6);
                Expect.Near(3, Math.Abs(point.Position.Z), 1e-6);
            }
            Expect.Equal(1, ground.Contacts(at(1.75), 0, 1).Points.Length);
            Expect.Equal(0, ground.Contacts(at(2.5), 0.25).Points.Length);
            Expect.Near(-0.5, ground.Contacts(at(2.5), 1).Depth);
            Expect.Fails(Status.InvalidArgument, () => ground.Contacts(at(2.5), -1));
            Expect.Fails(Status.OutOfRange, () => ground.Contacts(at(2.5), 0, 9));
            Vector3 nearest;
            Expect.Near(Math.Sqrt(10), at(0).ClosestPoint(new Vector3(0, 5, 4), out nearest));
            Expect.Near(2, nearest.Y);
            Expect.Near(0, at(0).ClosestPoint(new Vector3(0, 1, 1), out nearest));
            Expect.Fails(Status.NonFinite, () => at(0).ClosestPoint(new Vector3(0, double.NaN, 0), out nearest));
        }
    }
    [Test] static void AShapeThatMovesMeetsAnotherInTime() {
        using (var ball = Shape.Sphere(1))
        using (var cube = Shape.Box(One)) {
            Placed from = ball.At(Transform.At(-10, 0, 0)), at = cube.At(Here);
            Impact impact = from.Cast(Along(2, 0, 0), at, default(Motion), Long).Value;
            Expect.Near(4, impact.Time, 1e-5);
            Expect.Near(1, impact.Normal.X, 1e-6);
            Expect.True(!impact.IsUnresolved);
            Expect.True(from.Cast(Along(2, 0, 0), at) == null); // in one unit of time
            Expect.True(from.Cast(Along(-2, 0, 0), at, Along(-2, 0, 0), Long) == null);
        }
    }
    [Test] static void ShapesThatCannotBeAreRefusedByName() {
        Expect.Fails(Status.NonFinite, () => Shape.Sphere(float.NaN));
        Expect.Fails(Status.InvalidArgument, () => Shape.Sphere(-1));
        Expect.Equal((ulong?)1, Expect.Fails(Status.NonFinite, () => Shape.Hull(new[] { 0f, 0, 0, float.NaN, 0, 0, 1, 1, 1, 2, 2, 2 })).Item);
        Expect.Throws<ArgumentException>(() => Shape.Hull(new float[4]));
        Expect.Equal((ulong?)5, Expect.Fails(Status.OutOfRange, () => Shape.Mesh(Tetrahedron, new uint[] { 0, 2, 1, 0, 1, 9 })).Item);
        Expect.Throws<ArgumentNullException>(() => Shape.Mesh(Tetrahedron, null));
        Expect.Throws<ArgumentException>(() => Shape.HeightField(new float[3, 3], 1, 1, new byte[3, 3]));
        Expect.Fails(Status.OutOfRange, () => Shape.HeightField(new float[1, 3]));
        Expect.Fails(Status.Empty, () => Shape.Compound());
        Expect.Throws<ArgumentNullException>(() => Shape.Compound(new Placed()));
        var gone = Shape.Sphere(1);
        gone.Dispose();
        Expect.Throws<ObjectDisposedException>(() => gone.Mass());
        using (var ball = Shape.Sphere(1))
        using (var world = new World()) {
            Expect.Throws<ObjectDisposedException>(() => ball.At(Here).Touches(gone.At(Here)));
            Expect.Throws<ObjectDisposedException>(() => Shape.Rounded(gone, 1));
            Expect.Throws<ObjectDisposedException>(() => world.Add(gone, Here));
            Expect.Throws<ArgumentNullException>(() => world.Add((Shape)null, Here));
            Expect.Fails(Status.NonFinite, () => ball.At(Here).Touches(ball.At(Transform.At(double.NaN, 0, 0))));
            Expect.Equal((ulong?)1, Expect.Fails(Status.NonFinite, () => Shape.Compound(ball.At(Here), ball.At(Transform.At(double.NaN, 0, 0)))).Item);
        }
    }
    [Test] static void ObjectsHaveShapesThatQueriesAndContactsUse() {
        using (var world = new World(new WorldOptions { ContactMargin = 0.01 })) {
            ObjectHandle high;
            using (var floor = Shape.HalfSpace(new Vector3(0, -1, 0), 0))
            using (var ball = Shape.Sphere(1)) {
                world.Add(floor, Here, 1);
                high = world.Add(ball, Transform.At(0, 0.9, 0), 2);
            } // the world keeps what it needs
            world.Update();
            Contact contact = world.Contacts().Single();
            Expect.Equal(1ul, contact.First.User);
            TrackedPoint point = contact.ShapePoints.Single();
            Expect.Near(0.1, point.Depth, 1e-6);
            Expect.True(point.Began && point.Memory.X == 0);
            world.SetMemories((first, second, p) => new Float4 { X = (float)p.Depth + 5, W = first.User + second.User });
            world.SetTransforms(new[] { high }, new[] { Transform.At(0, 0.95, 0) });
            world.Update();
            point = world.Contacts().Single().ShapePoints.Single();
            Expect.True(!point.Began);
            Expect.Near(5.1, point.Memory.X, 1e-5);
            Expect.Equal(3f, point.Memory.W);
            Expect.Throws<CroftonException>(() => world.SetShape(high, null)); // it was added with only a shape
            Expect.Equal(2ul, world.Statistics().Objects);
        }
        using (var world = new World())
        using (var needle = Shape.Box(new Float3(0.01f, 0.01f, 0.01f))) {
            ObjectHandle sphere = world.Add(Bound.Sphere(new Vector3(0, 0, -5), 0.25));
            var aside = new Ray(new Vector3(0.1, 0, 0), new Vector3(0, 0, -1));
            foreach (Shape shape in new[] { needle, null }) {
                world.SetShape(sphere, shape);
                world.Update();
                Expect.Equal(shape == null, world.RaycastAny(aside));
            }
        }
    }
    [Test] static void AWorldAnswersProbesOfAnyShape() {
        using (var world = new World())
        using (var wide = Shape.Capsule(0.25f, 1))
        using (var floor = Shape.HalfSpace(new Vector3(0, 1, 0), 0)) {
            ObjectHandle[] row = Enumerable.Range(0, 3).Select(i => world.Add(Bound.Sphere(new Vector3(i, 0, -5), 0.25), (ulong)i)).ToArray();
            world.Update();
            Func<double, Placed> at = x => wide.At(Transform.At(x, 0, -5));
            Expect.Sequence(new[] { 0ul, 1ul }, world.Overlap(at(0.5)).Select(o => o.User).ToArray());
            Closest closest = world.Closest(at(4)).Value;
            Expect.Equal(row[2], closest.Object);
            Expect.Near(1.5, closest.Distance);
            Expect.Near(1.5, world.ClosestToCapsule(new Vector3(4, -1, -5), new Vector3(4, 1, -5), 0.25).Value.Distance);
            Expect.Near(1.5, world.Closest(Obb.Aligned(new Vector3(4, 0, -5), new Float3(0.25f, 1, 1))).Value.Distance);
            ShapeHit hit = world.Cast(at(4), Along(-1, 0, 0), Long).Value;
            Expect.Equal(row[2], hit.Object);
            Expect.Near(1.5, hit.Time, 1e-5);
            Expect.Near(-1, hit.Normal.X, 1e-6);
            Expect.True(world.Cast(at(4), Along(-1, 0, 0), new CastOptions { Duration = 1.4 }) == null);
            Expect.True(world.Cast(at(4), Along(-1, 0, 0), Long, 0) == null);
            ShapeHit[] all = world.CastAll(at(4), Along(-1, 0, 0), Long);
            Expect.Sequence(new[] { 2ul, 1ul, 0ul }, all.Select(h => h.User).ToArray());
            for (int i = 0; i < 3; ++i) Expect.Near(1.5 + i, all[i].Time, 1e-5);
            Expect.Equal(uint.MaxValue, all[0].Triangle);
            Expect.Equal(2, world.CastAll(at(4), Along(-1, 0, 0), Long, new QueryFilter { Ignored = new[] { row[1] } }).Length);
            ObjectManifold[] touched = world.ContactManifolds(at(2.3));
            Expect.Equal(1, touched.Length);
            Expect.Equal(row[2], touched[0].Object);
            Expect.Near(0.2, touched[0].Contact.Depth, 1e-6);
            Expect.Near(-1, touched[0].Contact.Normal.X, 1e-6);
            Expect.Equal(1, touched[0].Contact.Points.Length);
            Expect.Equal(0, world.ContactManifolds(at(9)).Length);
            Expect.Equal(2, world.ContactManifolds(at(1.5), 0.5).Length);
            Expect.Fails(Status.OutOfRange, () => world.ContactManifolds(at(0), 0, 9));
            Expect.Fails(Status.Unsupported, () => world.ContactManifolds(floor.At(Here)));
            Expect.Fails(Status.NonFinite, () => world.Cast(at(4), Along(double.NaN, 0, 0)));
            Expect.Fails(Status.Unsupported, () => world.Overlap(floor.At(Here)));
        }
    }
    [Test] static void RegionsHoldShapesAndHiders() {
        using (var world = new World())
        using (var visible = new ViewResult())
        using (var floor = Shape.HalfSpace(new Vector3(0, 1, 0), 0))
        using (var ball = Shape.Sphere(1)) {
            Expect.Equal((ulong?)0, Expect.Fails(Status.Unsupported, () => new Region(new[] { RegionObject.Of(floor, Here) })).Item);
            var mesh = new RegionMesh { Positions = Tetrahedron, Indices = Faces };
            var objects = new[] { RegionObject.Of(ball, Transform.At(50, 0, -9), 5), RegionObject.Of(0, Transform.At(0, 0, -9), onlyOccludes: true) };
            using (var region = new Region(objects, new[] { mesh })) world.Attach(region, new Vector3());
            world.Update();
            ObjectHit hit = world.Raycast(new Ray(new Vector3(50, 0, 0), new Vector3(0, 0, -1)));
            Expect.Equal(5ul, hit.User);
            Expect.Near(8, hit.T, 1e-6);
            world.View(new Camera(), visible);
            Expect.Equal(0, visible.Count);
        }
    }
    [Test] static void GivenOccludersHideAndSayWhatTheyHide() {
        using (var world = new World())
        using (var visible = new ViewResult()) {
            var front = new uint[] { 4, 5, 6, 5, 7, 6 };
            MeshHandle mesh = world.AddMesh(Cube, front);
            ObjectHandle wall = world.Add(mesh, new Transform { C0 = new Vector3(4, 0, 0), C1 = new Vector3(0, 4, 0), C2 = new Vector3(0, 0, 1), Translation = new Vector3(0, 0, -5) }, 1);
            ObjectHandle behind = world.Add(Bound.Sphere(new Vector3(0, 0, -20), 0.5), 2);
            var request = new ViewRequest { Camera = new Camera(), Occlusion = new OcclusionOptions { ListOccluded = true } };
            Obb box = Obb.Aligned(new Vector3(), One);
            foreach (Occluder given in new[] { Occluder.Box(box), Occluder.Walled(box), Occluder.Convex(Cube), Occluder.Patch(Cube, front), Occluder.Patch(Cube, front, true) }) {
                world.SetOccluders(mesh);
                world.Update();
                world.View(request, visible);
                Expect.Equal(0, visible.OccludedIds().Length);
                world.SetOccluders(mesh, given);
                world.Update();
                Expect.Equal(given.Kind, world.OccluderOf(mesh, 0).Kind);
                world.View(request, visible);
                Expect.Sequence(new[] { behind.Index }, visible.OccludedIds());
                foreach (ObjectHandle? asked in new ObjectHandle?[] { behind, null }) {
                    OccluderRef hider = world.Occluders(visible, asked).Single();
                    Expect.Equal(wall, hider.Object);
                    Expect.Equal(1ul, hider.User);
                }
                Expect.Equal(0, world.Occluders(visible, wall).Length);
                // The wall's front is 4 before the camera, in the middle of the picture; nothing is at its corner.
                DepthBuffer depth = visible.Depth();
                Expect.Equal(480 * 270, depth.Nearness.Length);
                Expect.Near(0.25, depth.Nearness[135 * 480 + 240], 0.01);
                Expect.True(depth.Nearness[0] < -1e38f);
            }
            var bad = Occluder.Convex(Enumerable.Repeat(float.NaN, 12).ToArray());
            Expect.Equal((ulong?)1, Expect.Fails(Status.NonFinite, () => world.SetOccluders(mesh, Occluder.Box(box), bad)).Item);
            Expect.Equal(1, world.OccluderCount(mesh)); // nothing has changed
            Expect.Throws<ArgumentNullException>(() => world.SetOccluders(mesh, (Occluder)null));
            Expect.Fails(Status.OutOfRange, () => world.OccluderOf(mesh, 1));
            world.View(new Camera(), visible);
            Expect.Fails(Status.Empty, () => visible.Depth());
            Expect.Fails(Status.OutOfRange, () => visible.Depth(1));
        }
    }
}
