"""Every example runs and ends with the line it should."""

import subprocess
import sys
from pathlib import Path

import pytest

import springform as sf

EXAMPLES = Path(__file__).parent.parent / "examples"
LAST_LINES = {
    "01_one_cylinder.py": "force differential 3.3",
    "02_refine_by_hand.py": "undone: 4.5",
    "03_stress_seeking.py": "type 6, dynamic: ",
    "04_evolve.py": "rebuilt: ",
    "05_animate.py": "converged: True",
    "08_even_forces.py": "of 1, 2 or 4 strands: 5.38, then ",
    "06_real_cords.py": "held: 500.0 N of 500.0 N",
    "07_graft.py": "fresh base with patches of two runs: ",
}


def test_every_example_is_tested() -> None:
    assert {path.name for path in EXAMPLES.glob("*.py")} == set(LAST_LINES)


@pytest.mark.parametrize("name", LAST_LINES)
def test_example_ends_as_it_should(name: str) -> None:
    done = subprocess.run(
        [sys.executable, EXAMPLES / name], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].startswith(LAST_LINES[name])


def test_the_design_in_the_documentation_grows(tmp_path: Path) -> None:
    text = (EXAMPLES.parent / "docs" / "formats" / "design.md").read_text()
    first_block = text.split("```toml\n")[1].split("```")[0]
    path = tmp_path / "two-tubes.toml"
    path.write_text(first_block)
    assert sf.load(path).solve().converged
