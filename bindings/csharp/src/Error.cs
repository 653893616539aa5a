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

    /// <summary>How grave a message is.</summary>
    public enum LogLevel { Debug = 0, Info = 1, Warning = 2, Error = 3 }

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

        /// <summary>Sends the library's messages to a function, on any thread; null: warnings and errors to the standard error, as at the start.
        /// No other thread may call the library at the same time.</summary>
        public static void SetLogger(Action<LogLevel, string> logger) {
            LogHook hook = null;
            if (logger != null)
                hook = (user, level, message) => {
                    try {
                        logger((LogLevel)level, ToText(message));
                    } catch (Exception e) { // which must not pass through the library
                        Console.Error.WriteLine(e);
                    }
                };
            Check(Native.crofton_set_log_hook(hook == null ? IntPtr.Zero : Marshal.GetFunctionPointerForDelegate(hook), IntPtr.Zero));
            GC.KeepAlive(logHook);
            logHook = hook;
        }
        /// <summary>Sends a message to where the library's go.</summary>
        public static void Log(LogLevel level, string message) { Check(Native.crofton_log((uint)level, ToBytes(message, "message"))); }

        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        delegate void LogHook(IntPtr user, uint level, IntPtr message);
        static LogHook logHook; // the library has its address

        internal static string ToText(IntPtr text) {
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0) ++length;
            return ToText(text, length);
        }
        internal static string ToText(IntPtr text, int length) {
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }
        // UTF-8 with a 0 at its end.
        internal static byte[] ToBytes(string text, string name) {
            NotNull(text, name);
            if (text.IndexOf('\0') >= 0) throw new ArgumentException("there is a 0 within", name);
            return Encoding.UTF8.GetBytes(text + "\0");
        }

        // Copies an answer of the library's.
        internal static T[] ToArray<T>(IntPtr first, UIntPtr count) where T : struct {
            var result = new T[(int)count];
            if (result.Length == 0) return result;
            int size = Marshal.SizeOf(typeof(T));
            long total = (long)result.Length * size;
            var part = new byte[Math.Min(total, 1 << 16)];
            GCHandle pinned = GCHandle.Alloc(result, GCHandleType.Pinned);
            try {
                long to = pinned.AddrOfPinnedObject().ToInt64();
                for (long at = 0; at < total; at += part.Length) {
                    int bytes = (int)Math.Min(part.Length, total - at);
                    Marshal.Copy(new IntPtr(first.ToInt64() + at), part, 0, bytes);
                    Marshal.Copy(part, 0, new IntPtr(to + at), bytes);
                }
            } finally {
                pinned.Free();
            }
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
