"""The one reader: what is no file, what is too much, what nobody can print."""

import os
from pathlib import Path

import pytest

from scenarios import FileError, UserError, load_scenarios
from scenarios.errors import LONGEST_MESSAGE
from scenarios.reading import MAX_DEPTH, read_json, read_text


@pytest.mark.parametrize("target", ["/dev/zero", "/dev/urandom", "/dev/stdin", "/proc/self"])
def test_what_a_link_leads_to_counts(tmp_path: Path, target: str) -> None:
    (tmp_path / "in.json").symlink_to(target)
    with pytest.raises(FileError, match=r"found a (device|folder|pipe)"):
        read_text(tmp_path / "in.json", 1000)


def test_nobody_waits_for_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "in.yaml")
    with pytest.raises(FileError, match="found a pipe, allowed a file"):
        load_scenarios(tmp_path / "in.yaml")


@pytest.mark.parametrize(("size", "is_read"), [(10, True), (11, False)])
def test_a_file_has_a_largest_size(tmp_path: Path, size: int, is_read: bool) -> None:
    (tmp_path / "in.txt").write_bytes(b"x" * size)
    if is_read:
        assert len(read_text(tmp_path / "in.txt", 10)) == 10
    else:
        with pytest.raises(FileError, match="found 11 bytes, allowed 10"):
            read_text(tmp_path / "in.txt", 10)


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (b"\xff", "not UTF-8"),
        (b"a\0b", "found a NUL"),
        (b'{"a": 1, "a": 2}', "the key 'a' twice"),
        (b"{", "not valid JSON"),
        (b'{"a\\ud800": 1}', "surrogates not allowed"),
    ],
)
def test_broken_text_is_one_line(tmp_path: Path, data: bytes, line: str) -> None:
    (tmp_path / "in.json").write_bytes(data)
    with pytest.raises(FileError, match=line):
        read_json(tmp_path / "in.json", 1000)


@pytest.mark.parametrize(("depth", "is_read"), [(MAX_DEPTH, True), (MAX_DEPTH + 1, False), (100_000, False)])
def test_values_are_nested_so_deep_and_no_deeper(tmp_path: Path, depth: int, is_read: bool) -> None:
    (tmp_path / "in.json").write_text("[" * depth + "]" * depth)
    if is_read:
        read_json(tmp_path / "in.json", 10**6)
    else:
        with pytest.raises(FileError, match="not valid JSON"):
            read_json(tmp_path / "in.json", 10**6)


@pytest.mark.parametrize("name", ["a\0b.json", "\ud800.json", "x" * 5000 + ".json"])
def test_names_that_no_file_can_have(name: str) -> None:
    with pytest.raises(FileError, match="cannot be read") as caught:
        read_json(Path(name), 1000)
    assert str(caught.value).isprintable()


def test_a_message_is_short_and_moves_no_cursor() -> None:
    text = str(UserError("begin \x1b[2J\n" + "x" * 10_000 + " \udc80 end"))
    assert text.startswith(r"begin \x1b[2J\n")
    assert text.endswith(r"\udc80 end")
    assert len(text) <= LONGEST_MESSAGE
