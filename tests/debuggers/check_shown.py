# SPDX-License-Identifier: MIT
"""For gdb: compares what engine/crofton_gdb.py shows with the values of shown_values.cpp, and evaluates natvis' expressions.

gdb -nx -batch -ex "python root = 'CHECKOUT'" -x check_shown.py shown_values
"""
import re
import traceback
import xml.etree.ElementTree as xml

import gdb

SHOWN = {
    "box": "at (1, 2, 3), half extents (0.5, 0.25, 4) = {axis 0 = (1, 0, 0), axis 1 = (0, 1, 0), axis 2 = (0, 0, 1)}",
    "bounds": "(-1, -2, -3) to (1, 2, 3.5)",
    "empty": "empty",
    "sphere": "at (0, 1, -5), radius 1.5",
    "plane": "(0, 0, 1) · x + -2 ≥ 0",
    "pair": "3 – 7",
    "error": 'non_finite, item 5: "a corner is NaN"',
    "lone": 'io: "no such file"',
    "number": "42",
    "no_number": 'non_finite, item 5: "a corner is NaN"',
    "success": "success",
    "failure": 'non_finite, item 5: "a corner is NaN"',
    "null": "null",
    "first": "0, generation ",
    "visible": "0 items, 0 inside",
    "frustum": "6 planes around (7, 8, 9) = {plane 0 = ",
}
NAMESPACE = "{http://schemas.microsoft.com/vstudio/debugger/natvis/2010}"
problems = []


def expect(right, what):
    if not right:
        problems.append(what)


def check_printers():
    for name, text in SHOWN.items():
        shown = gdb.parse_and_eval(name).format_string(styling=False)
        exact = not text.endswith((" ", "= "))
        expect(shown == text if exact else shown.startswith(text), f"gdb shows {name} as {shown!r}, not {text!r}")


def expressions_of(entry):
    """All that Visual Studio would evaluate in a natvis entry; none of format specifiers."""
    for element in entry.iter():
        if "Condition" in element.attrib:
            yield element.attrib["Condition"]
        if element.tag == NAMESPACE + "DisplayString":
            yield from re.findall(r"\{([^}]*)\}", element.text)
        elif element.tag in (NAMESPACE + "Item", NAMESPACE + "Size", NAMESPACE + "ValuePointer"):
            yield element.text


def check_natvis():
    """Every member that natvis names is there: its expressions are valid for a value of the type."""
    seen, tried = set(), 0
    for entry in xml.parse(f"{root}/engine/crofton.natvis").getroot():  # noqa: F821, from the command line
        pattern = "^" + re.escape(entry.attrib["Name"]).replace(r"\*", ".*").replace(",", ", ?") + "$"
        values = [name for name in SHOWN if re.match(pattern, str(gdb.parse_and_eval(name).type.strip_typedefs().unqualified()))]
        expect(values, f"natvis: no value of type {entry.attrib['Name']} is looked at")
        for expression in expressions_of(entry):
            # Of Visual Studio's library alone: std::array's member.
            bare = expression.split(",")[0].replace("_Elems", "_M_elems")
            for name in values[:1]:
                try:
                    gdb.parse_and_eval(re.sub(r"(?<![\w.])([A-Za-z_]\w*)", name + r".\1", bare)).fetch_lazy()
                    tried += 1
                except gdb.error as error:
                    problems.append(f"natvis: {entry.attrib['Name']}: {expression}: {error}")
        seen.update(values)
    expect(tried > 30, f"natvis: only {tried} expressions were tried")
    for name in set(SHOWN) - seen:
        problems.append(f"natvis: has nothing for {name}")


def run():
    gdb.execute(f"source {root}/engine/crofton_gdb.py")  # noqa: F821
    gdb.execute("set disable-randomization off", to_string=True)
    gdb.execute("break stop_here", to_string=True)
    try:
        gdb.execute("run", to_string=True)
    except gdb.error as error:
        print(f"skipped: gdb cannot run a program here: {error}")
        gdb.execute("quit 0")
    gdb.execute("up", to_string=True)
    check_printers()
    check_natvis()


try:
    run()
except Exception:  # gdb would go on, and end with 0
    problems.append(traceback.format_exc())
print("\n".join(problems) or "gdb and natvis show what they should")
gdb.execute(f"quit {1 if problems else 0}")
