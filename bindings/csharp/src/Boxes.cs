// SPDX-License-Identifier: MIT
// Boxes without a World: views of an array, all pairs of boxes that move.
using System;
using System.Runtime.InteropServices;

namespace Crofton {
    /// <summary>Two items form a pair only if each shares a layer with the other's CollidesWith.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Filter { public uint Layers, CollidesWith; }

    /// <summary>Two places in an array; the first is the lower.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Pair { public uint First, Second; }

    /// <summary>Pairs that overlap; did not in the update before; did; did and no longer do.</summary>
    public enum Pairs { All = 0, Began = 1, Stayed = 2, Ended = 3 }

    /// <summary>Finds all pairs of boxes that overlap, exactly.</summary>
    public sealed class Broadphase : IDisposable {
        readonly BroadphaseHandle handle;

        public Broadphase() {
            Library.Load();
            Library.Check(Native.crofton_broadphase_create(out handle));
        }
        /// <summary>Frees it.</summary>
        public void Dispose() { handle.Dispose(); }
        /// <summary>Finds all pairs. boxes[i] is the same item as in the update before; filters: one for each, or null.</summary>
        public void Update(Obb[] boxes, Filter[] filters = null, int threads = 1) {
            Library.NotNull(boxes, "boxes");
            if (filters != null) Library.SameLength(boxes, filters);
            Jobs.With(threads, jobs => Library.Check(Native.crofton_broadphase_update(handle, boxes, filters, (UIntPtr)boxes.Length, jobs)));
        }
        /// <summary>Returns pairs of the last update, in order.</summary>
        public Pair[] Pairs(Pairs which = Crofton.Pairs.All) {
            IntPtr pairs;
            UIntPtr count;
            Library.Check(Native.crofton_broadphase_pairs(handle, (uint)which, out pairs, out count));
            Pair[] result = Library.ToArray<Pair>(pairs, count);
            GC.KeepAlive(this);
            return result;
        }
    }

    public sealed partial class ViewResult {
        /// <summary>Lists the boxes of an array that a view sees, exactly: their places. layers: a mask for each, or null. Error: a request with
        /// occlusion or a picture.</summary>
        public uint[] OfBoxes(Obb[] boxes, ViewRequest request, uint[] layers = null) {
            Library.NotNull(boxes, "boxes");
            Library.NotNull(request, "request");
            if (layers != null) Library.SameLength(boxes, layers);
            using (var memory = new Copies()) {
                Native.ViewRequestData data = memory.Of(request);
                Library.Check(Native.crofton_view_boxes(boxes, layers, (UIntPtr)boxes.Length, ref data, IntPtr.Zero, Handle));
            }
            IntPtr ids;
            UIntPtr count;
            Library.Check(Native.crofton_view_result_ids(Handle, out ids, out count, IntPtr.Zero, IntPtr.Zero));
            uint[] result = Library.ToArray<uint>(ids, count);
            GC.KeepAlive(this);
            return result;
        }
    }
}
