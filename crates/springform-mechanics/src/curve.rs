//! Measured force–strain curves: monotone cubics through test points.
//!
//! Fritsch & Butland, "A method for constructing local monotone piecewise cubic interpolants", 1984: slopes at inner
//! points are weighted harmonic means, so that the curve never overshoots its points; slopes at the ends are those of
//! a parabola, limited in the same way (Moler, "Numerical computing with MATLAB", 2004, section 3.6). Beyond the last
//! point the slope is at least the secant of the last piece: Moler's may be 0 there, and the cord would yield without end.

use thiserror::Error;

/// Force against strain of a cord, shaped by test points and scaled so that it ends at a slope of one on average.
///
/// A spring with a curve g pulls with F = k r g((L − r)/r) [N]. As g(ε) = ε at the last test point, k r is the axial
/// stiffness EA [N] that the cord has there as a secant; for a straight line of points, F = k (L − r). Beyond the
/// first and the last point the curve goes on straight, beyond the last at the secant of the last piece or steeper.
#[derive(Clone, PartialEq, Debug)]
pub struct Curve {
    /// Strains of the points, ascending.
    strains: Vec<f64>,
    /// Scaled force at every point.
    values: Vec<f64>,
    /// Slope at every point.
    slopes: Vec<f64>,
    /// Slope before the first point and beyond the last.
    outer: [f64; 2],
    /// Area under the curve from the first point to every point.
    areas: Vec<f64>,
    /// Force over strain at the last point [N].
    axial_stiffness: f64,
}

/// Why points make no curve; `point` counts from 0.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Error)]
pub enum CurveError {
    /// One point, or none.
    #[error("needs two points or more")]
    TooFew,
    /// A number that is not finite.
    #[error("point {point} is not finite")]
    NotFinite {
        /// The point.
        point: usize,
    },
    /// A strain not above the one before.
    #[error("point {point} has a strain that is not above the one before")]
    Strain {
        /// The point.
        point: usize,
    },
    /// A force below the one before.
    #[error("point {point} has a force below the one before")]
    Force {
        /// The point.
        point: usize,
    },
    /// The curve does not pass through strain 0 at force 0.
    #[error("must have the point of strain 0 and force 0")]
    Origin,
    /// The last point is not stretched or not pulled, or the force does not rise to it.
    #[error("must end with a rise to a strain and a force above 0, from which it goes on")]
    End,
}

impl Curve {
    /// A curve through points (strain, force [N]), among them (0, 0); strains ascend, forces don't fall.
    ///
    /// # Errors
    /// Points that are none of a cord.
    pub fn new(points: &[[f64; 2]]) -> Result<Curve, CurveError> {
        check(points)?;
        let last = points[points.len() - 1];
        let axial_stiffness = last[1] / last[0];
        let strains: Vec<f64> = points.iter().map(|point| point[0]).collect();
        let values: Vec<f64> = points.iter().map(|point| point[1] / axial_stiffness).collect();
        let slopes = monotone_slopes(&strains, &values);
        let end = strains.len() - 1;
        let rise = (values[end] - values[end - 1]) / (strains[end] - strains[end - 1]);
        let outer = [slopes[0], slopes[end].max(rise)];
        let mut curve =
            Curve { areas: vec![0.0; strains.len()], strains, values, slopes, outer, axial_stiffness };
        for piece in 0..points.len() - 1 {
            let width = curve.strains[piece + 1] - curve.strains[piece];
            curve.areas[piece + 1] = curve.areas[piece] + curve.piece_area(piece, width);
        }
        let origin = curve.area(0.0);
        curve.areas.iter_mut().for_each(|area| *area -= origin);
        Ok(curve)
    }

    /// Force over strain at the last point [N]: the secant axial stiffness EA of the cord that was tested.
    pub fn axial_stiffness(&self) -> f64 {
        self.axial_stiffness
    }

    /// Smallest and largest strain of the points.
    pub fn range(&self) -> [f64; 2] {
        [self.strains[0], self.strains[self.strains.len() - 1]]
    }

    /// Scaled force g at a strain.
    pub fn value(&self, strain: f64) -> f64 {
        let Some((piece, along)) = self.piece(strain) else { return self.beyond(strain).0 };
        let [linear, square, cube] = self.coefficients(piece);
        self.values[piece] + along * (linear + along * (square + along * cube))
    }

    /// Slope dg/dε at a strain.
    pub fn slope(&self, strain: f64) -> f64 {
        let Some((piece, along)) = self.piece(strain) else { return self.beyond(strain).1 };
        let [linear, square, cube] = self.coefficients(piece);
        (linear + along * (2.0 * square + 3.0 * along * cube)).max(0.0)
    }

