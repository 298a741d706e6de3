"""Patches, grafts, genes and symmetries on every packaged framework, and as users meet them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import springform as sf
from helpers import assert_refused, assert_untouched, in_process
from springform import _core
from springform.patch_file import dump_patch

FORESTS = 1000  # on each framework
QUICK = {"population": 6, "generations": 4}


class Forests:
    """Random forests on a framework: a few cells with random trees, more of them near anchors."""

    def __init__(self, scene: str) -> None:
        self.design = sf.load(scene)
        self.setting = self.design.setting
        self.rng = np.random.default_rng(2015)
        self.near = [
            _core.Selection.rings(self.design.mesh, [f"v{vertex}"], 2, 0).faces
            for vertex in self.design.anchor_vertices
        ]

    def tree(self, depth: int) -> str:
        kind = f"{self.rng.integers(0, 7)}"
        if turn := int(self.rng.integers(0, 4)):
            kind += f"@{turn}"
        if depth == 0 or self.rng.random() < 0.4:
            return kind
        inner = " ".join(self.tree(depth - 1) for _ in range(4))
        return f"{kind}({inner})" if self.rng.random() < 0.7 else f"{kind}[{inner}]"

    def draw(self, anchor: int) -> _core.Forest:
        chosen = self.rng.choice(self.near[anchor], 4)
        others = self.rng.integers(0, len(self.design.mesh.faces), 3)
        cells = {int(cell): self.tree(2) for cell in (*chosen, *others)}
        return self.setting.forest("1", 0, cells, [], [])


@pytest.mark.parametrize("scene", sf.scene_names())
def test_patches_come_back_on_every_framework(scene: str) -> None:
    forests = Forests(scene)
    design, setting = forests.design, forests.setting
    group = _core.Symmetries(setting)
    rotations = [number for number, mirrored in enumerate(group.mirrored) if not mirrored]
    vertices = design.anchor_vertices
    for case in range(FORESTS):
        at = case % len(vertices)
        forest = forests.draw(at)
        rings = 1 + case % 2
        round_it = _core.Selection.rings(design.mesh, [f"v{vertices[at]}"], rings, 0)
        patch, frame, left = _core.lift(
            setting, forest, round_it, vertex=vertices[at], anchored=True
        )
        # Grafted back on its place.
        back, edits, [(cells, skipped)] = _core.graft_patch(setting, forest, patch, [frame])
        assert back == forest
        assert (edits, skipped) == ([], [])
        assert len(cells) + len(left) == len(round_it.faces)
        # Turned by r and by 4 - r, mirrored twice; also when set somewhere else.
        turn, mirror = case % 4, case % 8 > 3
        moved = _core.turned_patch(setting, patch, turn, mirror)
        there_and_back = turn if mirror else (4 - turn) % 4
        assert _core.turned_patch(setting, moved, there_and_back, mirror) == patch
        face = int(forests.rng.integers(0, len(design.mesh.faces)))
        straight, edits, [(_, missed)] = _core.graft_patch(
            setting, forest, patch, [(face, 0, False)]
        )
        around, _, _ = _core.graft_patch(setting, forest, moved, [(face, there_and_back, mirror)])
        if not any("twice" in why for _, _, why in missed):
            assert straight == around
        undone = setting.edited(straight, setting.inverse(edits))
        assert undone == forest
        # Lifted from the rotated copy of the design.
        number = rotations[case % len(rotations)]
        copy = group.carried(setting, forest, number)
        image = int(group.node_images(design.mesh, f"v{vertices[at]}")[number][1:])
        round_image = _core.Selection.rings(design.mesh, [f"v{image}"], rings, 0)
        again, _, _ = _core.lift(setting, copy, round_image, vertex=image, anchored=True)
        assert again == patch


@pytest.mark.parametrize("scene", sf.scene_names())
def test_grafted_designs_grow_like_others(scene: str) -> None:
    forests = Forests(scene)
    for case in range(20):
        at = case % len(forests.design.anchor_vertices)
        design = forests.design.with_forest(forests.draw(at))
        patch = sf.lift(design, anchor=design.anchor_names[at], rings=2).patch
        grafted = sf.graft(forests.design, patch, anchors=True)
        assert len(grafted.placed) + len(grafted.skipped) > 0
        assert forests.design.edited(grafted.edits).forest == grafted.design.forest
        undone = grafted.design.edited(grafted.design.inverse(grafted.edits))
        assert undone.forest == forests.design.forest
        equilibrium = grafted.design.solve()
        assert equilibrium.converged
        written = {cell for placed in grafted.placed for cell in placed.cells}
        before, after = forests.design, grafted.design
        for cell in set(range(len(before.mesh.faces))) - written:
            assert before.setting.tree(before.forest, cell) == after.setting.tree(
                after.forest, cell
            )


def test_patches_go_from_quad_to_dia_and_back() -> None:
    quad, dia = sf.load("one-cylinder-quad"), sf.load("one-cylinder")
    evolved = sf.evolve(quad, **QUICK).best
    patch = sf.lift(evolved, anchor="A1", rings=2).patch
    there = sf.graft(dia, patch, anchors=True)
    assert there.design.solve().converged
    back = sf.lift(there.design, anchor="A1", rings=2).patch
    assert sf.graft(quad, back, anchors=True).design.solve().converged


def test_patches_of_several_sources_share_a_base() -> None:
    base = sf.load("three-cylinders")
    crowns = [
        sf.lift(sf.evolve(base, seed=seed, **QUICK).best, anchor="A1", rings=1).patch
        for seed in (1, 2)
    ]
    first = sf.graft(base, crowns[0], anchors=base.anchor_names[:6]).design
    both = sf.graft(first, crowns[1], anchors=base.anchor_names[6:])
    for anchor, crown in (("A2", crowns[0]), ("A8", crowns[1])):
        assert sf.lift(both.design, anchor=anchor, rings=1).patch.cells == crown.cells


def test_a_patch_file_says_where_it_comes_from(tmp_path: Path) -> None:
    run = sf.evolve(sf.load("three-cylinders"), out=tmp_path / "run", **QUICK)
    best = sf.best_anchor(run.best)
    words = ["--anchor", "best", "--out", tmp_path / "crown.toml", "--json"]
    report = in_process("patch", tmp_path / "run", *words).report
    patch = sf.load_patch(tmp_path / "crown.toml")
    assert report["anchor"] == best
    assert patch.name == "crown"
    assert patch.origin.run == str(tmp_path / "run")
    assert patch.origin.generation == 4
    assert patch.origin.springs == run.final["springs"]
    sf.save_patch(patch, tmp_path / "again.json")
    assert sf.load_patch(tmp_path / "again.json") == patch
    # Lifted from another individual, too.
    words = ["--generation", 2, "--individual", 3, "--cells", "rings(A1, 1) - 18", "--json"]
    report = in_process("patch", tmp_path / "run", *words, "--out", tmp_path / "b.toml").report
    assert report["origin"]["individual"] == 3


def test_the_command_says_what_was_placed_and_skipped(tmp_path: Path) -> None:
    design = sf.load("three-cylinders").edited(["18 subdivide 6 1 6 1"])
    sf.save_patch(sf.lift(design, anchor="A1", rings=2, name="crown").patch, tmp_path / "p.toml")
    out = tmp_path / "out.toml"
    words = ["graft", tmp_path / "p.toml", "three-cylinders"]
    report = in_process(*words, "--all-anchors", "--out", out, "--json").report
    assert (report["placed"], report["skipped"]) == (12, [])
    assert report["springs"]["before"] == 672 < report["springs"]["after"]
    assert report["force_differential"]["before"] == pytest.approx(5.384, abs=0.001)
    assert sf.load(out).solve().converged
    report = in_process(*words, "--at", 0, "--out", out, "--json").report
    assert report["placed"] == 1
    assert {"where", "why"} == set(report["skipped"][0])
    report = in_process(*words, "--at", 18, "--orbit", "--out", out, "--json").report
    assert report["placed"] == 12
    lattice = "lattice(trunk, 0..15, 3..3)"
    report = in_process(*words, "--at-each", lattice, "--out", out, "--json").report
    assert any("another place" in one["why"] for one in report["skipped"])


def test_bad_input_is_one_line_and_writes_nothing(tmp_path: Path) -> None:
    base = sf.load("three-cylinders")
    patch = sf.lift(base, anchor="A1", rings=2).patch
    good = tmp_path / "good.toml"
    sf.save_patch(patch, good)
    old = dump_patch(patch, "toml").replace("springform_patch = 1", "springform_patch = 2")
    (tmp_path / "old.toml").write_text(old)
    (tmp_path / "walk.toml").write_text(dump_patch(patch, "toml").replace('"f"', '"x"'))
    cell = dump_patch(patch, "toml").replace('cell = "1"', 'cell = "1(1 1"', 1)
    (tmp_path / "cell.toml").write_text(cell)
    large = sf.lift(base, cells="all").patch
    sf.save_patch(large, tmp_path / "large.toml")
    fan = base.edited(["18 retype 1 6"])
    sf.save_patch(sf.lift(fan, anchor="A1", rings=1).patch, tmp_path / "fan.toml")
    sf.save_patch(sf.lift(base, cells="18").patch, tmp_path / "loose.toml")
    sf.save(base.with_method("recursive"), tmp_path / "recursive.toml")
    out = ["--out", tmp_path / "out.toml"]
    anchors = ["--all-anchors", *out]
    three = "three-cylinders"
    refusals: list[tuple[list[object], tuple[str, ...]]] = [
        (["graft", tmp_path / "old.toml", three, *anchors], ("old.toml:1", "version 2")),
        (["graft", tmp_path / "walk.toml", three, *anchors], ("walk.toml:", "walk")),
        (["graft", tmp_path / "cell.toml", three, *anchors], ("cells[0]", "expected a cell type")),
        (["graft", tmp_path / "large.toml", "sheet", "--at", "0", *out], ("312", "162")),
        (["graft", tmp_path / "fan.toml", tmp_path / "recursive.toml", *anchors], ("type 6",)),
        (["graft", tmp_path / "loose.toml", three, *anchors], ("not lifted at an anchor",)),
        (["graft", good, three, "--at", "900", *out], ("no top-level cell 900", "0 to 311")),
        (["graft", good, three, "--at", "12.0", *out], ("--at", "top-level cell")),
        (["graft", good, three, "--at-each", "12 - 12", *out], ("selects no cell",)),
        (["graft", good, three, *out], ("--all-anchors",)),
        (["graft", tmp_path / "recursive.toml", three, *anchors], ("no patch",)),
        (["graft", good, three, "--at", "3", "--rotate", "4", *out], ("--rotate",)),
        (["patch", three, "--anchor", "A99", *out], ("no anchor", "A9")),
        (["patch", three, "--cells", "force(1e)", *out], ("range",)),
        (["patch", three, "--cells", "force(99..)", *out], ("selects no cell",)),
        (["patch", three, "--cells", "rings(A1 2)", *out], ("expected",)),
        (["patch", three, "--cells", "lattice(trunc, 0..1, 0..1)", *out], ("trunk",)),
        (["patch", three, "--cells", "9000", *out], ("no cell 9000",)),
        (["patch", three, *out], ("--anchor",)),
        (["diff", three, "nothing.toml"], ("nothing.toml",)),
        (["distil", tmp_path, "--out", tmp_path / "genes"], ("run.json",)),
        (["evolve", three, "--genes", tmp_path / "old.toml", "--out", tmp_path / "r"], ("2",)),
        (["evolve", three, "--within", "none", "--out", tmp_path / "r"], ("selection",)),
    ]
    for words, parts in refusals:
        result = assert_untouched(tmp_path, lambda words=words: in_process(*words))
        assert_refused(result, *parts)


def test_selections_are_put_together() -> None:
    design = sf.load("three-cylinders").edited(["18 subdivide 1 1 1 1"])

    def chosen(text: str) -> list[str]:
        return sf.select(design, text).addresses

    assert chosen("18.0 + 18.1 + 18.2 + 18.3") == ["18"]
    assert set(chosen("18 - 18.2")) == {"18.0", "18.1", "18.3"}
    assert chosen("(18 + 19) & 19") == ["19"]
    assert chosen("shrink(grow(18, 2), 2)") == ["18"]
    assert set(chosen("rings(A1, 1)")) < set(chosen("rings(A1, 2)"))
    assert chosen("rings(A1, 2)") == chosen("grow(rings(A1, 1), 1)")
    assert len(chosen("rings(seam:0, 1)")) > 8
    assert chosen("rings(trunk.start, 1)") == chosen("lattice(trunk, 0..15, 0..1)")
    assert chosen("force(0..)") == chosen("all")
    strong = design.inner_forces(design.solve()).max()
    assert 0 < len(chosen(f"force({strong * 0.9:.6f}..)")) < 40
    region = "map(trunk, 3..5, 0..1)"
    assert chosen(region) == chosen(f"{region} & lattice(trunk, 0..15, 0..2)")
    assert all(address.startswith("18.") for address in chosen("rings(v2, 1, 2) & 18"))


def test_genes_by_reference_change_in_all_places(tmp_path: Path) -> None:
    base = sf.load("three-cylinders")
    patch = sf.lift(base.edited(["18 subdivide 6 1 1 1"]), anchor="A1", rings=1).patch
    grafted = sf.graft(base, patch, anchors=True, as_gene="crown")
    assert len(grafted.placed) == 12
    design = grafted.design
    sf.save(design, tmp_path / "a.toml")
    text = (tmp_path / "a.toml").read_text()
    assert text.count('"&crown') == 12
    again = sf.load(tmp_path / "a.toml")
    assert again.forest == design.forest
    changed = again.edited(["18.1 subdivide 1 1 1 6"])
    springs = len(changed.network().springs) - len(again.network().springs)
    assert springs % 12 == 0
    assert springs > 0
    undone = changed.edited(changed.inverse(["18.1 subdivide 1 1 1 6"]))
    assert undone.forest == again.forest
    sf.save(changed, tmp_path / "b.toml")
    assert sf.load(tmp_path / "b.toml").forest == changed.forest
    run = sf.evolve(again, out=tmp_path / "run", within="gene(crown)", **QUICK)
    trees = {cell.cell for cell in run.best.to_file().genes["crown"].cells}
    assert len(run.best.to_file().forest.cells) == 12
    assert trees != {cell.cell for cell in patch.cells}
    assert run.individual(3, 2).solve().converged


@pytest.mark.parametrize("method", ["dynamic", "recursive"])
def test_runs_with_all_of_it_resume_to_the_same_bits(tmp_path: Path, method: str) -> None:
    design = sf.load("one-cylinder").with_method(method)
    crown = sf.lift(design.edited(["0 subdivide 1 1 1 1"]), anchor="A1", rings=2).patch
    more = {"genes": [crown], "grafts": "2", "population": 6, "seed": 5}
    options: list[dict[str, object]] = [
        {"symmetry": True, **more},
        {"within": "rings(A1, 2) + rings(A3, 2)", **more},
    ]
    for number, chosen in enumerate(options):
        straight = sf.evolve(design, generations=6, threads=1, **chosen)
        folder = tmp_path / f"{method}{number}"
        sf.evolve(design, out=folder, generations=3, threads=2, **chosen)
        resumed = sf.resume(folder, generations=6, threads=1)
        assert resumed.digest() == straight.digest()
        assert resumed.parameters.genes == (crown,)
        rebuilt = resumed.individual(5, 4)
        row = (resumed.table["generation"] == 5) & (resumed.table["individual"] == 4)
        assert rebuilt.forest.fingerprint == resumed.table["fingerprint"][row][0]
        if chosen.get("symmetry"):
            group = sf.symmetries(design)
            group.check(design.setting, resumed.best.forest)
            group.check(design.setting, rebuilt.forest)


def test_symmetry_refuses_a_start_that_has_none(tmp_path: Path) -> None:
    sf.save(sf.load("one-cylinder").edited(["0 subdivide 1 1 1 1"]), tmp_path / "a.toml")
    result = in_process("evolve", tmp_path / "a.toml", "--symmetry", "--out", tmp_path / "run")
    assert_refused(result, "symmetry", "differ")
    report = in_process("symmetry", "ring-of-six", "--json").report
    assert (report["symmetries"], report["rotations"], report["mirrors"]) == (3, 3, 0)


def test_edits_of_orbits_keep_the_symmetry() -> None:
    design = sf.load("three-cylinders")
    edits = sf.edit_orbit(design, ["18 subdivide 6 1 6 1"])
    assert len(edits) == 12
    sf.symmetries(design).check(design.setting, design.edited(edits).forest)
    # On one cylinder a mirror keeps each anchor, and with it the diamond below.
    cylinder = sf.load("one-cylinder")
    cell = sf.lift(cylinder, anchor="A1", rings=1).frame[0]
    with pytest.raises(sf.PatchError, match="orbit"):
        sf.edit_orbit(cylinder, [f"{cell} subdivide 1 6 1 1"])


@pytest.mark.parametrize("scene", ["three-cylinders", "one-cylinder"])
def test_stress_seeking_keeps_symmetries(scene: str, tmp_path: Path) -> None:
    words = ["--steps", 4, "--type", 6, "--symmetry", "--out", tmp_path / "a.toml", "--json"]
    report = in_process("seek", scene, *words).report
    design = sf.load(tmp_path / "a.toml")
    sf.symmetries(design).check(design.setting, design.forest)
    assert report["springs"] == len(design.network().springs)
    steps = list(sf.seek(sf.load(scene), steps=4, type=6, symmetry=True))
    assert steps[-1].design.forest == design.forest
    # Of the cells that a step divides, one carries most.
    base = sf.load(scene)
    inner = base.inner_forces(base.solve())
    divided = {edit.split(" ")[0] for edit in steps[0].edits if " subdivide " in edit}
    hottest = base.cells.addresses[int(np.argmax(inner))]
    assert hottest in divided
    lopsided = base.edited(["0 subdivide 1 1 1 1"])
    with pytest.raises(sf.InputError, match="differ"):
        list(sf.seek(lopsided, steps=1, type=6, symmetry=True))


def test_distilled_patches_are_genes(tmp_path: Path) -> None:
    run = sf.evolve(
        sf.load("three-cylinders"), out=tmp_path / "run", population=20, generations=20, seed=3
    )
    words = ["--out", tmp_path / "genes", "--least", 3, "--json"]
    report = in_process("distil", run.folder, *words).report
    assert len(report["patches"]) == 12
    patches = [sf.load_patch(one["file"]) for one in report["patches"]]
    assert len({json.dumps(patch.core()) for patch in patches}) == 12
    assert any(patch.anchored for patch in patches)
    # The best carrier does carry it.
    for patch in (patch for patch in patches if patch.anchored):
        carrier = run.individual(patch.origin.generation, patch.origin.individual)
        found = [sf.lift(carrier, anchor=name, rings=1).patch for name in carrier.anchor_names]
        assert any(len(one.walks) == len(patch.walks) for one in found)
    words = ["--population", 6, "--generations", 3, "--genes", tmp_path / "genes", "--json"]
    bred = in_process("evolve", "three-cylinders", "--out", tmp_path / "b", *words).report
    assert bred["generations"] == 3
    assert_refused(in_process("distil", run.folder, "--out", tmp_path / "genes"), "not empty")


def test_designs_are_compared(tmp_path: Path) -> None:
    base = sf.load("three-cylinders")
    changed = base.edited(["18 subdivide 1 1 6 1"])
    sf.save(changed, tmp_path / "b.toml")
    words = ["diff", "three-cylinders", tmp_path / "b.toml", "--out", tmp_path / "d.png", "--json"]
    report = in_process(*words).report
    assert report["changed_cells"] == [18]
    assert report["springs"] == {"a": 672, "b": len(changed.network().springs)}
    assert report["moved"][0]["cell"] == 18
    assert (tmp_path / "d.png").stat().st_size > 10_000
    same = sf.compare(base, base)
    assert (same.changed, same.moved) == ((), ())
    assert not sf.compare(base, sf.load("sheet")).same_framework
