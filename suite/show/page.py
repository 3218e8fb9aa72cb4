"""A page in one file: it needs no network, and nothing that stands in its data can become code."""

from __future__ import annotations

import html
import json
from importlib.resources import files
from typing import Any

_PAGE = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; \
style-src 'unsafe-inline'; img-src data:">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<noscript>This page is drawn by JavaScript, which is switched off.</noscript>
<script type="application/json" id="data">{data}</script>
<!-- {licence} -->
<script>{script}</script>
</body>
</html>
"""


def page(title: str, data: dict[str, Any]) -> str:
    """The text of a page that shows ``data``, whose ``kind`` says how."""
    web = files("suite.show") / "web"
    texts = {name: (web / name).read_text(encoding="utf-8") for name in ("suite.js", "suite.css", "THREE-LICENSE")}
    return _PAGE.format(
        title=html.escape(title),
        style=texts["suite.css"],
        data=as_json(data),
        licence=texts["THREE-LICENSE"].strip(),
        script=texts["suite.js"],
    )


def as_json(data: Any) -> str:
    """JSON that may stand inside an element: no text in it can end the element or begin a comment."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
