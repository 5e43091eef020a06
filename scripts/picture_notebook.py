"""Picture the first notebook of the tutorial: its first cells with what they return.

    PYTHONPATH=. python scripts/picture_notebook.py FILE

Called by scripts/docs-images; needs what the tests of the page need.
"""

from __future__ import annotations

import html
import sys
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

from tests.support.browser import chromium

NOTEBOOK = Path(__file__).resolve().parents[1] / "examples" / "tutorial" / "1_first_frame.ipynb"

CELLS = slice(3, 6)
"""A frame, and its arrays."""

STYLE = """
body { margin: 0; padding: 16px 20px; width: 1080px; font: 15px/1.5 system-ui, sans-serif;
       color: #1d1d20; background: white; }
.cell { display: grid; grid-template-columns: 58px 1fr; margin: 8px 0; }
.count { font: 12px/1.6 monospace; color: #3a5fb0; padding-top: 7px; }
pre { margin: 0; font: 13px/1.5 "DejaVu Sans Mono", monospace; white-space: pre-wrap; }
.code { background: #f5f5f7; border: 1px solid #d9d9de; border-radius: 3px; padding: 6px 10px; }
.output { grid-column: 2; padding: 8px 10px 2px; overflow: hidden; }
.words { grid-column: 2; }
"""


def main(path: Path) -> None:
    """Write the picture."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=300).execute()
    body = "".join(_cell(cell) for cell in notebook.cells[CELLS])
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 1120, "height": 400})
        page.set_content(f"<style>{STYLE}</style>{body}")
        page.wait_for_timeout(300)
        page.locator("body").screenshot(path=path, type="jpeg", quality=90)
    print(path)


def _cell(cell: Any) -> str:
    if cell.cell_type == "markdown":
        words = html.escape(cell.source).replace("`", "")
        return f'<div class="cell"><div class="words">{words}</div></div>'
    outputs = "".join(f'<div class="output">{_output(output)}</div>' for output in cell.outputs)
    return (
        f'<div class="cell"><div class="count">[{cell.execution_count}]:</div>'
        f'<div class="code"><pre>{html.escape(cell.source)}</pre></div>{outputs}</div>'
    )


def _output(output: Any) -> str:
    if output.output_type == "stream":
        return f"<pre>{html.escape(output.text)}</pre>"
    data = output.get("data", {})
    if "text/html" in data:
        return str(data["text/html"])
    return f"<pre>{html.escape(str(data.get('text/plain', '')))}</pre>"


if __name__ == "__main__":
    main(Path(sys.argv[1]))
