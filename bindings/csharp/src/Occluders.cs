// SPDX-License-Identifier: MIT
using System;
using System.Linq;
using System.Runtime.InteropServices;

namespace Crofton {
    public enum OccluderKind : uint { Box = 0, Walled = 1, Convex = 2, Patch = 3 }

    /// <summary>Geometry by which a mesh's objects hide others, in the mesh's frame. It must be opaque and lie within the drawn mesh.</summary>
    public sealed class Occluder {
        public OccluderKind Kind { get; private set; }
        /// <summary>Of a box, walled or not.</summary>
        public Obb Bounds { get; private set; }
        /// <summary>x, y, z of each point of a convex hull or a patch; three indices for each triangle of a patch.</summary>
        public float[] Positions { get; private set; }
        public uint[] Indices { get; private set; }
        /// <summary>A patch that hides only from the side where its triangles are counter-clockwise.</summary>
        public bool IsOneSided { get; private set; }

        /// <summary>A box inside a closed piece of the mesh.</summary>
        public static Occluder Box(Obb box) { return new Occluder { Kind = OccluderKind.Box, Bounds = box }; }
        /// <summary>A box behind walls of the mesh; it may be open on some sides.</summary>
        public static Occluder Walled(Obb box) { return new Occluder { Kind = OccluderKind.Walled, Bounds = box }; }
        /// <summary>The convex hull of points.</summary>
        public static Occluder Convex(float[] positions) {
            Copies.Triples(positions, "positions");
            return new Occluder { Kind = OccluderKind.Convex, Positions = positions };
        }
        /// <summary>Any triangles.</summary>
        public static Occluder Patch(float[] positions, uint[] indices, bool isOneSided = false) {
            Copies.Triples(positions, "positions");
            Library.NotNull(indices, "indices");
            return new Occluder { Kind = OccluderKind.Patch, Positions = positions, Indices = indices, IsOneSided = isOneSided };
        }
        internal Native.OccluderData Data(Copies memory) {
            var data = new Native.OccluderData {
                Size = Native.SizeOf<Native.OccluderData>(), Kind = (uint)Kind, IsOneSided = IsOneSided ? 1u : 0u, Box = Bounds
            };
            if (Positions != null) {
                data.Positions = memory.Pinned(Positions);
                data.PositionCount = (UIntPtr)(Positions.Length / 3);
            }
            if (Indices != null) {
                data.Indices = memory.Pinned(Indices);
                data.IndexCount = (UIntPtr)Indices.Length;
            }
            return data;
        }
        internal Occluder() { }
        internal Occluder(Native.OccluderData data) {
            Kind = (OccluderKind)data.Kind;
            Bounds = data.Box;
            IsOneSided = data.IsOneSided != 0;
            Positions = Library.ToArray<float>(data.Positions, (UIntPtr)(3 * (ulong)data.PositionCount));
            Indices = Library.ToArray<uint>(data.Indices, data.IndexCount);
        }
    }

    /// <summary>An occluder of an object; Place is in the list of the mesh's occluders.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct OccluderRef {
        public ObjectHandle Object;
        public ulong User;
        public uint Place;
        uint unused;
    }

    /// <summary>The depth buffer of a view with occlusion. Nearness: row by row from the bottom, 1 / w of the occluders (orthographic: minus the
    /// distance), or below -1e38 where nothing is drawn.</summary>
    public sealed class DepthBuffer {
        public int Width, Height;
        public float[] Nearness;
    }

    public sealed partial class World {
        /// <summary>Sets a mesh's occluders; none removes them. If one is refused, nothing changes, and the exception's Item is its place.</summary>
        public void SetOccluders(MeshHandle mesh, params Occluder[] occluders) {
            Library.NotNull(occluders, "occluders");
            using (var memory = new Copies()) {
                var data = occluders.Select(o => {
                    Library.NotNull(o, "occluders");
                    return o.Data(memory);
                }).ToArray();
                Library.Check(Native.crofton_world_set_occluders(Handle, mesh, data, (UIntPtr)data.Length));
            }
        }
        /// <summary>Returns a copy of one of a mesh's occluders, given or found.</summary>
        public Occluder OccluderOf(MeshHandle mesh, int place) {
            return Read(() => {
                var data = new Native.OccluderData { Size = Native.SizeOf<Native.OccluderData>() };
                Library.Check(Native.crofton_world_get_occluder(Handle, mesh, (UIntPtr)place, ref data));
                return new Occluder(data);
            });
        }
        /// <summary>Lists the occluders that hide an object in a view alone, none if it is not hidden; null: all that were drawn, those that hide most
        /// first. Draws all occluders again for one object.</summary>
        public OccluderRef[] Occluders(ViewResult view, ObjectHandle? hidden) {
            Library.NotNull(view, "view");
            var asked = hidden.HasValue ? new[] { hidden.Value } : null;
            return Read(() => {
                UIntPtr count;
                Library.Check(Native.crofton_view_result_occluders(view.Handle, Handle, asked, null, UIntPtr.Zero, out count));
                var list = new OccluderRef[(int)count];
                Library.Check(Native.crofton_view_result_occluders(view.Handle, Handle, asked, list, count, out count));
                return list;
            });
        }
    }
}
