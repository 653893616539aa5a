// SPDX-License-Identifier: MIT
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Crofton {
    // Holds what the structs of a call point to until it has returned.
    internal sealed class Copies : IDisposable {
        readonly List<IntPtr> memory = new List<IntPtr>();
        readonly List<GCHandle> pinned = new List<GCHandle>();
        readonly List<SafeHandle> held = new List<SafeHandle>();

        // The number of points, x, y, z each.
        internal static UIntPtr Triples(float[] numbers, string name) {
            Library.NotNull(numbers, name);
            if (numbers.Length % 3 != 0) throw new ArgumentException("they are x, y, z each", name);
            return (UIntPtr)(numbers.Length / 3);
        }
        internal Native.PlacedData Of(Placed placed) {
            return new Native.PlacedData { Shape = Held(placed.Given.Handle), Pose = Copied(placed.Pose) };
        }
        internal Native.PlainMeshData Of(float[] positions, uint[] indices) {
            UIntPtr count = Triples(positions, "positions");
            Library.NotNull(indices, "indices");
            return new Native.PlainMeshData {
                Size = Native.SizeOf<Native.PlainMeshData>(), Positions = Pinned(positions), VertexCount = count, Indices = Pinned(indices),
                IndexCount = (UIntPtr)indices.Length
            };
        }
        // A mesh for a World or a Region; indices may be null.
        internal Native.MeshData Of(RegionMesh mesh) {
            Native.MeshData data = Native.crofton_default_mesh_data();
            data.PositionCount = Triples(mesh.Positions, "positions");
            data.Positions = Pinned(mesh.Positions);
            if (mesh.Indices != null) {
                if (mesh.Indices.Length == 0) throw new ArgumentException("there are none, so there is no triangle", "indices");
                data.Indices = Pinned(mesh.Indices);
                data.IndexCount = (UIntPtr)mesh.Indices.Length;
            }
            data.Triangles = mesh.Triangles ? 1u : 0u;
            data.Clusters = mesh.Clusters ? 1u : 0u;
            data.OneSided = mesh.OneSided ? 1u : 0u;
            if (mesh.Precut != null) data.Precut = Held(mesh.Precut.Handle);
            return data;
        }
        internal Native.QueryShapeData Probe(Placed placed) { return new Native.QueryShapeData { Kind = Native.QueryShapeShape, Shape = Of(placed) }; }
        // Null stands for a filter of all objects.
        internal Native.QueryFilterData Of(QueryFilter filter) {
            var data = new Native.QueryFilterData { Size = Native.SizeOf<Native.QueryFilterData>(), Layers = filter == null ? World.AllLayers : filter.Layers };
            if (filter == null || filter.Ignored == null) return data;
            data.Ignored = Pinned(filter.Ignored);
            data.IgnoredCount = (UIntPtr)filter.Ignored.Length;
            return data;
        }
        internal Native.ViewRequestData Of(ViewRequest request) {
            Native.ViewRequestData data = Native.crofton_default_view_request();
            data.Layers = request.Layers;
            data.Conservative = request.Conservative ? 1u : 0u;
            data.TreeOrder = request.TreeOrder ? 1u : 0u;
            if (request.Camera != null) data.Camera = Copied(request.Camera.Data());
            if (request.Matrix != null) data.Matrix = Copied(Of(request.Matrix));
            if (request.Volume != null) data.Volume = Copied(request.Volume.Data);
            if (request.Occlusion != null) data.Occlusion = Copied(request.Occlusion.Data());
            if (request.Limits != null) data.Limits = Copied(Of(request.Limits));
            if (request.Picture != null) data.Picture = Copied(request.Picture.Data());
            if (request.Receivers != null) data.Receivers = Copied(Of(request.Receivers));
            if (request.CandidateMask != null) {
                data.CandidateMask = Pinned(request.CandidateMask);
                data.CandidateWords = (UIntPtr)request.CandidateMask.Length;
            }
            return data;
        }
        Native.ShadowReceiversData Of(ShadowReceivers receivers) {
            Library.NotNull(receivers.Seen, "Seen");
            Native.ShadowReceiversData data = Native.crofton_default_shadow_receivers();
            data.Seen = Held(receivers.Seen.Handle);
            data.Radius = receivers.Radius;
            return data;
        }
        Native.ViewMatrixData Of(ViewMatrix matrix) {
            if (matrix.ToClip == null || matrix.ToClip.Length != 16) throw new ArgumentException("a matrix has sixteen numbers", "Matrix");
            Native.ViewMatrixData data = Native.crofton_default_view_matrix();
            data.Doubles = Pinned(matrix.ToClip);
            data.IsRowMajor = matrix.IsRowMajor ? 1u : 0u;
            data.Depth = (uint)matrix.Depth;
            data.Origin = matrix.Origin;
            return data;
        }
        Native.DrawLimitsData Of(DrawLimits limits) {
            if (limits.LayerDistances != null && limits.LayerDistances.Length != 32)
                throw new ArgumentException("there are 32 layers", "LayerDistances");
            Native.DrawLimitsData data = Native.crofton_default_draw_limits();
            data.Eye = limits.Eye;
            if (!double.IsPositiveInfinity(limits.MaxDistanceInRadii)) data.MaxDistanceInRadii = limits.MaxDistanceInRadii;
            data.LeastRadius = limits.LeastRadius;
            data.Hysteresis = limits.Hysteresis;
            if (limits.LayerDistances != null) data.LayerDistances = Pinned(limits.LayerDistances);
            if (limits.ItemDistances != null) {
                data.ItemDistances = Pinned(limits.ItemDistances);
                data.ItemCount = (UIntPtr)limits.ItemDistances.Length;
            }
            if (limits.DrawnBefore != null) {
                data.DrawnBefore = Pinned(limits.DrawnBefore);
                data.DrawnWordCount = (UIntPtr)limits.DrawnBefore.Length;
            }
            return data;
        }
        internal IntPtr Copied<T>(T data) where T : struct {
            IntPtr copy = Marshal.AllocHGlobal(Marshal.SizeOf(typeof(T)));
            memory.Add(copy);
            Marshal.StructureToPtr(data, copy, false);
            return copy;
        }
        internal IntPtr CopiedAll<T>(T[] data) where T : struct {
            int size = Marshal.SizeOf(typeof(T));
            IntPtr first = Marshal.AllocHGlobal(Math.Max(1, size * data.Length));
            memory.Add(first);
            for (int i = 0; i < data.Length; ++i) Marshal.StructureToPtr(data[i], new IntPtr(first.ToInt64() + (long)i * size), false);
            return first;
        }
        internal IntPtr Held(SafeHandle handle) {
            bool isHeld = false;
            handle.DangerousAddRef(ref isHeld);
            held.Add(handle);
            return handle.DangerousGetHandle();
        }
        internal IntPtr Pinned(Array numbers) {
            var handle = GCHandle.Alloc(numbers, GCHandleType.Pinned);
            pinned.Add(handle);
            return handle.AddrOfPinnedObject();
        }
        public void Dispose() {
            foreach (IntPtr copy in memory) Marshal.FreeHGlobal(copy);
            foreach (GCHandle handle in pinned) handle.Free();
            foreach (SafeHandle handle in held) handle.DangerousRelease();
        }
    }
}
