"""Gather in build/pages what the site is made of: README.md, docs/, and each file of the repository that they point to.

There everything has the place that it has in the repository, so that a link is right in both. ``make docs`` runs this
and then zensical, which reads mkdocs.yml.
"""

import re
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "build" / "pages"
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")


def gather(page: Path, taken: set[Path]) -> None:
    """Add ``page`` to ``taken`` and, if it is text with links, whatever it points to."""
    if page in taken or not page.is_file() or not page.is_relative_to(ROOT):
        return
    taken.add(page)
    if page.suffix == ".md":
        for target in LINK.findall(page.read_text(encoding="utf-8")):
            gather((page.parent / target).resolve(), taken)


if __name__ == "__main__":
    taken: set[Path] = set()
    for page in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md")):
        gather(page, taken)
    shutil.rmtree(PAGES, ignore_errors=True)
    for file in sorted(taken):
        place = PAGES / file.relative_to(ROOT)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, place)
