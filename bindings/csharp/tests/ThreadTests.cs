// SPDX-License-Identifier: MIT
using System;
using System.Linq;
using System.Threading;
using Crofton;

static class ThreadTests {
    // Boxes that all meet in one update, and by twos in the next.
    [Test] static void PairsAreThoseOfOneUpdateWhileAnotherThreadUpdates() {
        const int count = 200;
        using (var world = new World(new WorldOptions { Contacts = false })) {
            Func<Func<int, double>, Obb[]> row = x => Enumerable.Range(0, count).Select(i => Obb.Aligned(new Vector3(x(i), 0, 0), new Float3(1, 1, 1))).ToArray();
            Obb[] all = row(i => 0), twos = row(i => 10 * (i / 2));
            var objects = all.Select(b => world.Add(Bound.Box(b))).ToArray();
            world.Update();
            var stop = false;
            var updates = new Thread(() => {
                for (int step = 0; !Volatile.Read(ref stop); ++step) {
                    var boxes = step % 2 == 0 ? twos : all;
                    Patiently(() => { world.SetBoxes(objects, boxes); return 0; }, () => { world.Update(); return 0; });
                }
            });
            updates.Start();
            try {
                for (int i = 0; i < 200; ++i) {
                    var pairs = Patiently(world.Pairs);
                    Expect.True(pairs.Length == count / 2 || pairs.Length == count * (count - 1) / 2);
                    int place = 0;
                    for (uint first = 0; first < count; ++first)
                        for (uint second = first + 1; second < (pairs.Length == count / 2 ? (first + 2) / 2 * 2 : count); ++second, ++place) {
                            Expect.Equal(first, pairs[place].First.Object.Index);
                            Expect.Equal(second, pairs[place].Second.Object.Index);
                        }
                    Expect.Equal(pairs.Length, place);
                }
            } finally {
                Volatile.Write(ref stop, true);
                updates.Join();
            }
        }
    }
    // What a view has found is looked up in the world by a second call of the library.
    [Test] static void AViewIsOfOneUpdateWhileAnotherThreadUpdates() {
        using (var world = new World(new WorldOptions { Contacts = false }))
        using (var visible = new ViewResult()) {
            for (int i = 0; i < 50; ++i) world.Add(Bound.Sphere(new Vector3(0, 0, -5), 1), (ulong)i);
            world.Update();
            var frustum = new Camera().Frustum();
            var stop = false;
            var updates = new Thread(() => {
                while (!Volatile.Read(ref stop)) Patiently(() => { world.Update(); return 0; });
            });
            updates.Start();
            try {
                for (int i = 0; i < 30000; ++i) {
                    Patiently(() => { world.View(frustum, visible); return 0; });
                    Expect.Equal(50, visible.Count);
                    Expect.Equal(49ul, visible.Objects[49].User);
                }
            } finally {
                Volatile.Write(ref stop, true);
                updates.Join();
            }
        }
    }
    // Makes each call until the world is not busy; gives the last one's answer.
    static T Patiently<T>(params Func<T>[] calls) {
        T result = default(T);
        foreach (var call in calls) {
            for (;;) {
                try {
                    result = call();
                    break;
                } catch (CroftonException e) {
                    if (e.Status != Status.Busy) throw;
                }
            }
        }
        return result;
    }
}
