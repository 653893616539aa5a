#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""check_bindings.py ROOT: compares what the bindings of Rust, C# and JavaScript write down of the C API with its headers.

No compiler is needed. Of each struct that Rust and C# declare again, every member must lie at the offset and have the kind
and the name of the header's. Of each function, every parameter must have the kind of the header's. Constants must
have the header's values. JavaScript has offsets within its sources, which bindings/web/native/glue.c states: these are compared
with a 32-bit layout, and each call must name a function that is exported and give it as many arguments as it takes. Each function of
the headers is in each binding, or in a list here that says why not; so is each member of the structs that describe what is asked for.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])
HEADERS = ("engine/c_api/include/crofton/capi", "engine/bake/c_api/include/crofton/capi")
NUMBERS = {"f64": 8, "f32": 4, "u64": 8, "u32": 4, "i32": 4, "u16": 2, "u8": 1}
problems = []


def text_of(path):
    """A file without its comments."""
    text = re.sub(r"/\*.*?\*/", " ", (ROOT / path).read_text(encoding="utf-8"), flags=re.S)
    return re.sub(r"//[^\n]*", " ", text)


def all_text(folder, pattern):
    return "".join(text_of(path.relative_to(ROOT)) for path in sorted((ROOT / folder).glob(pattern)))


def split_list(text, separator=","):
    """Splits at separators outside of brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "([{<") - (letter in ")]}>")
        if letter == separator and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


class Struct:
    """Members in order: (name, type, how often). A type is a kind of NUMBERS, "ptr", "usize" or another Struct."""

    def __init__(self, name, members):
        self.name, self.members = name, members


def align(kind, word):
    if isinstance(kind, Struct):
        return max(align(inner, word) for _, inner, _ in kind.members)
    return NUMBERS.get(kind, word)


def layout(kind, word, at=0):
    """The numbers of a type, [(offset, kind)], and its size with padding."""
    if not isinstance(kind, Struct):
        return [(at, kind)], NUMBERS.get(kind, word)
    cells, size = [], 0
    for _, inner, count in kind.members:
        size += -size % align(inner, word)
        for _ in range(count):
            more, bytes_of = layout(inner, word, at + size)
            cells += more
            size += bytes_of
    return cells, size + -size % align(kind, word)


def offsets(struct, word):
    """Where each member of a struct begins."""
    places, size = {}, 0
    for name, inner, count in struct.members:
        size += -size % align(inner, word)
        places[name] = size
        size += count * layout(inner, word)[1]
    return places


# The headers.

C_KINDS = {"double": "f64", "float": "f32", "uint64_t": "u64", "uint32_t": "u32", "int": "i32", "uint16_t": "u16",
           "uint8_t": "u8", "size_t": "usize", "crofton_status": "i32"}


class Headers:
    def __init__(self):
        text = "".join(all_text(folder, "*.h") for folder in HEADERS)
        self.constants = {name: int(value.rstrip("u"), 0)
                          for name, value in re.findall(r"#define (CROFTON_\w+) (0x[0-9a-f]+u?|\d+u?)\s", text)}
        for body in re.findall(r"typedef enum \w+ \{(.*?)\}", text, re.S):
            for name, value in re.findall(r"(CROFTON_\w+)\s*=\s*(\d+)", body):
                self.constants[name] = int(value)
        found = dict(re.findall(r"typedef struct (crofton_\w+) \{(.*?)\} crofton_\w+;", text, re.S))
        self.structs = {}
        self.bodies = found
        for name in found:
            self.struct(name)
        self.functions = {}
        for result, name, parameters in re.findall(r"CROFTON_API ([\w* ]+?[ *])(crofton_\w+)\(([^;]*)\);", text):
            kinds = [] if parameters.strip() == "void" else [self.parameter(p) for p in split_list(parameters)]
            self.functions[name] = (self.kind(result), kinds)

    def struct(self, name):
        if name not in self.structs:
            members = []
            for line in self.bodies[name].split(";"):
                line = " ".join(line.split())
                if not line:
                    continue
                if "(*" in line:
                    members.append((re.search(r"\(\*(\w+)\)", line)[1], "ptr", 1))
                    continue
                kind, rest = re.fullmatch(r"((?:const )?\w+(?: ?\*(?: ?const ?\*)?)?) ?(.*)", line).groups()
                for declared in split_list(rest):
                    member, count = re.fullmatch(r"(\w+)(?:\[(.*)\])?", declared).groups()
                    members.append((member, self.kind(kind), self.count(count)))
            self.structs[name] = Struct(name, members)
        return self.structs[name]

    def count(self, text):
        if not text:
            return 1
        if text == "sizeof(void*) - 1":  # fills up to the next pointer; no binding declares it
            return 7
        return self.constants[text] if text in self.constants else int(text)

    def kind(self, text):
        text = re.sub(r"\b(const|struct)\b", "", text).replace(" ", "")
        if "*" in text or text.endswith(("_hook", "_task")):
            return "ptr"
        return C_KINDS.get(text) or (self.struct(text) if text in self.bodies else text)

    def parameter(self, text):
        """(kind, what it points to or None)"""
        text = re.sub(r"\bconst\b", "", text)
        kind, pointer, array = re.fullmatch(r"\s*(\w+)\s*(\**\s*\**)\s*\w*(\[.*\])?\s*", text).groups()
        levels = pointer.count("*") + (1 if array else 0)
        return self.pointer(kind, levels)

    def pointer(self, kind, levels):
        if levels == 0:
            return self.kind(kind), None
        if levels > 1:
            return "ptr", "ptr"
        known = C_KINDS.get(kind) or (self.struct(kind) if kind in self.bodies else None)
        return "ptr", known


def same_layout(where, ours, theirs):
    """Says where a type of a binding differs from the header's, by kinds."""
    if layout(ours, 8) != layout(theirs, 8):
        problems.append(f"{where}: not laid out as {theirs.name if isinstance(theirs, Struct) else theirs} of the headers: "
                        f"{first_difference(ours, theirs)}")


