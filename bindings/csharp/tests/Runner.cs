// SPDX-License-Identifier: MIT
using System;
using System.Linq;
using System.Reflection;
using Crofton;

[AttributeUsage(AttributeTargets.Method)]
sealed class TestAttribute : Attribute { }

// What tests say of values.
static class Expect {
    public static void Equal<T>(T expected, T actual) {
        if (!object.Equals(expected, actual)) throw new Exception("expected " + expected + ", got " + actual);
    }
    public static void True(bool condition) {
        if (!condition) throw new Exception("a condition does not hold");
    }
    public static void Near(double expected, double actual, double tolerance = 1e-9) {
        if (!(Math.Abs(expected - actual) <= tolerance)) throw new Exception("expected about " + expected + ", got " + actual);
    }
    public static void Sequence<T>(T[] expected, T[] actual) {
        if (!expected.SequenceEqual(actual))
            throw new Exception("expected [" + string.Join(", ", expected) + "], got [" + string.Join(", ", actual) + "]");
    }
    public static T Throws<T>(Action action) where T : Exception {
        try { action(); } catch (T e) { return e; }
        throw new Exception("no " + typeof(T).Name + " was thrown");
    }
    public static CroftonException Fails(Status status, Action action) {
        var e = Throws<CroftonException>(action);
        Equal(status, e.Status);
        True(e.Message.Length > 10);
        return e;
    }
}

static class Runner {
    // Runs every method with [Test]; ends with the number of those that failed.
    static int Main() {
        int passed = 0, failed = 0;
        var tests = Assembly.GetExecutingAssembly().GetTypes().SelectMany(t => t.GetMethods(BindingFlags.Static | BindingFlags.NonPublic | BindingFlags.Public))
                            .Where(m => m.GetCustomAttributes(typeof(TestAttribute), false).Length > 0);
        foreach (var test in tests) {
            try {
                test.Invoke(null, null);
                ++passed;
            } catch (TargetInvocationException e) {
                ++failed;
                Console.WriteLine("FAILED {0}: {1}", test.Name, e.InnerException);
            }
        }
        Console.WriteLine("{0} passed, {1} failed", passed, failed);
        return failed == 0 && passed > 0 ? 0 : 1;
    }
}