    /// The least strain at which the scaled force g has a value; minus infinity if it is below all that the curve has.
    pub fn strain(&self, value: f64) -> f64 {
        let last = self.values.len() - 1;
        if value > self.values[last] {
            return self.strains[last] + (value - self.values[last]) / self.outer[1];
        }
        let point = self.values.partition_point(|&known| known < value);
        if point == 0 {
            let beyond = self.values[0] - value;
            return self.strains[0] - if beyond == 0.0 { 0.0 } else { beyond / self.outer[0] };
        }
        // Within a piece the force does not fall: halved until no number is left between.
        let [mut low, mut high] = [self.strains[point - 1], self.strains[point]];
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return high;
            }
            *(if self.value(middle) < value { &mut low } else { &mut high }) = middle;
        }
    }

    /// Area under the curve from strain 0.
    pub fn area(&self, strain: f64) -> f64 {
        if let Some((piece, along)) = self.piece(strain) {
            return self.areas[piece] + self.piece_area(piece, along);
        }
        let (end, slope) = self.end(strain);
        let along = strain - self.strains[end];
        self.areas[end] + along * (self.values[end] + 0.5 * along * slope)
    }

    /// The piece that a strain lies in, and how far from its start; `None` beyond the points.
    fn piece(&self, strain: f64) -> Option<(usize, f64)> {
        let [first, last] = self.range();
        if !(first..last).contains(&strain) {
            return None;
        }
        let piece = self.strains.partition_point(|&known| known <= strain) - 1;
        Some((piece, strain - self.strains[piece]))
    }

    fn beyond(&self, strain: f64) -> (f64, f64) {
        let (end, slope) = self.end(strain);
        (self.values[end] + slope * (strain - self.strains[end]), slope)
    }

    /// The point beyond which a strain lies, and the slope there.
    fn end(&self, strain: f64) -> (usize, f64) {
        if strain < self.strains[0] { (0, self.outer[0]) } else { (self.strains.len() - 1, self.outer[1]) }
    }

    /// Coefficients of a piece's powers, from the first.
    fn coefficients(&self, piece: usize) -> [f64; 3] {
        let width = self.strains[piece + 1] - self.strains[piece];
        let secant = (self.values[piece + 1] - self.values[piece]) / width;
        let (start, end) = (self.slopes[piece], self.slopes[piece + 1]);
        [start, (3.0 * secant - 2.0 * start - end) / width, (start + end - 2.0 * secant) / (width * width)]
    }

    fn piece_area(&self, piece: usize, along: f64) -> f64 {
        let [linear, square, cube] = self.coefficients(piece);
        along * (self.values[piece] + along * (linear / 2.0 + along * (square / 3.0 + along * cube / 4.0)))
    }
}

fn check(points: &[[f64; 2]]) -> Result<(), CurveError> {
    if points.len() < 2 {
        return Err(CurveError::TooFew);
    }
    if let Some(point) = points.iter().position(|point| !point.iter().all(|number| number.is_finite())) {
        return Err(CurveError::NotFinite { point });
    }
    for (point, pair) in points.windows(2).enumerate() {
        if pair[1][0] <= pair[0][0] {
            return Err(CurveError::Strain { point: point + 1 });
        }
        if pair[1][1] < pair[0][1] {
            return Err(CurveError::Force { point: point + 1 });
        }
    }
    if !points.contains(&[0.0, 0.0]) {
        return Err(CurveError::Origin);
    }
    let [before, last] = [points[points.len() - 2], points[points.len() - 1]];
    if last[0] > 0.0 && last[1] > before[1].max(0.0) && (last[1] / last[0]).is_finite() {
        Ok(())
    } else {
        Err(CurveError::End)
    }
}

fn monotone_slopes(strains: &[f64], values: &[f64]) -> Vec<f64> {
    let width = |piece: usize| strains[piece + 1] - strains[piece];
    let secant = |piece: usize| (values[piece + 1] - values[piece]) / width(piece);
    let last = strains.len() - 1;
    if last == 1 {
        return vec![secant(0); 2];
    }
    let inner = |point: usize| {
        let (before, after) = (secant(point - 1), secant(point));
        if before <= 0.0 || after <= 0.0 {
            return 0.0;
        }
        let (near, far) = (2.0 * width(point) + width(point - 1), width(point) + 2.0 * width(point - 1));
        (near + far) / (near / before + far / after)
    };
    // Of the parabola through the three points at an end; a force does not fall, so neither does the slope below 0.
    let end = |first: usize, second: usize| {
        let (near, far) = (width(first), width(second));
        let slope = ((2.0 * near + far) * secant(first) - near * secant(second)) / (near + far);
        slope.clamp(0.0, 3.0 * secant(first))
    };
    (0..=last)
        .map(|point| match point {
            0 => end(0, 1),
            point if point == last => end(last - 1, last - 2),
            point => inner(point),
        })
        .collect()
}
