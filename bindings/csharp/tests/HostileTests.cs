// SPDX-License-Identifier: MIT
using System;
using System.Collections.Generic;
using System.Linq;
using System.Reflection;
using Crofton;

// A random walk over everything that is public: each call with arguments of any kind answers, or throws an exception that says what is wrong.
static class HostileTests {
    const BindingFlags Own = BindingFlags.Public | BindingFlags.Static | BindingFlags.Instance | BindingFlags.DeclaredOnly;
    const BindingFlags Fields = BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.Instance;
    static readonly double[] Doubles = { 0, 1, -1, double.NaN, double.PositiveInfinity, double.NegativeInfinity, 1e308, 5e-324, 0.5, 1e20 };
    static readonly ulong[] Whole = { 0, 1, 2, 3, 64, ulong.MaxValue, 1UL << 31, 65537 };
    static readonly string[] Texts = { null, "", "x", "/nonexistent", "/", "\0" };
    static readonly int[] Lengths = { 0, 1, 2, 3, 4, 9, 12, 16, 36 };

    static T Any<T>(this Random dice, T[] values) { return values[dice.Next(values.Length)]; }

    static object Value(Type type, Random dice, List<object> made, int depth = 0) {
        if (type.IsByRef) type = type.GetElementType();
        Type inner = Nullable.GetUnderlyingType(type);
        if (inner != null) return dice.Next(3) == 0 ? null : Value(inner, dice, made, depth);
        var fitting = made.Where(type.IsInstanceOfType).ToArray();
        if (fitting.Length > 0 && dice.Next(3) != 0) return dice.Any(fitting);
        if (type == typeof(double)) return dice.Any(Doubles);
        if (type == typeof(float)) return (float)dice.Any(Doubles);
        if (type == typeof(bool)) return dice.Next(2) == 0;
        if (type == typeof(string)) return dice.Any(Texts);
        if (type.IsEnum) return Enum.ToObject(type, dice.Next(-1, 12));
        if (type == typeof(int)) return unchecked((int)dice.Any(Whole));
        if (type == typeof(uint)) return unchecked((uint)dice.Any(Whole));
        if (type == typeof(byte)) return unchecked((byte)dice.Any(Whole));
        if (type == typeof(ulong)) return dice.Any(Whole);
        if (typeof(Delegate).IsAssignableFrom(type) || type == typeof(IntPtr)) return type.IsValueType ? (object)IntPtr.Zero : null;
        if (type.IsArray) {
            if (dice.Next(6) == 0) return null;
            var array = Array.CreateInstance(type.GetElementType(), dice.Any(Lengths));
            for (int i = 0; i < array.Length && depth < 3; ++i) array.SetValue(Value(type.GetElementType(), dice, made, depth + 1), i);
            return array;
        }
        if (!type.IsValueType && (depth > 3 || dice.Next(5) == 0)) return null;
        return New(type, dice, made, depth + 1);
    }
    static object New(Type type, Random dice, List<object> made, int depth) {
        var constructors = type.GetConstructors();
        object result;
        if (type.IsValueType) result = Activator.CreateInstance(type);
        else if (constructors.Length == 0) return null;
        else {
            ConstructorInfo constructor = dice.Any(constructors);
            try {
                result = constructor.Invoke(constructor.GetParameters().Select(p => Value(p.ParameterType, dice, made, depth + 1)).ToArray());
            } catch (TargetInvocationException) {
                return null;
            }
        }
        foreach (FieldInfo field in type.GetFields(type.IsValueType ? Fields : BindingFlags.Public | BindingFlags.Instance))
            if (depth < 5 && !field.IsInitOnly && field.FieldType != typeof(IntPtr) && dice.Next(2) == 0) {
                object value = Value(field.FieldType, dice, made, depth + 1);
                if (value != null || !field.FieldType.IsValueType) field.SetValue(result, value);
            }
        return result;
    }

    [Test] static void NoCallEndsWithoutAnAnswerOrANamedException() {
        var types = typeof(World).Assembly.GetExportedTypes().Where(t => !t.IsEnum && !typeof(Delegate).IsAssignableFrom(t)).OrderBy(t => t.FullName).ToArray();
        for (int seed = 0; seed < 2; ++seed) {
            var dice = new Random(seed);
            var made = new List<object>();
            for (int step = 0; step < 2000; ++step) {
                Type type = dice.Any(types);
                var calls = type.GetMethods(Own).Cast<MethodBase>().Concat(type.GetConstructors()).ToArray();
                if (calls.Length == 0) continue;
                MethodBase call = dice.Any(calls);
                // A log is written to; memory for 2^31 objects is there on some machines.
                if (call.ContainsGenericParameters || call.Name == "Log" || call.Name == "Reserve" || call.Name == "Dispose" && dice.Next(10) != 0) continue;
                object on = call.IsStatic || call.IsConstructor ? null : Value(type, dice, made);
                if (on == null && !call.IsStatic && !call.IsConstructor) continue;
                object[] given = call.GetParameters().Select(p => Value(p.ParameterType, dice, made)).ToArray();
                try {
                    object answer = call.IsConstructor ? ((ConstructorInfo)call).Invoke(given) : call.Invoke(on, given);
                    if (answer != null && made.Count < 300) made.Add(answer);
                } catch (TargetInvocationException thrown) {
                    Exception e = thrown.InnerException;
                    if (!(e is CroftonException || e is ArgumentException || e is ObjectDisposedException || e is System.IO.IOException) || e.Message.Length == 0)
                        throw new Exception(type.Name + "." + call.Name + " throws " + e);
                } catch (ArgumentException) { }  // reflection's: of no such type
            }
        }
    }
}
