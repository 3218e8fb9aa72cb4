"""Pages point at what is there, and name commands that there are."""

import re
import shlex
import tomllib
from pathlib import Path

import pytest
import typer.main
import yaml
from typer.exceptions import TyperException

from suite.cli.main import app

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]
COMMAND = typer.main.get_command(app)


def name_of(page: Path) -> str:
    return str(page.relative_to(ROOT))


def without_code(text: str) -> str:
    return re.sub(r"`[^`\n]*`", "``", re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL))


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings that are the same on GitHub and on the site."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    titles = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    slugs = [re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles]
    return {slug for slug in slugs if "--" not in slug and slugs.count(slug) == 1}


def broken_links(page: Path) -> list[str]:
    links = re.findall(r"\]\(([^)\s]+)\)", without_code(page.read_text(encoding="utf-8")))
    broken = []
    for link in links:
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if re.match(r"https?://", link):
            continue
        if not target.exists() or not target.is_relative_to(ROOT) or (anchor and anchor not in anchors(target)):
            broken.append(link)
    return broken


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_relative_links_and_anchors_lead_somewhere(page: Path) -> None:
    assert broken_links(page) == []


def test_broken_links_are_seen(monkeypatch) -> None:
    page = ROOT / "docs" / "start.md"
    links = (
        "[a](table.md) [b](no.md) [c](table.md#what-is-one-row) [d](table.md#what-is-no-row) [e](#what-next) `[f](no)`"
    )
    text = page.read_text(encoding="utf-8") + links
    read = Path.read_text
    monkeypatch.setattr(Path, "read_text", lambda path, **how: text if path == page else read(path, **how))
    assert broken_links(page) == ["no.md", "table.md#what-is-no-row"]


def commands(text: str) -> list[str]:
    """Lines that call ``suite``, of blocks that are fenced as ``sh`` or indented."""
    fenced = "".join(re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL))
    prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    indented = "\n".join(re.findall(r"^    (\S.*)$", prose, re.MULTILINE))
    return re.findall(r"^ *((?:timeout .*? )?suite .*)$", f"{fenced}\n{indented}".replace("\\\n", " "), re.MULTILINE)


def parse(line: str) -> None:
    """What the command line does with ``line`` before it runs anything; raises what it would refuse."""
    words = shlex.split(re.split(r" (?:\|\||\||&&|>) ", line)[0], comments=True)
    words = words[words.index("suite") + 1 :]
    command = COMMAND
    while hasattr(command, "commands"):
        assert words, line
        assert words[0] in command.commands, line
        command = command.commands[words.pop(0)]
    command.make_context("suite", words)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_are_known_with_their_options(page: Path) -> None:
    for line in commands(page.read_text(encoding="utf-8")):
        try:
            parse(line)
        except TyperException as error:
            pytest.fail(f"{line}: {error.format_message()}")


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_named_in_a_sentence_are_known_with_their_options(page: Path) -> None:
    prose = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for span in re.findall(r"`suite ([a-z][^`]*)`", prose):
        words = re.split(r"[\s\[\]]+", span)
        command = COMMAND.commands[words[0]]
        known = {option for parameter in command.params for option in (*parameter.opts, *parameter.secondary_opts)}
        assert {word for word in words if word.startswith("-")} <= known | {"-h", "--help"}, span


@pytest.mark.parametrize(
    "line", ["suite run --planers pf", "suite export results/mine nowhere x", "suite table", "suite run --trials few"]
)
def test_a_command_that_there_is_not_is_seen(line: str) -> None:
    with pytest.raises(TyperException):
        parse(line)


def test_pages_have_commands_to_parse() -> None:
    found = {page.name: len(commands(page.read_text(encoding="utf-8"))) for page in PAGES}
    assert found["README.md"] >= 3
    assert found["commands.md"] >= 15
    assert found["temporal-ct.md"] >= 4
    assert found["sweep.md"] >= 8


def test_every_page_is_in_the_sites_navigation_and_in_the_list_of_all_pages() -> None:
    def pages(entry: object) -> list[str]:
        if isinstance(entry, str):
            return [entry]
        return [page for value in (entry.values() if isinstance(entry, dict) else entry) for page in pages(value)]

    site = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    assert sorted(pages(site["nav"])) == sorted(map(name_of, PAGES))
    index = ROOT / "docs" / "index.md"
    listed = re.findall(r"\]\(([^)]+)\)", index.read_text(encoding="utf-8"))
    assert sorted(name_of((index.parent / page).resolve()) for page in listed) == sorted(
        name_of(page) for page in PAGES if page not in (index, ROOT / "README.md")
    )


def test_numbers_of_the_guide_come_from_commands() -> None:
    for page in PAGES:
        if "notes" not in page.parts:
            assert "script of ours" not in page.read_text(encoding="utf-8"), page


def test_the_version_is_the_same_everywhere() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert cited["version"] == version
    assert f"## [{version}] - {cited['date-released']}\n" in changes