def first_difference(ours, theirs):
    a, b = layout(ours, 8), layout(theirs, 8)
    for one, other in zip(a[0], b[0]):
        if one != other:
            return f"there is {other[1]} at byte {other[0]} in the header, and {one[1]} at byte {one[0]} here"
    return f"{b[1]} bytes in the header, {a[1]} here" if a[1] != b[1] else f"{len(b[0])} numbers in the header, {len(a[0])} here"


def plain(name):
    return name.lower().replace("_", "")


# Where the header has an array or a struct, and a binding its parts.
SPLIT = {("C0", "linear"), ("Axis0", "axes"), ("HalfEdge0", "half_edges"), ("child", "part"), ("first_triangle", "triangles"),
         ("FirstTriangle", "triangles")}


def same_names(where, ours, theirs):
    """Members that begin at the same byte have the same name, or one contains the other."""
    here = {place: name for name, place in offsets(ours, 8).items()}
    for name, place in offsets(theirs, 8).items():
        told = here.get(place)
        if told and plain(name) not in plain(told) and plain(told) not in plain(name) and (told, name) not in SPLIT:
            problems.append(f"{where}.{told} lies where {theirs.name}.{name} of the headers does")


def check_struct(where, ours, c_name, headers):
    if c_name not in headers.structs:
        problems.append(f"{where}: the headers have no {c_name}")
        return
    same_layout(where, ours, headers.structs[c_name])
    same_names(where, ours, headers.structs[c_name])


def check_function(where, name, result, parameters, headers):
    if name not in headers.functions:
        problems.append(f"{where}: the headers have no {name}")
        return
    c_result, c_parameters = headers.functions[name]
    if layout(result, 8) != layout(c_result, 8):
        problems.append(f"{where}: {name} returns another type")
    if len(parameters) != len(c_parameters):
        problems.append(f"{where}: {name} takes {len(c_parameters)} parameters, not {len(parameters)}")
        return
    for i, ((kind, target), (c_kind, c_target)) in enumerate(zip(parameters, c_parameters)):
        if layout(kind, 8) != layout(c_kind, 8):
            problems.append(f"{where}: parameter {i} of {name} is {shown(c_kind)}, not {shown(kind)}")
        elif target and c_target and layout(target, 8) != layout(c_target, 8) and not numbers_of(target, c_target):
            problems.append(f"{where}: parameter {i} of {name} points to {shown(c_target)}, not {shown(target)}")


