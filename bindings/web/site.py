#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds the documentation site into one folder: the live page in front, guides and reference with search behind it.

bindings/web/site.py [--out DIR] [--page-only]

Needs the package's build (bindings/web/test.sh or bindings/web/build.py), and doxygen for all but the page. The folder can be served, or
its index.html opened as a file: modules are put into the page by an import map, the compiled library into scripts.
"""
import argparse
import base64
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WEB = ROOT / "bindings/web"
PAGE = ["town", "culling", "camera", "draw", "map", "main"]


def module_url(text):
    """A module as a data: URL; what it imports by relative paths it then imports by names of the import map."""
    text = re.sub(r"(['`])(?:\./|\.\./)((?:wasm/)?[\w${}]+\.js)\1", r"\1crofton/\2\1", text)
    return "data:text/javascript;base64," + base64.b64encode(text.encode()).decode()


def write_page(out):
    modules = {f"crofton/{p.name}": p.read_text() for p in sorted((WEB / "js").glob("*.js")) if not p.name.startswith("inline")}
    modules |= {f"crofton/{name}.js": (WEB / f"page/{name}.js").read_text() for name in PAGE}
    modules["crofton/wasm/simd.js"] = (WEB / "wasm/simd.js").read_text()
    urls = {name: module_url(text) for name, text in modules.items()}
    urls["crofton"] = urls["crofton/crofton.js"]
    scripts = (f'<script type="importmap">{json.dumps({"imports": urls})}</script>\n'
               '<script type="module">import "crofton/main.js";</script>')
    (out / "index.html").write_text((WEB / "page/index.html").read_text().replace("<!-- modules -->", scripts))
    data = base64.b64encode((WEB / "wasm/simd.wasm").read_bytes()).decode()
    (out / "simd.wasm.js").write_text(f'globalThis.croftonBytes = "{data}";\n')


def run_doxygen(settings, log):
    with log.open("w") as file:
        done = subprocess.run(["doxygen", "-"], input=settings, text=True, stdout=file, stderr=subprocess.STDOUT, cwd=ROOT)
    if done.returncode:
        sys.exit(f"site: doxygen failed, see {log}")


def write_reference(out, work):
    version = re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    text = (ROOT / "cmake/Doxyfile.in").read_text()
    for name, value in {"PROJECT_VERSION": version, "PROJECT_DESCRIPTION": "Exact culling, collision and bounds",
                        "PROJECT_BINARY_DIR": str(out), "PROJECT_SOURCE_DIR": str(ROOT),
                        "CROFTON_REFERENCE_DIRS": " ".join(str(p) for p in sorted(ROOT.glob("engine/**/include")))}.items():
        text = text.replace(f"@{name}@", value)
    run_doxygen(text + "\nSEARCHENGINE = YES\nSERVER_BASED_SEARCH = NO\n", work / "reference.txt")


def write_guides(out, work):
    settings = {"PROJECT_NAME": '"Crofton: guides"', "OUTPUT_DIRECTORY": out, "HTML_OUTPUT": "guides", "GENERATE_LATEX": "NO",
                "QUIET": "YES", "INPUT": f"{ROOT}/docs {ROOT}/bindings/web/README.md", "FILE_PATTERNS": "*.md", "RECURSIVE": "YES",
                "USE_MDFILE_AS_MAINPAGE": f"{ROOT}/docs/README.md", "IMAGE_PATH": f"{ROOT}/docs/pictures {ROOT}/docs",
                "STRIP_FROM_PATH": ROOT, "SEARCHENGINE": "YES", "SERVER_BASED_SEARCH": "NO", "HAVE_DOT": "NO",
                "GENERATE_TREEVIEW": "YES", "TOC_INCLUDE_HEADINGS": 3, "AUTOLINK_SUPPORT": "NO", "USE_MATHJAX": "NO",
                "WARN_IF_DOC_ERROR": "NO"}
    run_doxygen("\n".join(f"{name} = {value}" for name, value in settings.items()), work / "guides.txt")
    shutil.copytree(ROOT / "docs/pictures", out / "guides/pictures", dirs_exist_ok=True)
    mend_links(out / "guides")


def mend_links(guides):
    """Links to pages that doxygen left as they are, as those with an anchor, and pictures named from below docs/notes."""
    pages = {re.sub(r"^md_docs_|_", "", p.stem): p.name for p in guides.glob("md_docs_*.html")}

    def page_of(match):
        up, name = match.group(1).startswith("../"), re.sub(r"_|/|\.\./", "", match.group(1))
        beside = "notes" + name if below and not up else name
        found = pages.get(beside) or pages.get(name)
        return f'href="{found}{match.group(2) or ""}"' if found else match.group(0)

    for page in guides.glob("*.html"):
        text, below = page.read_text(), page.name.startswith("md_docs_notes")
        mended = re.sub(r'href="([\w/.]+)\.md(#[^"]*)?"', page_of, re.sub(r'src="\.\./(docs/)?pictures/', 'src="pictures/', text))
        mended = mended.replace('href="../pictures/', 'href="pictures/').replace('data="../pictures/', 'data="pictures/')
        if mended != text:
            page.write_text(mended)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "build/site")
    parser.add_argument("--page-only", action="store_true")
    options = parser.parse_args()
    if not (WEB / "wasm/simd.wasm").exists():
        sys.exit("site: the package is not built: bindings/web/build.py")
    options.out.mkdir(parents=True, exist_ok=True)
    write_page(options.out)
    if not options.page_only:
        if not shutil.which("doxygen"):
            sys.exit("site: doxygen is not here; third_party/install.sh --web installs it")
        work = ROOT / "build/web"
        work.mkdir(parents=True, exist_ok=True)
        write_reference(options.out.resolve(), work)
        write_guides(options.out.resolve(), work)
    print(f"site: {options.out}/index.html")


if __name__ == "__main__":
    main()
