"""Nothing from the network: the one script that the theme would fetch is one of this project's own."""

from __future__ import annotations

import re
from typing import Any

from mkdocs.structure.pages import Page
from mkdocs.utils import get_relative_url

_FETCHED = re.compile(r'https://[^"]*/iframe-worker/shim')
_OWN = "javascripts/worker_from_disk.js"


def on_post_page(output: str, page: Page, **_: Any) -> str:
    """Return the HTML of a page with the address of the script that search needs in pages from the disk."""
    return _FETCHED.sub(get_relative_url(_OWN, page.url), output)


def on_post_template(output_content: str, template_name: str, **_: Any) -> str:
    """Do the same for the page that says that there is no such page."""
    return _FETCHED.sub(_OWN, output_content)
