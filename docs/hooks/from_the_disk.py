"""Nothing from the network: the one script that the theme would fetch is among the pages' own."""

from __future__ import annotations

from typing import Any

from mkdocs.structure.pages import Page
from mkdocs.utils import get_relative_url

_FETCHED = "https://unpkg.com/iframe-worker/shim"
_OWN = "javascripts/iframe-worker.js"


def on_post_page(output: str, page: Page, **_: Any) -> str:
    """Return the HTML of a page with the address of our copy of the script that search needs in pages from the disk."""
    return output.replace(_FETCHED, get_relative_url(_OWN, page.url))


def on_post_template(output_content: str, template_name: str, **_: Any) -> str:
    """Do the same for the page that says that there is no such page."""
    return output_content.replace(_FETCHED, _OWN)
