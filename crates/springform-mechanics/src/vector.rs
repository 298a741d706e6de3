//! Three-vectors as arrays: the few operations that nets need.

/// A point or vector [m] or [N].
pub type Vector = [f64; 3];

/// a + b.
pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
pub fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// s a.
pub fn scale(a: Vector, s: f64) -> Vector {
    [s * a[0], s * a[1], s * a[2]]
}

/// a · b.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|.
pub fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Mean of points; the origin if there are none.
pub fn mean(points: impl ExactSizeIterator<Item = Vector>) -> Vector {
    let count = points.len().max(1) as f64;
    scale(points.fold([0.0; 3], add), 1.0 / count)
}

/// Largest length of vectors; zero if there are none.
pub fn largest(vectors: &[Vector]) -> f64 {
    vectors.iter().map(|&vector| length(vector)).fold(0.0, f64::max)
}
