#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sentences of more than 25 words, in comments of C++, C and GLSL and in pages.

  long_sentences.py [FILE …]   lists those of the files, or of all tracked ones
  long_sentences.py --check    exits with 1 where a module or folder has more of them than long_sentences.txt allows
  long_sentences.py --write    writes what there is into long_sentences.txt, which thereby only shrinks

A comment's lines that follow each other are one paragraph. A page's list items and table cells are paragraphs of their
own; code and links' addresses are left out. A formula counts as one word. A sentence ends with . ! ? or the paragraph; a list of
errors is counted item by item.
"""
import pathlib
import re
import subprocess
import sys

LIMIT = 25
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUDGETS = pathlib.Path(__file__).with_name("long_sentences.txt")
CODE = {".hpp", ".cpp", ".h", ".c", ".cc", ".comp", ".vert", ".frag", ".glsl"}
MARK = re.compile(r"//|/\*|\*")
ABBREVIATIONS = re.compile(r"\b(e\.g|i\.e|etc|cf|et al|vs|eq|sec|ch|no|vol|fig|p|pp|St|Dr)\.", re.IGNORECASE)


def comment_of(line):
    """The text of a line's comment, or None, and whether code stands before it."""
    stripped = line.strip()
    if stripped.startswith(("//", "/*", "* ")) or stripped in ("*", "*/"):
        return re.sub(r"^(///?<?|/\*\*?<?|\*/?)\s?|\s*\*/$", "", stripped), False
    trailing = re.search(r"[^:\"]//\s(?!.*\"[^\"]*$)(.*)$", line)
    if trailing:
        return trailing[1].strip(), True
    trailing = re.search(r"/\*\s(.*?)\s*\*/\s*$", line)
    return (trailing[1], True) if trailing else (None, False)


def paragraphs_of_code(lines):
    """(line number, text) of each comment; what stands below one behind code goes on with it if it begins in its column."""
    number, words, column = 0, [], 0
    for index, line in enumerate(lines, 1):
        text, behind = comment_of(line)
        begins = text is None or behind or not text.strip() or re.match(r"[-*] |\d+\. |SPDX", text)
        if words and (begins or column != line.find(MARK.search(line)[0])):
            yield number, " ".join(words)
            words = []
        if text and text.strip() and not text.startswith("SPDX"):
            if not words:
                number = index
                column = line.rfind("//") if behind else line.find(MARK.search(line)[0])
            words.append(text)
            if "/*" in line:
                column += 1
    if words:
        yield number, " ".join(words)


def paragraphs_of_page(lines):
    """(line number, text) of each paragraph, list item and table cell."""
    number, words, fenced = 0, [], False
    for index, line in enumerate(lines + [""], 1):
        stripped = line.strip()
        table = stripped.startswith("|")
        begins = re.match(r"([-*] |\d+\. |#|>|!\[|<!--|\$\$)", stripped)
        if stripped.startswith("```") or not stripped or table or begins or fenced:
            if words:
                yield number, " ".join(words)
            words = []
        if stripped.startswith("```"):
            fenced = not fenced
        elif table and not fenced:
            for cell in stripped.strip("|").split("|"):
                yield index, cell.strip()
        elif stripped and not fenced and not line.startswith("    ") or (stripped and words):
            if fenced:
                continue
            if not words:
                number = index
            words.append(re.sub(r"^([-*>]|\d+\.|#+) ", "", stripped))


def plain(text):
    """The text as it is counted: code, links and formulas are a word each."""
    text = re.sub(r"<!--.*?-->", "", text)
    text = re.sub(r"`[^`]*`", "code", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"\$[^$]*\$", "formula", text)
    text = ABBREVIATIONS.sub(r"\1", text)
    return re.sub(r"https?://\S+", "link", text)


def sentences(text):
    return re.split(r"(?<=[.!?])[\"')*_]*\s+(?=\S)", plain(text))


def words_in(sentence):
    """Words have a letter or a digit; an operator joins its two sides to one formula."""
    joined = re.sub(r"\s*(?:[-+*/·×=<>≤≥±∈∪∩→←⊂]|<=|>=|==|\|\|)\s+", "_", sentence)
    return [word for word in joined.split() if re.search(r"\w", word)]


def long_ones(path):
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    paragraphs = paragraphs_of_page(lines) if path.suffix == ".md" else paragraphs_of_code(lines)
    for number, text in paragraphs:
        for sentence in sentences(text):
            items = sentence.split("; ") if sentence.startswith(("Errors", "code: errors")) else [sentence]
            count = max(len(words_in(item)) for item in items)
            if count > LIMIT:
                yield number, count, sentence.strip()


def tracked():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    return [ROOT / name for name in listed if pathlib.Path(name).suffix in CODE | {".md"} and not name.startswith("third_party")]


def folder_of(path):
    """What shares a budget: a module's public headers, its sources, the guides, the notes, any other top folder."""
    parts = path.relative_to(ROOT).parts
    if parts[0] == "engine" and len(parts) > 2:
        return "/".join(parts[:3] if parts[2] == "include" else parts[:2])
    if parts[0] == "docs":
        return "docs/notes" if parts[1] == "notes" else "docs"
    return parts[0]


def counts():
    found = {}
    for path in tracked():
        folder = folder_of(path)
        found[folder] = found.get(folder, 0) + sum(1 for _ in long_ones(path))
    return found


def check(write):
    budgets = {}
    if BUDGETS.exists():
        budgets = {name: int(count) for name, count in (line.split() for line in BUDGETS.read_text().splitlines())}
    found = counts()
    worse = [f"{name}: {count}, allowed {budgets.get(name, 0)}" for name, count in found.items() if count > budgets.get(name, 0)
             and budgets]
    print("\n".join(worse) or "no folder has more long sentences than it may")
    if write and not worse:
        BUDGETS.write_text("".join(f"{name} {count}\n" for name, count in sorted(found.items()) if count))
    return 1 if worse else 0


def main():
    if sys.argv[1:] in (["--check"], ["--write"]):
        sys.exit(check(sys.argv[1] == "--write"))
    total = 0
    for path in [pathlib.Path(name).resolve() for name in sys.argv[1:]] or tracked():
        for number, count, sentence in long_ones(path):
            total += 1
            print(f"{path.relative_to(ROOT) if path.is_relative_to(ROOT) else path}:{number}: {count}: {sentence}")
    print(total, file=sys.stderr)


if __name__ == "__main__":
    main()