def numbers_of(one, other):
    """Whether one is an array of the other's numbers: a Vector3 where the header has double*."""
    a, b = {kind for _, kind in layout(one, 8)[0]}, {kind for _, kind in layout(other, 8)[0]}
    return a == b and len(a) == 1


def shown(kind):
    return kind.name if isinstance(kind, Struct) else kind


def snake(name):
    return re.sub(r"(?<=[a-z0-9])([A-Z])", r"_\1", name).lower()


# Rust.

RUST_KINDS = {**{kind: kind for kind in NUMBERS}, "usize": "usize", "c_int": "i32", "Status": "i32", "c_char": "u8",
              "RangeTask": "ptr"}
RUST_NAMES = {"crate::Obb": "crofton_box", "crate::Mesh": "crofton_world_mesh"}


class Rust:
    """sys.rs, and the structs of the crate that it names crate::Name."""

    def __init__(self, headers):
        self.headers = headers
        self.text = text_of("bindings/rust/src/sys.rs")
        crate = all_text("bindings/rust/src", "?[!y]*.rs")
        self.bodies = {}
        declared = re.compile(r"#\[repr\(C\)\](?:\s*#\[[^\n]*\])*\s*pub struct (\w+) \{(.*?)\n\s*\}", re.S)
        for prefix, text in (("", self.text), ("crate::", crate)):
            self.bodies.update((prefix + name, body) for name, body in declared.findall(text))
        for name in re.findall(r"^handle!\((\w+),", crate, re.M):
            self.bodies["crate::" + name] = "index: u32, generation: u32"
        self.opaque = ", ".join(re.findall(r"^opaque!\((.*?)\);", self.text, re.M)).split(", ")
        self.constants = dict(re.findall(r"pub const (\w+): \w+ = (\d+);", self.text))

    def kind(self, text):
        """(type, how often, what it points to or None)"""
        if text.startswith("*"):
            inner = re.sub(r"^\*(const|mut) ", "", text)
            return "ptr", 1, "ptr" if inner.startswith("*") else self.target(inner)
        if array := re.fullmatch(r"\[(.*); (\w+)\]", text):
            inner, count, _ = self.kind(array[1])
            return inner, count * int(self.constants.get(array[2], array[2])), None
        if "extern" in text:
            return "ptr", 1, None
        if text in RUST_KINDS:
            return RUST_KINDS[text], 1, None
        if text in self.bodies:
            return self.struct(text), 1, None
        if "crate::" + text in self.bodies:
            return self.struct("crate::" + text), 1, None
        return "u8", 1, None  # an enum of a byte: #[repr(u8)]

    def target(self, text):
        if text in self.opaque or text == "c_void":
            return None
        return self.kind(text)[0]

    def struct(self, name):
        members = []
        for line in split_list(self.bodies[name]):
            if found := re.fullmatch(r"(?:pub(?:\(crate\))? )?(\w+): (.*)", line, re.S):
                kind, count, _ = self.kind(" ".join(found[2].split()))
                members.append((found[1], kind, count))
        return Struct(name, members)

    def check(self):
        for name in self.bodies:
            if name in ("$name", "crate::$name"):
                continue
            c_name = RUST_NAMES.get(name, "crofton_" + snake(name.split("::")[-1]))
            check_struct(f"bindings/rust: {name}", self.struct(name), c_name, self.headers)
        for name, parameters, result in re.findall(r"pub fn (crofton_\w+)\((.*?)\)(?: -> ([^;]+))?;", self.text, re.S):
            kinds = [self.kind(" ".join(p.split(":", 1)[1].split())) for p in split_list(parameters)]
            check_function("bindings/rust/src/sys.rs", name, self.kind(result)[0],
                           [(kind, target) for kind, _, target in kinds], self.headers)
        for name, value in self.constants.items():
            check_constant("bindings/rust/src/sys.rs", "CROFTON_" + name, int(value), self.headers)


def check_constant(where, name, value, headers):
    if name not in headers.constants:
        problems.append(f"{where}: the headers have no {name}")
    elif headers.constants[name] != value:
        problems.append(f"{where}: {name} is {headers.constants[name]}, not {value}")


# C#.

SHARP_KINDS = {"double": "f64", "float": "f32", "ulong": "u64", "uint": "u32", "int": "i32", "byte": "u8", "ushort": "u16",
               "UIntPtr": "usize", "IntPtr": "ptr"}
