//! The pattern of a symmetric matrix: rows and the links between them.

/// Rows and links between them; several links may join the same two rows.
///
/// ```text
/// starts   [0,    2,        5, ...]   one a row, and the end
/// others   [b, c, a, c, d,  ...]      row at the far end of each link of a row
/// links    [0, 1, 0, 2, 3,  ...]      number of that link
/// ```
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Graph {
    starts: Vec<u32>,
    others: Vec<u32>,
    links: Vec<u32>,
}

impl Graph {
    /// A row that a link does not have: the link leaves the matrix there.
    pub const OUTSIDE: u32 = u32::MAX;

    /// Builds the graph anew; rows of links are below `rows` or [`Graph::OUTSIDE`].
    pub fn build(&mut self, rows: usize, links: impl Iterator<Item = [u32; 2]> + Clone) {
        self.starts.clear();
        self.starts.resize(rows + 1, 0);
        let inside = |pair: &[u32; 2]| pair[0] != Graph::OUTSIDE && pair[1] != Graph::OUTSIDE;
        for [a, b] in links.clone().filter(inside) {
            self.starts[a as usize] += 1;
            self.starts[b as usize] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.others.clear();
        self.others.resize(end as usize, 0);
        self.links.clear();
        self.links.resize(end as usize, 0);
        // From behind, so that the starts end where they belong.
        let mut add = |row: u32, other: u32, link: u32| {
            self.starts[row as usize] -= 1;
            let at = self.starts[row as usize] as usize;
            (self.others[at], self.links[at]) = (other, link);
        };
        for (link, [a, b]) in links.enumerate().filter(|(_, pair)| inside(pair)) {
            add(a, b, link as u32);
            add(b, a, link as u32);
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Other row and link of each link of a row.
    #[inline(always)]
    pub fn of(&self, row: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        let range = self.starts[row as usize] as usize..self.starts[row as usize + 1] as usize;
        self.others[range.clone()].iter().copied().zip(self.links[range].iter().copied())
    }

    /// Rows and columns of the pattern as `amd` counts on: ascending, each once, the diagonal among them.
    pub fn pattern(&self) -> (Vec<i32>, Vec<i32>) {
        let rows = self.rows();
        let mut starts: Vec<i32> = Vec::with_capacity(rows + 1);
        starts.push(0);
        for row in 0..rows {
            let links = self.starts[row + 1] - self.starts[row];
            starts.push(starts[row] + links as i32 + 1);
        }
        let mut columns = vec![0; starts[rows] as usize];
        let mut next: Vec<i32> = starts[..rows].to_vec();
        // Row by row, what is written to the others' columns ascends.
        for row in 0..rows {
            let mut write = |column: u32| {
                let at = next[column as usize];
                if at == starts[column as usize] || columns[at as usize - 1] != row as i32 {
                    columns[at as usize] = row as i32;
                    next[column as usize] += 1;
                }
            };
            write(row as u32);
            self.of(row as u32).for_each(|(other, _)| write(other));
        }
        // Links between the same rows leave gaps.
        let mut end = 0;
        for row in 0..rows {
            let range = starts[row] as usize..next[row] as usize;
            let length = range.len();
            columns.copy_within(range, end);
            starts[row] = end as i32;
            end += length;
        }
        starts[rows] = end as i32;
        columns.truncate(end);
        (starts, columns)
    }
}
