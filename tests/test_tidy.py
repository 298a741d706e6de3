"""Habits of the repository: first lines, paths in documents, generated files, stubs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from springform.canonical_text import json_text
from springform.design_file import json_schema

ROOT = Path(__file__).parent.parent
COMMENTS = {
    ".rs": ("//! ", "// "),
    ".py": ('"""',),
    ".pyi": ('"""',),
    ".css": ("/* ",),
    ".ts": ("// ",),
    ".tsx": ("// ",),
}
HASHED = {".toml", ".sh", ".lock", ".cfg"}
WRITTEN_BY_TOOLS = {"Cargo.lock"}


def _tracked() -> list[Path]:
    """Every file that belongs to the project, committed or not."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    try:
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git work tree")
    paths = [ROOT / name for name in listed.stdout.split("\0") if name]
    return [path for path in paths if path.is_file()]


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return ""


def _says_what_it_is(path: Path) -> bool:
    if path.name in WRITTEN_BY_TOOLS:
        return True
    # Crates and packaged scenes say so under a key of their own; saving a scene keeps no comment.
    if path.suffix == ".toml" and re.search(r'^description = "\S', _text(path), re.MULTILINE):
        return True
    starts = COMMENTS.get(path.suffix, ())
    if path.suffix in HASHED or path.name in ("Makefile", ".importlinter"):
        starts = ("# ",)
    lines = _text(path).splitlines() or [""]
    first = lines[1] if lines[0].startswith("#!") and len(lines) > 1 else lines[0]
    if lines[0].startswith("#!"):
        starts = ("# ",)
    return not starts or any(
        first.startswith(start) and len(first) > len(start) + 8 for start in starts
    )


def test_first_lines_say_what_a_file_is() -> None:
    silent = [str(path.relative_to(ROOT)) for path in _tracked() if not _says_what_it_is(path)]
    assert silent == [], "the first line of these files should say what they are"


def _named_paths(document: str, *, every: bool) -> list[str]:
    """Paths in backticks: all that look like one, or those in folders of the repository."""
    tops = {path.name for path in ROOT.iterdir() if path.is_dir()} - {"runs"}
    found = []
    for words in re.findall(r"`([^`\n]+)`", _text(ROOT / document)):
        path = words.strip()
        looks = re.fullmatch(r"[\w.-]+(/[\w.*-]*)+|[\w.-]+\.(rs|py|pyi|toml|md|lock|json)", path)
        if looks and "*" not in path and (every or (path.split("/")[0] in tops and "/" in path)):
            found.append(path)
    return found


def test_paths_in_the_map_exist() -> None:
    paths = _named_paths("ARCHITECTURE.md", every=True)
    assert len(paths) > 20
    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_paths_in_other_documents_exist() -> None:
    documents = [path for path in _tracked() if path.suffix == ".md"]
    for document in documents:
        paths = _named_paths(str(document.relative_to(ROOT)), every=False)
        assert [path for path in paths if not (ROOT / path).exists()] == [], document


def test_links_in_documents_lead_somewhere() -> None:
    for document in (path for path in _tracked() if path.suffix == ".md"):
        links = re.findall(r"\]\(([^)#:\s]+)(?:#[^)\s]*)?\)", _text(document))
        broken = [link for link in links if not (document.parent / link).exists()]
        assert broken == [], document


def test_every_module_is_on_the_map() -> None:
    words = " ".join(re.findall(r"`([^`\n]+)`", _text(ROOT / "ARCHITECTURE.md")))
    package = ROOT / "python" / "springform"
    modules = [path.stem for path in package.glob("*.py") if path.stem != "__init__"]
    modules += [path.parent.name for path in package.glob("*/__init__.py")]
    for crate in (ROOT / "crates").iterdir():
        modules += [path.stem for path in (crate / "src").glob("*.rs") if path.stem != "lib"]
        modules += [path.name for path in (crate / "src").iterdir() if path.is_dir()]
    missing = {name for name in modules if not re.search(rf"\b{name}\b", words)}
    assert missing == set(), "ARCHITECTURE.md should name these modules"


def test_decisions_are_numbered_without_gaps() -> None:
    names = sorted(path.name for path in (ROOT / "docs" / "decisions").glob("*.md"))
    assert [int(name[:4]) for name in names] == list(range(1, len(names) + 1))


def test_published_schema_is_current() -> None:
    published = _text(ROOT / "docs" / "formats" / "design.schema.json")
    assert published == json_text(json_schema()), "renew it with `make schema`"


def test_changelog_has_one_line_a_change() -> None:
    for line in _text(ROOT / "CHANGELOG.md").splitlines():
        assert line == "" or re.match(r"#{1,2} \S|- \S", line), line


def test_stub_matches_the_compiled_module() -> None:
    command = [sys.executable, "-m", "mypy.stubtest", "springform._core", "--concise"]
    checked = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_nothing_names_the_machine_it_was_made_on() -> None:
    # Put together from parts, so that this file passes its own test.
    registries = ("pypi" + r"\.org", "pythonhosted" + r"\.", "crates" + r"\.io", "npmjs" + r"\.")
    places = ("/work" + "/", "/root" + "/", r"\.\./" + "shared")
    forbidden = re.compile("|".join(registries + places))
    for path in _tracked():
        # Cargo writes into its lock file that a package comes from the default registry.
        text = _text(path).replace("registry+https://github.com/rust-lang/crates" + ".io-index", "")
        found = forbidden.search(text)
        assert found is None, f"{path.relative_to(ROOT)} names {found and found[0]}"