SHARP_NAMES = {"Obb": "box", "ObjectHandle": "object", "NodeHandle": "node", "MeshHandle": "world_mesh",
               "ObjectData": "object_description", "MeshData": "mesh_data", "ClosestData": "closest_object",
               "ContactData": "object_contact", "PictureData": "picture_view", "PlainMeshData": "mesh"}
SHARP_OWN = {"Vector3", "Float3", "Float4", "Edge"}  # three or four numbers each, where the headers have arrays


class Sharp:
    def __init__(self, headers):
        self.headers = headers
        self.text = all_text("bindings/csharp/src", "*.cs")
        self.bodies = {}
        declared = r"StructLayout\(LayoutKind\.Sequential\)\]\s*(?:public|internal) struct (\w+)[^{]*\{"
        for found in re.finditer(declared, self.text):
            self.bodies[found[1]] = self.braces(found.end())
        self.constants = {}
        for line in re.findall(r"const u?int ([^;]*);", text_of("bindings/csharp/src/Native.cs")):
            self.constants.update(re.findall(r"(\w+) = (\d+)", line))

    def braces(self, at):
        """The text up to the brace that closes what begins at `at`, without what inner braces hold."""
        depth, body = 1, ""
        while depth:
            depth += (self.text[at] == "{") - (self.text[at] == "}")
            if depth == 1:
                body += "{};" if self.text[at] == "}" else self.text[at]
            at += 1
        return body

    def kind(self, text):
        text = text.split(".")[-1]
        if text in SHARP_KINDS:
            return SHARP_KINDS[text]
        return self.struct(text) if text in self.bodies else "ptr"  # else a class: a handle that is owned

    def struct(self, name):
        members = []
        for line in self.bodies[name].split(";"):
            line = " ".join(line.split())
            count = 1
            if "{}" in line or "static" in line:  # a function, a property, a struct
                continue
            if array := re.match(r"\[MarshalAs\(.*SizeConst = (.*?)\)\] ", line):
                count = 1
                for factor in array[1].split("*"):
                    count *= int(self.constants.get(factor.strip(), factor.strip() if factor.strip().isdigit() else 0))
                line = line[array.end():].replace("[]", "")
            if found := re.fullmatch(r"(?:public |internal )?([\w.]+) ([\w, ]+)", line):
                members += [(member, self.kind(found[1]), count) for member in split_list(found[2])]
        return Struct(name, members)

    def parameter(self, text):
        text = re.sub(r"^(\[\w+\] )?", "", text)
        kind = text.split()[-2]
        if kind.endswith("[]"):
            return "ptr", self.kind(kind[:-2])
        if text.startswith(("ref ", "out ")):
            return "ptr", self.kind(kind)
        return self.kind(kind), None

    def check(self):
        for name in self.bodies:
            if name not in SHARP_OWN:
                c_name = "crofton_" + SHARP_NAMES.get(name, snake(re.sub("Data$", "", name)))
                check_struct(f"bindings/csharp: {name}", self.struct(name), c_name, self.headers)
        declared = r"DllImport\(\w+\)\] internal static extern (\w+) (crofton_\w+)\((.*?)\);"
        for result, name, parameters in re.findall(declared, self.text):
            check_function("bindings/csharp/src/Native.cs", name, self.kind(result),
                           [self.parameter(p) for p in split_list(parameters)], self.headers)
        for name, value in self.constants.items():
            check_constant("bindings/csharp/src/Native.cs", "CROFTON_" + snake(name).upper(), int(value), self.headers)


# JavaScript.

def check_glue(headers):
    """glue.c says what js/ assumes: compared here for a pointer of four bytes."""
    text = text_of("bindings/web/native/glue.c")
    for name, size in re.findall(r"^SIZE\((\w+), (\d+)\);", text, re.M):
        told = layout(headers.structs[name], 4)[1]
        if told != int(size):
            problems.append(f"bindings/web: {name} has {told} bytes, not {size}: mend js/ and native/glue.c")
    for name, member, place in re.findall(r"^AT\((\w+), (\w+), (\d+)\);", text, re.M):
        told = offsets(headers.structs[name], 4).get(member)
        if told != int(place):
            problems.append(f"bindings/web: {name}.{member} is at byte {told}, not {place}: mend js/ and native/glue.c")


