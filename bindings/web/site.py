#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds the site into one folder: the README in front, guides with search, the live page, references of C++, C and Python.

bindings/web/site.py [--out DIR] [--page-only]     --page-only: the live page alone

Needs the package's build (bindings/web/test.sh or bindings/web/build.py), and for all but the page mkdocs with its theme
Material, and doxygen. The folder can be served, or its index.html opened as a file: modules are put into the live page by an
import map, the compiled library into scripts. Ends with an error where a link leads nowhere.
"""
import argparse
import ast
import base64
import json
import re
import shutil
import subprocess
import sys
import zlib
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
WEB = ROOT / "bindings/web"
STYLE = Path("/usr/share/doxygen-awesome-css/doxygen-awesome.css")
PAGE = ["town", "culling", "camera", "draw", "map", "main"]
# The tabs of the start page: language, and the README that begins with a program in it.
LANGUAGES = [("C++", "README.md", "cpp"), ("Python", "bindings/python/README.md", "python"), ("JavaScript", "bindings/web/README.md", "js"),
             ("Rust", "bindings/rust/README.md", "rust"), ("C#", "bindings/csharp/README.md", "csharp")]


def module_url(text):
    """A module as a data: URL; what it imports by relative paths it then imports by names of the import map."""
    text = re.sub(r"(['`])(?:\./|\.\./)((?:wasm/)?[\w${}]+\.js)\1", r"\1crofton/\2\1", text)
    return "data:text/javascript;base64," + base64.b64encode(text.encode()).decode()


def write_page(out):
    out.mkdir(parents=True, exist_ok=True)
    modules = {f"crofton/{p.name}": p.read_text() for p in sorted((WEB / "js").glob("*.js")) if not p.name.startswith("inline")}
    modules |= {f"crofton/{name}.js": (WEB / f"page/{name}.js").read_text() for name in PAGE}
    modules["crofton/wasm/simd.js"] = (WEB / "wasm/simd.js").read_text()
    urls = {name: module_url(text) for name, text in modules.items()}
    urls["crofton"] = urls["crofton/crofton.js"]
    scripts = (f'<script type="importmap">{json.dumps({"imports": urls})}</script>\n'
               '<script type="module">import "crofton/main.js";</script>')
    (out / "index.html").write_text((WEB / "page/index.html").read_text().replace("<!-- modules -->", scripts))
    packed = {"simd.wasm": zlib.compress((WEB / "wasm/simd.wasm").read_bytes(), 9), "town": (WEB / "page/town.bin").read_bytes()}
    for name, data in packed.items():
        (out / f"{name}.js").write_text(f'(globalThis.croftonBytes ??= {{}})["{name}"] = "{base64.b64encode(data).decode()}";\n')


def run_doxygen(settings, log):
    with log.open("w") as file:
        done = subprocess.run(["doxygen", "-"], input=settings, text=True, stdout=file, stderr=subprocess.STDOUT, cwd=ROOT)
    if done.returncode:
        sys.exit(f"site: doxygen failed, see {log}")


def write_reference(out, work):
    version = re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    text = (ROOT / "cmake/Doxyfile.in").read_text()
    for name, value in {"PROJECT_VERSION": version, "PROJECT_DESCRIPTION": "Exact culling and collision detection",
                        "PROJECT_BINARY_DIR": str(out), "PROJECT_SOURCE_DIR": str(ROOT),
                        "CROFTON_REFERENCE_DIRS": " ".join(str(p) for p in sorted(ROOT.glob("engine/**/include")))}.items():
        text = text.replace(f"@{name}@", value)
    style = f"HTML_EXTRA_STYLESHEET = {STYLE}\nGENERATE_TREEVIEW = YES\n" if STYLE.exists() else ""  # a dark scheme, and phones
    run_doxygen(text + "\nSEARCHENGINE = YES\nSERVER_BASED_SEARCH = NO\n" + style, work / "reference.txt")
    menu = out / "reference/menudata.js"  # leads back to the guides
    menu.write_text(menu.read_text().replace("children:[", 'children:[\n{text:"Guides",url:"../index.html"},', 1))


def git_files(*patterns):
    done = subprocess.run(["git", "ls-files", "-z", "--", *patterns], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout.split("\0")[:-1]


def program_of(readme, language):
    """The first program of a README in a language, with its fence."""
    return re.search(rf"^```{language}\n.*?^```\n", (ROOT / readme).read_text(), re.M | re.S)[0]


def start_page(text):
    """The README, with the live page behind its first picture and the first programs of all languages."""
    buttons = "[Fly through a town in your browser](live/index.html){ .md-button .md-button--primary } [Install](docs/install.md){ .md-button }"
    text = re.sub(r"^(!\[.*\]\(.*\))$", lambda found: f"{buttons}\n\n[{found[1]}](live/index.html)", text, count=1, flags=re.M)
    tabs = "".join(f'=== "{name}"\n\n' + "".join(f"    {line}" for line in program_of(readme, language).splitlines(keepends=True)) + "\n"
                   for name, readme, language in LANGUAGES)
    return "---\nhide: [navigation]\n---\n\n" + text.replace(program_of("README.md", "cpp"), tabs)


def python_reference():
    """What the package's stub declares, a heading for each class."""
    text = (ROOT / "bindings/python/crofton/__init__.pyi").read_text()
    classes = [node for node in ast.parse(text).body if isinstance(node, ast.ClassDef)]
    functions = "\n".join(ast.get_source_segment(text, node) for node in ast.parse(text).body if isinstance(node, ast.FunctionDef))
    parts = [("Functions", functions)] + [(node.name, ast.get_source_segment(text, node)) for node in sorted(classes, key=lambda n: n.name)]
    return ("# Python: what the package declares\n\n`help(crofton.World)` and its kin explain each call. "
            "[The guide](bindings/python/README.md) begins with programs.\n\n"
            + "".join(f"## {name}\n\n```python\n{code}\n```\n\n" for name, code in parts))


