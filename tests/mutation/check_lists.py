#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that every mutant still applies: the text that it replaces is in its file exactly once, and is another then.

Also that the tests it names exist, and that what --together switches on is the same fault. Exit status 1 if not.
"""
import sys
from dataclasses import replace


import switches
from run import ROOT, all_mutants


def problems(mutants, root):
    for mutant in mutants:
        path = root / mutant.file
        if not path.is_file():
            yield f"{mutant.name}: there is no {mutant.file}"
            continue
        text = path.read_text()
        try:
            if mutant.apply(text) == text:
                yield f"{mutant.name}: changes nothing"
            edit = switches.edit(text, 1, mutant)
            if edit and not mutant.switch and text[:edit.begin] + edit.text + text[edit.end:] != mutant.apply(text):
                yield f"{mutant.name}: another fault with --together"
            if mutant.switch and "$ON" not in mutant.switch:
                yield f"{mutant.name}: its switch is never read"
        except ValueError as error:
            yield str(error)
        for test in mutant.tests:
            if not (root / "tests" / test).is_dir():
                yield f"{mutant.name}: there are no tests of {test}"


def check_itself(mutants):
    """A list with a fault of each kind must not pass."""
    one = next(m for m in mutants if m.at < 0)
    faults = [replace(one, find="no text like this"), replace(one, find=";"), replace(one, replace=one.find),
              replace(one, file="engine/none.cpp"), replace(one, tests=["none"]), replace(one, switch="never")]
    for fault in faults:
        if len(list(problems([fault], ROOT))) != 1:
            yield f"the check does not see a fault: {fault}"


def main():
    mutants = all_mutants()
    found = list(problems(mutants, ROOT)) + list(check_itself(mutants))
    for problem in found:
        print(problem, file=sys.stderr)
    print(f"{len(mutants)} mutants, {len(found)} problems")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