def check_web_calls(headers):
    exported = re.search(r'EXPORTED = """(.*?)"""', (ROOT / "bindings/web/build.py").read_text(encoding="utf-8"), re.S)[1].split()
    for name in exported:
        if name != "web_error_item" and f"crofton_{name}" not in headers.functions:
            problems.append(f"bindings/web/build.py exports crofton_{name}, which the headers do not have")
    for path in sorted((ROOT / "bindings/web/js").glob("*.js")):
        text = text_of(path.relative_to(ROOT))
        where = f"bindings/web/js/{path.name}"
        for found in re.finditer(r"\.call\(|\.fill\(|(?<![.\w])create\(memory, ", text):
            given = arguments(text, found.end())
            if not given or not given[0].startswith("'"):  # a definition, or an array's fill
                continue
            name, count = given[0].strip("'"), len(given) - 1
            if found[0].startswith("create"):
                name, count = name + "_create", count + 1
            if name not in exported:
                problems.append(f"{where} calls crofton_{name}, which build.py does not export")
            elif found[0] != ".fill(" and not any(part.startswith("...") for part in given):
                takes = len(headers.functions[f"crofton_{name}"][1])
                if takes != count:
                    problems.append(f"{where} gives crofton_{name} {count} arguments, and it takes {takes}")


def arguments(text, at):
    depth, start = 1, at
    while depth:
        depth += (text[at] in "([{") - (text[at] in ")]}")
        at += 1
    return split_list(text[start:at - 1].replace("=>", "="))


# Functions that a binding does without, as the beginnings of their names, and why; its README says so, too. What is not here must be
# there: a new function of the headers is added to each binding, or to this list.
EVERYWHERE = {
    "scene_": "the command line bakes", "tree_": "World has a tree", "baked_scene_open": "it reads files, and does not map them",
    "shape_contacts_": "World keeps contacts", "shape_outline": "World's contacts have the points", "shape_parts_near": "World's contacts have them",
    "shape_create_with_jobs": "World.update uses threads", "shape_raycast_any": "shape_raycast says it", "meshes_": "shapes of meshes and World's contacts",
    "broadphase_get_statistics": "of interest to this library alone", "default_manifold_options": "all 0", "default_query_filter": "written out",
    "status_name": "named by the binding's type", "set_memory_hooks": "other languages allocate elsewhere", "set_assert_hook": "for debugging in C",
}
LEFT_OUT = {
    "rust": {"set_thread_checks": "the compiler checks", "default_mesh_data": "written out", "default_depth_receivers": "written out",
             "default_shadow_receivers": "written out"},
    "csharp": {"default_cast_options": "written out"},
    "web": {"api_version": "one file holds both", "set_thread_checks": "there are no threads", "world_contains_node": "removing one says it",
            "broadphase_": "World has one", "boxes_": "shapes of boxes", "box_": "shapes of boxes", "criterion_for_": "the caller gives weights",
            "fit_boxes": "fitBox takes their corners", "clustered_mesh_lend": "arrays of JavaScript are not in the library's memory",
            "clustered_mesh_box": "a view needs none", "permute_triangles": "written in JavaScript", "world_get_occluder": "given ones are known",
            "default_find_options": "the defaults", "default_cast_options": "written out", "last_error_item": "web_error_item",
            "baked_": "the readers would make the package too large", "region_index_": "as baked_", "default_baked_": "as baked_", "pvs_": "as baked_"},
}


