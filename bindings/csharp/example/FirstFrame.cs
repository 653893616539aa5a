// SPDX-License-Identifier: MIT
// A hundred tetrahedra and a sphere that rolls through them: what a camera sees, what touches, what a ray hits.
using System;
using System.Linq;
using Crofton;

static class FirstFrame {
    static Bound Sphere(double x) { return Bound.Sphere(new Vector3(x, 0.2, -3), 0.5); }

    static void Main() {
        using (var world = new World())
        using (var visible = new ViewResult()) {
            var mesh = world.AddMesh(new float[] { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 },
                                     new uint[] { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 });
            for (int i = 0; i < 100; ++i)
                world.Add(mesh, Transform.At(0.9 * (i % 10) - 4.5, 0, -1.5 * (i / 10)), (ulong)i);
            var rolling = world.Add(Sphere(-6), 100);
            var frustum = new Camera().Frustum();
            for (int frame = 0; frame < 10; ++frame) {
                world.SetBound(rolling, Sphere(0.5 * frame - 6));
                world.Update(); // once a frame; then ask
                world.View(frustum, visible);
                int touching = world.Contacts().Count(c => c.Second.Object.Equals(rolling) && c.Phase != Phase.Ended);
                Console.WriteLine("frame {0}: {1} of {2} objects in view, the sphere touches {3}", frame, visible.Count, world.Count, touching);
            }
            var hit = world.Raycast(new Ray(new Vector3(-4.3, 0.2, 5), new Vector3(0, 0, -1)));
            if (hit.IsHit) Console.WriteLine("the ray hits object {0} at {1:F2}", hit.User, hit.T);
        }
    }
}
