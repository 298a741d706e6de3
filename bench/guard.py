"""Compares two commits by counted instructions, which repeat to some parts in ten thousand.

Usage: python bench/guard.py BASE [MOST]. The driver `examples/guard.rs` of the tree as it stands is
built here and at BASE, in a worktree under build/, and both run under callgrind. Each function
`counted_CASE` is a case. Ends with code 1 if a case takes more than MOST times the
instructions (1.02 unless said). callgrind shows programs a processor without AVX-512.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
BUILD = ROOT / "build" / "guard"
CRATE = Path("crates") / "springform-evolution"
DRIVER = (CRATE / "examples" / "guard.rs", CRATE / "benches" / "nets" / "mod.rs")
MOST = 1.02


def main() -> int:
    """Count both, print the comparison and return the exit code."""
    if len(sys.argv) not in (2, 3):
        return _refuse("name a commit to compare with, such as: make guard BASE=main")
    if shutil.which("valgrind") is None:
        return _refuse("callgrind is missing: install valgrind, then try again")
    base = sys.argv[1]
    most = float(sys.argv[2]) if len(sys.argv) == 3 else MOST
    known = _run("git", "rev-parse", "--verify", "--quiet", f"{base}^{{commit}}", check=False)
    if known.returncode != 0:
        return _refuse(f"there is no commit {base}")
    commit = known.stdout.strip()
    now = _counted(ROOT, "now")
    tree = BUILD / "base-tree"
    _remove(tree)
    _run("git", "worktree", "add", "--detach", "--force", str(tree), commit)
    try:
        for path in DRIVER:
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, tree / path)
        before = _counted(tree, "base")
    except subprocess.CalledProcessError as error:
        lines = [line for line in error.stderr.splitlines() if line.startswith("error")]
        return _refuse(
            f"{base} can't build the driver of this tree: {lines[0] if lines else error}"
        )
    finally:
        _remove(tree)
    return _compare(before, now, base, most)


def _counted(tree: Path, name: str) -> dict[str, int]:
    """Instructions of every case of the driver, built in a tree."""
    build = ["cargo", "build", "--quiet", "--release", "-p", "springform-evolution"]
    command = [*build, "--example", "guard"]
    environment = dict(os.environ) | {"CARGO_TARGET_DIR": str(BUILD / "target")}
    subprocess.run(
        command, cwd=tree, env=environment, check=True, text=True, stderr=subprocess.PIPE
    )
    program = BUILD / f"guard-{name}"
    shutil.copy(BUILD / "target" / "release" / "examples" / "guard", program)
    out = BUILD / f"{name}.callgrind"
    _run("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", str(program))
    listed = _run("callgrind_annotate", "--inclusive=yes", "--threshold=100", str(out)).stdout
    found = re.findall(r"^\s*([\d,]+) \(.*?guard::counted_(\w+)", listed, re.MULTILINE)
    return {case: int(count.replace(",", "")) for count, case in found}


def _compare(before: dict[str, int], now: dict[str, int], base: str, most: float) -> int:
    print(f"{'instructions':<24} {base[:16]:>16} {'now':>16} {'ratio':>8}")
    worse = []
    for case, count in now.items():
        if case not in before:
            continue
        ratio = count / before[case]
        mark = "  more" if ratio > most else ""
        print(f"{case.replace('_', ' '):<24} {before[case]:>16,} {count:>16,} {ratio:>8.4f}{mark}")
        if mark:
            worse.append(case)
    if not set(before) & set(now):
        return _refuse("no case was counted at both commits")
    if worse:
        print(f"more than {most} times the instructions: {', '.join(worse)}", file=sys.stderr)
        return 1
    return 0


def _run(*command: str, check: bool = True) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=check)


def _remove(tree: Path) -> None:
    _run("git", "worktree", "remove", "--force", str(tree), check=False)
    shutil.rmtree(tree, ignore_errors=True)
    _run("git", "worktree", "prune", check=False)


def _refuse(message: str) -> int:
    print(f"guard: {message}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
