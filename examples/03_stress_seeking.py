"""Direct stress-seeking: subdivide the cell of highest inner force, again and again."""

import springform as sf

for cell_type, method in ((1, "recursive"), (2, "extensible"), (6, "dynamic")):
    design = sf.load("one-cylinder").with_method(method)
    *_, last = sf.seek(design, steps=60, type=cell_type)
    print(
        f"type {cell_type}, {method}: {last.springs} springs, "
        f"force differential {last.force_differential:.1f}"
    )
