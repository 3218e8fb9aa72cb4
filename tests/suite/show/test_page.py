import hashlib
import json
import re
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from suite.show.page import as_json, page

ROOT = Path(__file__).resolve().parents[3]
EVIL = '</script><script>alert(1)</script><!-- & "\u2028'


@given(st.dictionaries(st.text(max_size=9), st.text(max_size=20) | st.integers(), max_size=4))
def test_json_in_a_page_says_the_same_and_holds_no_markup(data: dict) -> None:
    text = as_json(data)
    assert json.loads(text) == data
    assert not set("<>&") & set(text)


def test_a_page_has_two_scripts_whatever_its_names_are() -> None:
    text = page(EVIL, {"kind": "replay", "run": EVIL})
    assert len(re.findall(r"<script", text)) == len(re.findall(r"</script>", text)) == 2
    assert "<title>&lt;/script&gt;" in text


def test_a_page_needs_no_network() -> None:
    text = page("a", {})
    assert "default-src 'none'" in text
    assert not re.findall(r"(?:src|href)=[\"']?(?!data:)\w+:", text)
    assert "Permission is hereby granted" in text  # the licence of three.js goes with it


def test_the_committed_script_is_made_of_the_sources_that_are_there() -> None:
    web = ROOT / "web"
    names = sorted([*(file.name for file in web.glob("*.js")), "package-lock.json"])
    digest = hashlib.sha256(b"".join((web / name).read_bytes() for name in names)).hexdigest()[:16]
    script = (ROOT / "suite" / "show" / "web" / "suite.js").read_text(encoding="utf-8")
    assert script.startswith(f"/* of the sources {digest} */"), "make bundle"


def test_the_lock_file_names_no_registry() -> None:
    assert "://" not in (ROOT / "web" / "package-lock.json").read_text(encoding="utf-8")