def write_pages(pages):
    """Gathers the repository's pages and what they link to: mkdocs sees the same tree, and follows the same links."""
    shutil.rmtree(pages, ignore_errors=True)
    for name in git_files("*.md", "docs/pictures", ":!.github"):
        (pages / name).parent.mkdir(parents=True, exist_ok=True)
        if not name.endswith(".md"):
            shutil.copy(ROOT / name, pages / name)
            continue
        text = (ROOT / name).read_text()
        for target in re.findall(r"\]\(([\w./-]+)\)", text):
            file = (ROOT / name).parent / target
            if file.is_file() and file.suffix != ".md":
                copy = pages / file.resolve().relative_to(ROOT)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, copy)
        # Lists and tables may follow a line of text, as on GitHub; mkdocs wants an empty line between.
        text = re.sub(r"^(?![-|\s]|\d+\. )(.+)\n(?=(?:- |\d+\. |\| ))", r"\1\n\n", text, flags=re.M)
        text = re.sub(r"^(#+ .*\w#)$", r"\1 #", text, flags=re.M)  # mkdocs takes the last # of "## C#" for a closing mark
        (pages / name).write_text(start_page(text) if name == "README.md" else text)
    (pages / "python.md").write_text(python_reference())
    shutil.copy(WEB / "site.css", pages)


class Links(HTMLParser):
    """A page's links, and the places in it that a link may name."""

    def __init__(self, page):
        super().__init__()
        self.links, self.places = [], {""}
        self.feed(page.read_text(errors="replace"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name"):
                self.places.add(value)
            elif name in ("href", "src") and value and not re.match(r"[a-z]+:|//", value):
                self.links.append(value)


def check_links(out):
    """Every link of a page, but for those of the reference to itself, which are Doxygen's."""
    pages = {page: Links(page) for page in out.rglob("*.html") if page.parent != out / "reference"}
    broken = []
    for page, found in pages.items():
        for link in found.links:
            path, _, place = unquote(link).partition("#")
            target = (page.parent / path.partition("?")[0]).resolve() if path else page
            target = target / "index.html" if target.is_dir() else target
            if not target.exists() or (target in pages and place not in pages[target].places):
                broken.append(f"{page.relative_to(out)}: {link}")
    if broken:
        sys.exit("site: links lead nowhere:\n  " + "\n  ".join(sorted(set(broken))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "build/site")
    parser.add_argument("--page-only", action="store_true")
    options = parser.parse_args()
    if not (WEB / "wasm/simd.wasm").exists():
        sys.exit("site: the package is not built: bindings/web/build.py")
    if options.page_only:
        write_page(options.out)
    else:
        for tool in ("mkdocs", "doxygen"):
            if not shutil.which(tool):
                sys.exit(f"site: {tool} is not here; third_party/install.sh --web installs it")
        work = ROOT / "build/web"
        write_pages(work / "pages")
        write_page(work / "pages/live")
        write_reference(work / "pages", work)
        subprocess.run(["mkdocs", "build", "--quiet", "--config-file", WEB / "mkdocs.yml", "--site-dir", options.out.resolve()], check=True)
        (options.out / "404.html").unlink()  # its links are those of a site that lies at a server's root
        check_links(options.out.resolve())
    print(f"site: {options.out}/index.html")


if __name__ == "__main__":
    main()
