//! Springs as cells give them, gathered in any order, and sorted by their nodes, each once.

use super::Spring;
use super::stitching::NONE;

/// Springs on their way into order, and the memory for the next ones.
#[derive(Clone, Default)]
pub(super) struct Gathering {
    /// Lower node, and the higher one with the number in the order of gathering and whether it is a ring's.
    gathered: Vec<(u32, u64)>,
    /// `starts[node]`: first place of the springs with this lower node; one more at the end.
    starts: Vec<u32>,
    places: Vec<u64>,
}

/// Up to so many springs of one lower node are sorted by insertion.
const FEW: usize = 16;

impl Gathering {
    /// Forgets all springs; they will run between so many nodes.
    pub fn begin(&mut self, nodes: usize) {
        self.gathered.clear();
        self.starts.clear();
        self.starts.resize(nodes + 1, 0);
    }

    /// Number of springs gathered so far.
    pub fn len(&self) -> u32 {
        self.gathered.len() as u32
    }

    /// Gathers a spring between two different nodes and returns its number.
    pub fn gather(&mut self, [a, b]: [u32; 2], ring: bool) -> u32 {
        let (lower, higher) = (a.min(b), a.max(b));
        let number = self.len();
        self.starts[lower as usize + 1] += 1;
        self.gathered.push((lower, u64::from(higher) << 32 | u64::from(number) << 1 | u64::from(ring)));
        number
    }

    /// Writes all springs but those between pairs of nodes that are cut, ascending by nodes, each once. What is given
    /// twice is a ring's spring if it is so once.
    pub fn sort(&mut self, cut: &[[u32; 2]], springs: &mut Vec<Spring>) {
        self.place();
        springs.clear();
        let mut from = 0;
        for (lower, &to) in self.starts.iter().enumerate() {
            let places = &mut self.places[from..to as usize];
            from = to as usize;
            sort_few(places);
            let mut last = NONE;
            for &mut place in places {
                let (higher, ring) = ((place >> 32) as u32, place & 1 == 1);
                let nodes = [lower as u32, higher];
                if let Some(spring) = springs.last_mut().filter(|_| higher == last) {
                    spring.ring |= ring;
                } else if cut.is_empty() || cut.binary_search(&nodes).is_err() {
                    springs.push(Spring { nodes, ring });
                    last = higher;
                }
            }
        }
    }

    /// Lists the place of every gathered spring among the sorted ones, or `NONE` if it is cut.
    pub fn list_sorted(&self, cut: &[[u32; 2]], sorted: &mut Vec<u32>) {
        sorted.clear();
        sorted.resize(self.gathered.len(), NONE);
        let (mut from, mut next) = (0, 0);
        for (lower, &to) in self.starts.iter().enumerate() {
            let places = &self.places[from..to as usize];
            from = to as usize;
            for same in places.chunk_by(|a, b| a >> 32 == b >> 32) {
                if cut.binary_search(&[lower as u32, (same[0] >> 32) as u32]).is_err() {
                    same.iter().for_each(|&place| sorted[(place as u32 >> 1) as usize] = next);
                    next += 1;
                }
            }
        }
    }

    /// Puts springs of one lower node side by side; leaves the end of each node's springs in `starts`.
    fn place(&mut self) {
        for node in 1..self.starts.len() {
            self.starts[node] += self.starts[node - 1];
        }
        self.places.resize(self.gathered.len(), 0);
        for &(lower, place) in &self.gathered {
            let next = &mut self.starts[lower as usize];
            self.places[*next as usize] = place;
            *next += 1;
        }
        self.starts.pop();
    }
}

fn sort_few(places: &mut [u64]) {
    if places.len() > FEW {
        places.sort_unstable();
        return;
    }
    for end in 1..places.len() {
        let place = places[end];
        let mut at = end;
        while at > 0 && places[at - 1] > place {
            places[at] = places[at - 1];
            at -= 1;
        }
        places[at] = place;
    }
}
