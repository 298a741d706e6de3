"""Evolve: grow a net under the spring utilization factor, and rebuild what the run has seen."""

import springform as sf


def tell(progress: sf.Progress) -> None:
    """Print every tenth generation."""
    if progress.generation % 10 == 0:
        print(
            f"generation {progress.generation}: {progress.springs} springs, "
            f"force differential {progress.force_differential:.1f}"
        )


design = sf.load("three-cylinders")
run = sf.evolve(design, population=30, generations=30, types=(1, 6), seed=1, on_generation=tell)

best = run.best
print(f"final parent: {run.final['springs']} springs")
generation, individual = run.lowest
print(f"lowest differential: individual {individual} of generation {generation}")
rebuilt = run.individual(generation, individual)
measures = rebuilt.measure(rebuilt.solve())
print(f"rebuilt: {measures.springs} springs, force differential {measures.force_differential:.1f}")