def check_complete(headers):
    exported = re.search(r'EXPORTED = """(.*?)"""', (ROOT / "bindings/web/build.py").read_text(encoding="utf-8"), re.S)[1].split()
    declared = {"rust": set(re.findall(r"fn crofton_(\w+)\(", text_of("bindings/rust/src/sys.rs"))),
                "csharp": set(re.findall(r" crofton_(\w+)\(", text_of("bindings/csharp/src/Native.cs"))), "web": set(exported)}
    for binding, names in declared.items():
        left_out = {**EVERYWHERE, **LEFT_OUT[binding]}
        used = set()
        for name in (function[len("crofton_"):] for function in headers.functions):
            whys = [start for start in left_out if name.startswith(start)]
            used.update(whys)
            if name not in names and not whys:
                problems.append(f"bindings/{binding} has no crofton_{name}: add it, or say here why it does without")
        for start in set(LEFT_OUT[binding]) - used:
            problems.append(f"bindings/{binding}: there is no crofton_{start} to leave out")
    count = {library: len((ROOT / library / "symbols.txt").read_text().split()) for library in ("engine/c_api", "engine/bake/c_api")}
    told = "The runtime library has {} functions, `crofton_bake` {}:".format(*count.values())
    text = (ROOT / "engine/c_api/README.md").read_text(encoding="utf-8")
    if told not in text:
        problems.append(f"engine/c_api/README.md: {told}")
    rows = sum(int(number) for number in re.findall(r"^\| .* \| (\d+) \|$", text, re.M))
    if rows != count["engine/c_api"]:
        problems.append(f"engine/c_api/README.md: its table counts {rows} functions, of {count['engine/c_api']}")


# Descriptions: what a caller fills. Each member of C++ is in C and in each binding under its own name, or here says why not.

# Of each struct of C++: C's; Rust's; C#'s, JavaScript's and Python's, where they have one, or the calls whose arguments it becomes.
DESCRIPTIONS = {
    "ObjectDescription": ("object_description", "Description", "Add", "ObjectDescription", "add"),
    "MeshDescription": ("mesh_data", "MeshData", "AddMesh", "MeshOptions addMesh", "add_mesh"),
    "NodeDescription": ("world_add_node", "add_node", "AddNode", "addNode", "add_node"),
    "OcclusionOptions": ("occlusion_options", "OcclusionOptions", "OcclusionOptions", "ViewRequest", "OcclusionOptions"),
    "ViewMatrix": ("view_matrix", "ViewMatrix", "ViewMatrix", "ViewRequest", "ViewMatrix"),
    "ShadowReceivers": ("shadow_receivers", "ShadowReceivers", "ShadowReceivers", "ViewRequest", "ShadowReceivers"),
    "ViewRequest": ("view_request", "ViewRequest", "ViewRequest", "ViewRequest", "ViewRequest"),
    "QueryFilter": ("query_filter", "QueryFilter", "QueryFilter", "Filter", "raycast"),
    "WorldOptions": ("world_options", "WorldOptions", "WorldOptions", "WorldOptions", "World"),
    "RegionObject": ("region_object", "RegionObject", "Of", "RegionObject", "prepare"),
    "RegionOptions": ("region_options", "RegionOptions", "Region", "RegionOptions", "prepare"),
    "PictureView": ("picture_view", "PictureView", "PictureView", "Picture", "PictureView"),
    "DepthObject": ("depth_object", "DepthObject", "DepthObject", "DepthObject", "DepthObject"),
    "DepthReceivers": ("depth_receivers", "find_casters", "DepthReceivers FindCasters", "findCasters", "find_casters"),
    "DrawLimits": ("draw_limits", "DrawLimits", "DrawLimits", "DrawLimits", "DrawLimits"),
}
# Other names of a member: where a language's custom or an argument's place tells more.
ALSO = {"size": "width height", "to_clip": "matrix doubles", "mode": "conservative", "order": "tree_order",
        "candidate_mask": "candidates", "bound": "box boxes", "positions": "vertices", "mesh": "meshes instances", "transform": "transforms instances", "user": "users",
        "objects": "receivers", "meshes": "instances", "occludes": "occluders"}
# (struct, member, languages without it): why.
WITHOUT = [
    ("MeshDescription", "occluders", "c rust csharp web", "a call of its own: find_occluders"),
    ("MeshDescription", "box", "c rust csharp web python", "an exact box comes from a bake, which is C++"),
    ("WorldOptions", "tree", "c rust csharp web", "aligned boxes are the better choice but for long oblique things"),
    ("WorldOptions", "trace", "c rust csharp web python", "a profiler's hooks are C++"),
    ("RegionOptions", "tree", "c rust csharp web python", "as WorldOptions"),
    ("RegionOptions", "built", "c rust csharp web python", "a tree of C++; crofton_baked_region_open has it in the file"),
    ("RegionOptions", "keep", "c rust csharp web python", "the library counts who uses a shape"),
    ("RegionOptions", "should_stop", "rust csharp web python", "regions of many objects are baked, and opened at once"),
    ("RegionOptions", "stop_user", "rust csharp web python", "as should_stop"),
    ("RegionOptions", "max_objects", "csharp web python", "the array's length says it"),
    ("RegionObject", "shape", "python", "arrays of boxes and of meshes are the fast ways of Python"),
    ("RegionObject", "only_occludes", "python", "as shape"),
]


