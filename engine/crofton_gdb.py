# SPDX-License-Identifier: MIT
"""How gdb shows Crofton's types: `source crofton_gdb.py`, or that line in ~/.gdbinit.

crofton::Vector is std::vector, which gdb knows; these are the types inside. crofton.natvis is the same for Visual Studio.
"""
import gdb
import gdb.printing

NO_ITEM = 2**64 - 1
NO_INDEX = 2**32 - 1


def vector(value):
    """The text of a glm vector."""
    names = [field.name for field in value.type.strip_typedefs().fields() if field.name in ("x", "y", "z", "w")]
    if not names:  # each component is an anonymous union of x, r, s
        names = "xyzw"[: value.type.strip_typedefs().sizeof // value["x"].type.sizeof]
    return "(" + ", ".join(f"{float(value[name]):g}" for name in names) + ")"


def column(matrix, i):
    return vector(matrix["value"][i])


class Obb:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"at {vector(self.value['center'])}, half extents {vector(self.value['half_extents'])}"

    def children(self):
        for i in range(3):
            yield f"axis {i}", column(self.value["axes"], i)


class Aabb:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        low, high = self.value["min"], self.value["max"]
        if not all(float(low[k]) <= float(high[k]) for k in "xyz"):
            return "empty"
        return f"{vector(low)} to {vector(high)}"


class Sphere:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"at {vector(self.value['center'])}, radius {float(self.value['radius']):g}"


class Plane:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"{vector(self.value['normal'])} · x + {float(self.value['offset']):g} ≥ 0"


class Frustum:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"{int(self.value['plane_count'])} planes around {vector(self.value['origin'])}"

    def children(self):
        planes = self.value["planes"]["_M_elems"]
        for i in range(min(int(self.value["plane_count"]), 12)):
            yield f"plane {i}", planes[i]


class IdPair:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"{int(self.value['first'])} – {int(self.value['second'])}"


class Error:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        code = str(self.value["code"]).split("::")[-1]
        item = int(self.value["item"])
        place = "" if item == NO_ITEM else f", item {item}"
        return f"{code}{place}: {self.value['message'].format_string()}"


class Handle:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        index = int(self.value["index"])
        return "null" if index == NO_INDEX else f"{index}, generation {int(self.value['generation'])}"


class Result:
    """A value, or the Error for which there is none."""

    def __init__(self, value):
        self.value = value

    def to_string(self):
        if not self.value["has_value_"]:
            return self.value["error_"].format_string()
        value = self.value["value_"]
        return "success" if value.type.strip_typedefs().name == "crofton::detail::Nothing" else value.format_string()


class VisibleSet:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"{int(self.value['size_'])} items, {int(self.value['inside_'])} inside"


def printers():
    collection = gdb.printing.RegexpCollectionPrettyPrinter("crofton")
    for printer in (Obb, Aabb, Sphere, Plane, Frustum, IdPair, Error):
        collection.add_printer(printer.__name__, f"^crofton::{printer.__name__}$", printer)
    collection.add_printer("VisibleSet", "^crofton::cull::VisibleSet$", VisibleSet)
    collection.add_printer("Handle", "^crofton::Handle<.*>$", Handle)
    collection.add_printer("Result", "^crofton::Result<.*>$", Result)
    return collection


gdb.printing.register_pretty_printer(None, printers(), replace=True)
