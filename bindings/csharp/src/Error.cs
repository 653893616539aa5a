// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Crofton {
    /// <summary>The kinds of failure; their numbers are those of the C API.</summary>
    public enum Status {
        InvalidArgument = 1, NonFinite = 2, OutOfRange = 3, Degenerate = 4, Empty = 5, Unsupported = 6, Io = 7, Parse = 8,
        Cancelled = 9, BudgetExceeded = 10, Unavailable = 11, StaleHandle = 12, Internal = 13, BadHandle = 14, WrongSize = 15,
        Busy = 16, OutOfMemory = 17
    }

    /// <summary>An error: its kind, a message, and the item of the input that caused it.</summary>
    public sealed class CroftonException : Exception {
        /// <summary>The kind of failure.</summary>
        public Status Status { get; private set; }
        /// <summary>The index of the first invalid item of the input; null if no single item caused the error.</summary>
        public ulong? Item { get; private set; }

        internal CroftonException(Status status, string message, ulong? item)
            : base(item.HasValue ? message + " (item " + item.Value + ")" : message) {
            Status = status;
            Item = item;
        }
    }

    /// <summary>The native library.</summary>
    public static class Library {
        /// <summary>"major.minor.patch"</summary>
        public static string Version { get { return ToText(Native.crofton_version_string()); } }

        static Library() {
            if (Native.crofton_api_version() != Native.ApiVersion)
                throw new CroftonException(Status.WrongSize, "these classes and the library that was loaded have different API versions", null);
            Native.crofton_set_thread_checks(1); // one world changed on two threads is an error, not a crash
        }

        // Every class calls it before it makes anything.
        internal static void Load() { }

        internal static void Check(int status) {
            if (status == 0) return;
            ulong item = Native.crofton_last_error_item();
            throw new CroftonException((Status)status, ToText(Native.crofton_last_error()), item == ulong.MaxValue ? (ulong?)null : item);
        }

        static string ToText(IntPtr text) {
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        // Copies an answer of the library's.
        internal static T[] ToArray<T>(IntPtr first, UIntPtr count) where T : struct {
            var result = new T[(int)count];
            int size = Marshal.SizeOf(typeof(T));
            for (int i = 0; i < result.Length; ++i)
                result[i] = (T)Marshal.PtrToStructure(new IntPtr(first.ToInt64() + (long)i * size), typeof(T));
            return result;
        }

        internal static void NotNull(object value, string name) {
            if (value == null) throw new ArgumentNullException(name);
        }
        internal static UIntPtr SameLength(Array a, Array b) {
            if (a == null || b == null) throw new ArgumentNullException(a == null ? "first" : "second");
            if (a.Length != b.Length) throw new ArgumentException("the two arrays are to be of one length");
            return (UIntPtr)a.Length;
        }
    }
}
