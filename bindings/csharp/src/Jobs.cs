// SPDX-License-Identifier: MIT
using System;
using System.Runtime.InteropServices;
using System.Threading;
using System.Threading.Tasks;

namespace Crofton {
    // The job system of a call: threads of .NET's pool.
    internal static class Jobs {
        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        delegate void RangeTask(IntPtr data, UIntPtr begin, UIntPtr end, uint worker);
        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        delegate void ParallelFor(IntPtr user, UIntPtr count, UIntPtr grain, IntPtr task, IntPtr data);
        static readonly ParallelFor parallelFor = Run; // the library has its address
        static readonly IntPtr address = Marshal.GetFunctionPointerForDelegate(parallelFor);

        // Calls `call` with jobs for so many threads; for one with none.
        internal static void With(int threads, Action<IntPtr> call) {
            if (threads < 1) throw new ArgumentOutOfRangeException("threads");
            if (threads == 1) {
                call(IntPtr.Zero);
                return;
            }
            using (var memory = new Copies())
                call(memory.Copied(new Native.JobsData {
                    Size = Native.SizeOf<Native.JobsData>(), User = new IntPtr(threads), Concurrency = (uint)threads, ParallelFor = address
                }));
        }
        static void Run(IntPtr user, UIntPtr count, UIntPtr grain, IntPtr task, IntPtr data) {
            var run = (RangeTask)Marshal.GetDelegateForFunctionPointer(task, typeof(RangeTask));
            long end = (long)count, step = (long)grain, ranges = end == 0 ? 0 : (end - 1) / step + 1, next = -1;
            Action<int> work = worker => {
                for (long range; (range = Interlocked.Increment(ref next)) < ranges;) {
                    long begin = range * step;
                    run(data, (UIntPtr)begin, (UIntPtr)(begin + Math.Min(step, end - begin)), (uint)worker);
                }
            };
            if (ranges <= 1) work(0);
            else Parallel.For(0, (int)Math.Min(user.ToInt64(), ranges), work);
        }
    }
}
