// SPDX-License-Identifier: MIT
// Files that `crofton bake` and `crofton pvs` wrote: scenes, regions, visible sets.
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>A mesh of a BakedScene.</summary>
    public sealed class BakedMesh {
        public string Name;
        /// <summary>x, y, z of each vertex; linear r, g, b, or null.</summary>
        public float[] Positions, Colors;
        /// <summary>Three per triangle.</summary>
        public uint[] Indices;
        /// <summary>In the mesh's own frame.</summary>
        public Obb Box;
        /// <summary>Back faces are not drawn; each face has its own normal; colours are not lit.</summary>
        public bool OneSided, Flat, Unlit;
    }

    /// <summary>An instance of a BakedScene: a mesh at a node. One that was removed has uint.MaxValue in both.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct BakedInstance { public uint Mesh, Node; }

    /// <summary>A node of a BakedScene: where it stands in the world, and the node above, or uint.MaxValue.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct BakedNode {
        public Transform World;
        public uint Parent;
        internal uint Reserved;
    }

    /// <summary>A scene from a file: its meshes, where they stand, and their clusters.</summary>
    public sealed class BakedScene : IDisposable {
        readonly BakedSceneHandle handle;

        /// <summary>Reads a file and checks all of it.</summary>
        public BakedScene(string path) {
            Library.Load();
            TreeHandle tree;
            Library.Check(Native.crofton_baked_scene_read(Library.ToBytes(path, "path"), IntPtr.Zero, out handle, out tree));
            tree.Dispose();
        }
        /// <summary>Frees it.</summary>
        public void Dispose() { handle.Dispose(); }
        /// <summary>The number of meshes.</summary>
        public int MeshCount {
            get {
                UIntPtr count;
                Library.Check(Native.crofton_baked_scene_mesh_count(handle, out count));
                return (int)count;
            }
        }
        /// <summary>Returns a copy of a mesh.</summary>
        public BakedMesh Mesh(int mesh) {
            var data = new Native.BakedMeshData { Size = Native.SizeOf<Native.BakedMeshData>() };
            Library.Check(Native.crofton_baked_scene_mesh(handle, (uint)mesh, ref data));
            UIntPtr numbers = new UIntPtr(3 * (ulong)data.VertexCount);
            var result = new BakedMesh {
                Name = Library.ToText(data.Name, (int)data.NameLength), Positions = Library.ToArray<float>(data.Positions, numbers),
                Colors = data.Colors == IntPtr.Zero ? null : Library.ToArray<float>(data.Colors, numbers),
                Indices = Library.ToArray<uint>(data.Indices, data.IndexCount), Box = data.Box, OneSided = data.OneSided != 0, Flat = data.Flat != 0,
                Unlit = data.Unlit != 0
            };
            GC.KeepAlive(this);
            return result;
        }
        /// <summary>Returns a mesh's clusters, for World.AddMesh; null: it was baked without.</summary>
        public ClusteredMesh Clusters(int mesh) {
            ClusteredMeshHandle clustered;
            int status = Native.crofton_baked_scene_clusters(handle, (uint)mesh, out clustered);
            if (status == (int)Status.Empty) return null;
            Library.Check(status);
            return new ClusteredMesh(clustered);
        }
        /// <summary>Returns the instances.</summary>
        public BakedInstance[] Instances() {
            IntPtr first;
            UIntPtr count;
            Library.Check(Native.crofton_baked_scene_instances(handle, out first, out count));
            BakedInstance[] result = Library.ToArray<BakedInstance>(first, count);
            GC.KeepAlive(this);
            return result;
        }
        /// <summary>Returns the nodes.</summary>
        public BakedNode[] Nodes() {
            IntPtr first;
            UIntPtr count;
            Library.Check(Native.crofton_baked_scene_nodes(handle, out first, out count));
            BakedNode[] result = Library.ToArray<BakedNode>(first, count);
            GC.KeepAlive(this);
            return result;
        }
    }

    /// <summary>Options of regions from files.</summary>
    public sealed class BakedRegionOptions {
        /// <summary>False: rays, probes and contacts test the meshes' boxes in place of the triangles.</summary>
        public bool Triangles = true;
        /// <summary>False: objects do not hide others, which saves half of the time.</summary>
        public bool Occluders = true;
        /// <summary>The layers that all objects collide with.</summary>
        public uint CollidesWith = World.AllLayers;
        /// <summary>Does not check that the bounds in the file contain what is below them. Only for files of your own: wrong bounds would lose
        /// objects later.</summary>
        public bool TrustContents;
        /// <summary>A region with more is refused.</summary>
        public ulong MaxObjects = 1ul << 24;
        /// <summary>No coordinate of an origin may be larger; for another value than 1e9 the file's tree is built anew.</summary>
        public double MaxOrigin = 1e9;

        internal static Native.BakedRegionOptionsData Data(BakedRegionOptions given) {
            given = given ?? new BakedRegionOptions();
            return new Native.BakedRegionOptionsData {
                Size = Native.SizeOf<Native.BakedRegionOptionsData>(), Triangles = given.Triangles ? 1u : 0u, Occluders = given.Occluders ? 1u : 0u,
                CollidesWith = given.CollidesWith, TrustContents = given.TrustContents ? 1u : 0u, MaxObjects = given.MaxObjects, MaxOrigin = given.MaxOrigin
            };
        }
    }

    /// <summary>A region of a RegionIndex.</summary>
    public struct RegionFile {
        /// <summary>Of the file, in the index's folder.</summary>
        public string Name;
        /// <summary>Where to attach it, and a box around its objects, relative to that.</summary>
        public Vector3 Origin, Min, Max;
        /// <summary>How many objects it holds, and the file's size.</summary>
        public ulong Objects, Bytes;
    }

    /// <summary>The index of a world that `crofton bake --regions` has split into a folder of files.</summary>
    public sealed class RegionIndex : IDisposable {
        readonly RegionIndexHandle handle;

        /// <summary>Reads the index of a folder.</summary>
        public RegionIndex(string folder) {
            Library.Load();
            Library.Check(Native.crofton_region_index_open(Library.ToBytes(folder, "folder"), out handle));
        }
        /// <summary>Frees it.</summary>
        public void Dispose() { handle.Dispose(); }
        /// <summary>Returns where the regions are.</summary>
        public RegionFile[] Files() {
            IntPtr first;
            UIntPtr count;
            Library.Check(Native.crofton_region_index_files(handle, out first, out count));
            RegionFile[] result = Array.ConvertAll(Library.ToArray<Native.RegionFileData>(first, count), file => new RegionFile {
                Name = Library.ToText(file.Name), Origin = file.Origin, Min = file.Min, Max = file.Max, Objects = file.Objects, Bytes = file.Bytes
            });
            GC.KeepAlive(this);
            return result;
        }
        /// <summary>Does the same as Region.Open for the region at a place in Files. Also an error: the file has another size or other objects than
        /// the index says.</summary>
        public Region Prepare(int place, BakedRegionOptions options = null, int threads = 1) {
            Native.BakedRegionOptionsData data = BakedRegionOptions.Data(options);
            RegionHandle region = null;
            Jobs.With(threads, jobs => Library.Check(Native.crofton_region_index_prepare(handle, (UIntPtr)(uint)place, ref data, jobs, out region)));
            return new Region(region);
        }
    }

    public sealed partial class Region {
        internal Region(RegionHandle handle) { Handle = handle; }
        /// <summary>Opens a baked file, checks all of it and prepares a region. The object at place i is instance i of the file, with the user number
        /// i; meshes have the numbers of the file.</summary>
        public static Region Open(string path, BakedRegionOptions options = null, int threads = 1) {
            Library.Load();
            byte[] bytes = Library.ToBytes(path, "path");
            Native.BakedRegionOptionsData data = BakedRegionOptions.Data(options);
            RegionHandle region = null;
            Jobs.With(threads, jobs => Library.Check(Native.crofton_baked_region_open(bytes, ref data, jobs, out region)));
            return new Region(region);
        }
    }

    /// <summary>Pvs.Visible: everything that is not proved to be hidden; what random lines have seen.</summary>
    public enum PvsMode { Conservative = 0, Statistical = 1 }

    /// <summary>Visible sets: which objects of a scene may be seen from where. `crofton pvs --out FILE` bakes them.</summary>
    public sealed class Pvs : IDisposable {
        readonly PvsHandle handle;

        /// <summary>Reads a file.</summary>
        public Pvs(string path) {
            Library.Load();
            Library.Check(Native.crofton_pvs_open(Library.ToBytes(path, "path"), out handle));
        }
        /// <summary>Copies what a file in memory holds.</summary>
        public Pvs(byte[] bytes) {
            Library.NotNull(bytes, "bytes");
            Library.Load();
            Library.Check(Native.crofton_pvs_read(bytes, (UIntPtr)bytes.Length, out handle));
        }
        /// <summary>Frees it.</summary>
        public void Dispose() { handle.Dispose(); }
        /// <summary>The number of cells.</summary>
        public int CellCount { get { return Counts()[0]; } }
        /// <summary>The number of objects.</summary>
        public int ObjectCount { get { return Counts()[1]; } }
        int[] Counts() {
            UIntPtr cells, objects;
            Library.Check(Native.crofton_pvs_counts(handle, out cells, out objects));
            return new[] { (int)cells, (int)objects };
        }
        /// <summary>Returns the cell of an eye; null: it is in none, or in a solid one.</summary>
        public uint? FindCell(Vector3 eye) {
            uint cell;
            Library.Check(Native.crofton_pvs_find_cell(handle, ref eye, out cell));
            return cell == uint.MaxValue ? (uint?)null : cell;
        }
        /// <summary>Returns what an eye may see, for ViewRequest.CandidateMask; null, which stands for everything, if the eye is in no cell.</summary>
        public ulong[] Visible(Vector3 eye, PvsMode mode = PvsMode.Conservative) {
            IntPtr words;
            UIntPtr count;
            Library.Check(Native.crofton_pvs_visible(handle, ref eye, (uint)mode, out words, out count));
            ulong[] result = count == UIntPtr.Zero ? null : Library.ToArray<ulong>(words, count);
            GC.KeepAlive(this);
            return result;
        }
    }
}