def check_descriptions():
    cpp = "".join(all_text(f"engine/{room}", "*/include/crofton/*/*.hpp") for room in ("world", "view"))
    c = "".join(all_text(folder, "*.h") for folder in HEADERS)
    rust, sharp = all_text("bindings/rust/src", "?[!y]*.rs"), all_text("bindings/csharp/src", "*.cs")
    web, python = text_of("bindings/web/crofton.d.ts"), re.sub(r"#.*", "", (ROOT / "bindings/python/crofton/__init__.pyi").read_text(encoding="utf-8"))
    used = set()

    def braced(text, beginning):
        """What the braces or brackets after each match hold."""
        parts = []
        for found in re.finditer(beginning, text):
            at, depth = found.end(), 1
            while depth:
                depth += (text[at] in "{(") - (text[at] in "})")
                at += 1
            parts.append(text[found.end():at])
        return " ".join(parts)

    def said_by(language, names):
        """The words that the declarations of one binding use, without case and underscores."""
        text = ""
        for name in names.split():
            if language == "c":
                text += braced(c, rf"typedef struct crofton_{name} \{{") + braced(c, rf"crofton_{name}\(")
            elif language == "rust":
                text += braced(rust, rf"pub struct {name}(?:<'a>)? \{{") + braced(rust, rf"pub fn {name}(?:<[^(]*>)?\(")
            elif language == "csharp":
                text += braced(sharp, rf"public (?:sealed )?(?:partial )?(?:class|struct) {name} [^{{]*\{{") if not re.search(rf"public {name}\(", sharp) else ""
                text += braced(sharp, rf"public (?:static )?(?:\w+(?:\[\])? )?{name}\(")
            elif language == "web":
                text += braced(web, rf"export interface {name} \{{") + braced(web, rf"(?<!\w){name}\(") + braced(web, rf"export type {name} = number \| \{{")
            else:
                text += braced(python, rf"class {name}:\n(?:    [^\n]*\n)*?    def __init__\(") + braced(python, rf"def {name}\(")
        return {plain(word) for word in re.findall(r"\w+", text)}

    for struct, names in DESCRIPTIONS.items():
        body = re.search(rf"struct {struct} \{{(.*?)\n\}};", cpp, re.S)
        if not body:
            problems.append(f"check_bindings.py: C++ has no struct {struct}")
            continue
        members = [re.search(r"(\w+)\s*(?:[={].*)?$", " ".join(line.split()))[1] for line in body[1].split(";")[:-1]
                   if not re.match(r"\s*(static|using|\[\[)", line)]
        for language, declared in zip(("c", "rust", "csharp", "web", "python"), names):
            said = said_by(language, declared)
            if not said:
                problems.append(f"bindings: {language} has no {declared}, in which {struct} of C++ is told")
            for member in members:
                reason = next((row for row in WITHOUT if row[:2] == (struct, member) and language in row[2].split()), None)
                there = any(plain(word) in said for word in (member, *ALSO.get(member, "").split()))
                if reason:
                    used.add((*reason[:2], language))
                if not there and not reason:
                    problems.append(f"{language}: {declared} has no {member} of C++'s {struct}: add it, or say in check_bindings.py why not")
                elif there and reason:
                    problems.append(f"check_bindings.py: {language} has {struct}.{member} now: take it out of WITHOUT")
    for struct, member, languages, _ in WITHOUT:
        for language in languages.split():
            if (struct, member, language) not in used:
                problems.append(f"check_bindings.py: WITHOUT names {struct}.{member}, which C++ does not have")


headers = Headers()
rust, sharp = Rust(headers), Sharp(headers)
rust.check()
sharp.check()
check_glue(headers)
check_web_calls(headers)
check_complete(headers)
check_descriptions()
if problems:
    sys.exit("\n".join(dict.fromkeys(problems)))
