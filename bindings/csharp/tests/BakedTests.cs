// SPDX-License-Identifier: MIT
using System;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using Crofton;

static class BakedTests {
    static readonly float[] Corners = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    static readonly uint[] Faces = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };

    // What bakes, which the classes leave to the command line.
    [StructLayout(LayoutKind.Sequential)]
    struct MeshToBake {
        public UIntPtr Size;
        public IntPtr Positions;
        public UIntPtr VertexCount;
        public IntPtr Indices;
        public UIntPtr IndexCount;
        public IntPtr Name;
    }
    [DllImport("crofton_bake")] static extern int crofton_scene_create(out IntPtr scene);
    [DllImport("crofton_bake")] static extern int crofton_scene_destroy(IntPtr scene);
    [DllImport("crofton_bake")] static extern int crofton_scene_add_mesh(IntPtr scene, ref MeshToBake mesh, out uint id);
    [DllImport("crofton_bake")] static extern int crofton_scene_add_node(IntPtr scene, uint parent, ref Transform local, uint layers, out uint node);
    [DllImport("crofton_bake")] static extern int crofton_scene_add_instance(IntPtr scene, uint node, uint mesh, out uint instance);
    [DllImport("crofton_bake")] static extern int crofton_scene_update(IntPtr scene, IntPtr jobs, IntPtr statistics);
    [DllImport("crofton_bake")] static extern int crofton_scene_bake(IntPtr scene, byte[] path, IntPtr jobs);

    static string NewFolder() {
        string path = Path.Combine(Path.GetTempPath(), "crofton-csharp-" + Guid.NewGuid());
        Directory.CreateDirectory(path);
        return path;
    }
    // Tetrahedra along x at 0, 10, 20.
    static void Bake(string path) {
        IntPtr scene;
        uint mesh, node, instance;
        Expect.Equal(0, crofton_scene_create(out scene));
        GCHandle positions = GCHandle.Alloc(Corners, GCHandleType.Pinned), indices = GCHandle.Alloc(Faces, GCHandleType.Pinned),
            name = GCHandle.Alloc(new byte[] { 0x72, 0x6f, 0x63, 0x6b, 0 }, GCHandleType.Pinned);
        var data = new MeshToBake {
            Size = (UIntPtr)Marshal.SizeOf(typeof(MeshToBake)), Positions = positions.AddrOfPinnedObject(), VertexCount = (UIntPtr)4,
            Indices = indices.AddrOfPinnedObject(), IndexCount = (UIntPtr)12, Name = name.AddrOfPinnedObject()
        };
        Expect.Equal(0, crofton_scene_add_mesh(scene, ref data, out mesh));
        for (int i = 0; i < 3; ++i) {
            Transform place = Transform.At(10 * i, 0, 0);
            Expect.Equal(0, crofton_scene_add_node(scene, uint.MaxValue, ref place, uint.MaxValue, out node));
            Expect.Equal(0, crofton_scene_add_instance(scene, node, mesh, out instance));
        }
        Expect.Equal(0, crofton_scene_update(scene, IntPtr.Zero, IntPtr.Zero));
        Expect.Equal(0, crofton_scene_bake(scene, System.Text.Encoding.UTF8.GetBytes(path + "\0"), IntPtr.Zero));
        Expect.Equal(0, crofton_scene_destroy(scene));
        positions.Free();
        indices.Free();
        name.Free();
    }
    static ObjectHit[] Hits(World world) { return world.RaycastAll(new Ray(new Vector3(-1, 0.1, 0.1), new Vector3(1, 0, 0))); }

    [Test] static void ASceneFromAFileHasItsMeshesAndWhereTheyStand() {
        string folder = NewFolder(), path = Path.Combine(folder, "rocks.crofton");
        Bake(path);
        using (var scene = new BakedScene(path)) {
            Directory.Delete(folder, true); // it was read
            Expect.Equal(1, scene.MeshCount);
            BakedMesh mesh = scene.Mesh(0);
            Expect.Equal("rock", mesh.Name);
            Expect.Sequence(Corners, mesh.Positions);
            Expect.Sequence(Faces, mesh.Indices);
            Expect.True(mesh.Colors == null && !mesh.Unlit);
            Expect.Fails(Status.OutOfRange, () => scene.Mesh(1));
            using (ClusteredMesh clusters = scene.Clusters(0)) Expect.Equal(4, clusters.Clusters().TriangleOrder.Length);
            BakedNode[] nodes = scene.Nodes();
            Expect.Sequence(new[] { 0.0, 10.0, 20.0 }, scene.Instances().Select(i => nodes[i.Node].World.Translation.X).ToArray());
            Expect.Equal(uint.MaxValue, nodes[0].Parent);
            using (var world = new World()) {
                MeshHandle added = world.AddMesh(mesh.Positions, mesh.Indices);
                var objects = new ObjectHandle[3];
                world.AddMany(added, scene.Instances().Select(i => nodes[i.Node].World).ToArray(), objects, new ulong[] { 5, 6, 7 });
                world.Update();
                Expect.Sequence(new ulong[] { 5, 6, 7 }, Hits(world).Select(h => h.User).ToArray());
                Expect.Sequence(objects, Hits(world).Select(h => h.Object).ToArray());
            }
        }
        CroftonException missing = Expect.Fails(Status.Io, () => new BakedScene(path));
        Expect.True(missing.Message.Contains("rocks.crofton"));
        Expect.Throws<ArgumentException>(() => new BakedScene("a\0b"));
        Expect.Throws<ArgumentNullException>(() => new BakedScene(null));
    }
    [Test] static void ARegionFromAFileAnswersAsItsObjectsWould() {
        string folder = NewFolder(), path = Path.Combine(folder, "rocks.crofton");
        Bake(path);
        foreach (int threads in new[] { 1, 2 })
            using (var world = new World()) {
                using (Region region = Region.Open(path, null, threads)) {
                    RegionInfo info = region.Info();
                    Expect.Equal(3ul, info.ObjectCount);
                    Expect.True(info.Min.X <= 0 && info.Max.X >= 21 && info.Max.X < 21.1 && info.Bytes > 0);
                    Expect.Equal(0, region.MeshOf(2));
                    Expect.Fails(Status.OutOfRange, () => region.MeshOf(3));
                    Expect.Equal(4u, region.ClustersOf(0).All[0].TriangleCount);
                    Expect.True(region.ClustersOf(1) == null);
                    world.Attach(region, new Vector3(100, 0, 0));
                }
                world.Update();
                Expect.Sequence(new[] { 101.0, 111.0, 121.0 }, Hits(world).Select(h => h.T).ToArray());
                Expect.Sequence(new ulong[] { 0, 1, 2 }, Hits(world).Select(h => h.User).ToArray());
            }
        Expect.Fails(Status.OutOfRange, () => Region.Open(path, new BakedRegionOptions { MaxObjects = 2 }));
        byte[] bytes = File.ReadAllBytes(path);
        File.WriteAllBytes(path, bytes.Take(bytes.Length - 1).ToArray());
        Expect.Fails(Status.Parse, () => Region.Open(path));
        Expect.Fails(Status.Io, () => new RegionIndex(folder));
        Expect.Fails(Status.Parse, () => new Pvs(path));
        Expect.Fails(Status.Parse, () => new Pvs(bytes)); // a scene without sets
        Expect.Fails(Status.Parse, () => new Pvs(new byte[0]));
        Directory.Delete(folder, true);
    }

    // Runs the command line, where it has been built or is installed.
    static bool Command(params string[] arguments) {
        string built = Path.Combine(Environment.GetEnvironmentVariable("CROFTON_ROOT") ?? ".", "build/release/bin/crofton");
        var start = new System.Diagnostics.ProcessStartInfo(File.Exists(built) ? built : "crofton", string.Join(" ", arguments)) {
            UseShellExecute = false, RedirectStandardOutput = true
        };
        try {
            using (var process = System.Diagnostics.Process.Start(start)) {
                process.StandardOutput.ReadToEnd();
                process.WaitForExit();
                Expect.Equal(0, process.ExitCode);
            }
            return true;
        } catch (System.ComponentModel.Win32Exception) {
            Console.WriteLine("not tested: there is no command line");
            return false;
        }
    }
    [Test] static void AFolderOfRegionsAndItsVisibleSetsAreOpened() {
        string folder = NewFolder();
        if (Command("bake", "town", "--instances", "400", "--regions", "2x2", "--folder", folder)) {
            Command("pvs", folder, "--cells", "2x1x2", "--reach", "20");
            using (var index = new RegionIndex(folder))
            using (var world = new World()) {
                RegionFile[] files = index.Files();
                Expect.Equal(4, files.Length);
                for (int place = 0; place < files.Length; ++place) {
                    RegionFile file = files[place];
                    using (Region region = index.Prepare(place, null, 2)) {
                        Expect.Equal(file.Objects, region.Info().ObjectCount);
                        world.Attach(region, file.Origin);
                    }
                    string sets = Path.Combine(folder, file.Name.Replace(".crofton", ".sets.crofton"));
                    Expect.Equal((long)file.Bytes, new FileInfo(Path.Combine(folder, file.Name)).Length);
                    using (var pvs = new Pvs(sets))
                    using (var same = new Pvs(File.ReadAllBytes(sets))) {
                        Expect.Equal((int)file.Objects, pvs.ObjectCount);
                        Expect.Equal(4, pvs.CellCount);
                        int found = 0;
                        for (int x = -20; x < 20; ++x) {
                            var eye = new Vector3(x + 0.5, 1.7, 0.5);
                            ulong[] seen = pvs.Visible(eye);
                            Expect.Equal(seen == null, pvs.FindCell(eye) == null);
                            if (seen == null) continue;
                            ++found;
                            Expect.Sequence(seen, same.Visible(eye));
                        }
                        Expect.True(found > 0);
                        Expect.True(pvs.Visible(new Vector3(1e6, 0, 0)) == null);
                        Expect.Fails(Status.NonFinite, () => pvs.FindCell(new Vector3(double.NaN, 0, 0)));
                    }
                }
                world.Update();
                Expect.Equal((int)files.Sum(f => (long)f.Objects), world.Count);
                Expect.Equal(4ul, Expect.Fails(Status.OutOfRange, () => index.Prepare(4)).Item.Value);
            }
        }
        Directory.Delete(folder, true);
    }
}
