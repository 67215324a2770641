"""Parts of pages that are written by the program itself: keys of files, commands, the notebook.

A page says where they go by a comment on a line of its own: `<!-- keys: scene -->`, `<!-- commands -->`,
`<!-- notebook: docs/examples/notebook.ipynb -->`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from commands import commands
from result_keys import result_keys
from schema_keys import schema_keys

ROOT = Path(__file__).parents[2]
_MARK = re.compile(r"^<!-- (\w+)(?:: ([\w./]+))? -->$", re.MULTILINE)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Return the text of a page with the generated parts in place of their marks."""
    return _MARK.sub(lambda found: GENERATED[found[1]](found[2] or ""), markdown)


def _keys(kind: str) -> str:
    return result_keys() if kind == "result" else schema_keys(kind)


def _notebook(file: str) -> str:
    cells = json.loads((ROOT / file).read_text(encoding="utf-8"))["cells"]
    texts = [("".join(cell["source"]), cell["cell_type"]) for cell in cells]
    return "\n\n".join(text if kind == "markdown" else f"```python\n{text}\n```" for text, kind in texts)


GENERATED: dict[str, Callable[[str], str]] = {"keys": _keys, "commands": lambda _: commands(), "notebook": _notebook}
