//! Random draws, each a function of (seed, generation, individual).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The draws of one individual.
#[derive(Clone, Debug)]
pub struct Draws(ChaCha8Rng);

impl Draws {
    /// Draws of an individual of a generation of a run.
    pub fn new(seed: u64, generation: u64, individual: u64) -> Draws {
        let mut key = [0; 32];
        for (bytes, number) in key.chunks_exact_mut(8).zip([seed, generation, individual]) {
            bytes.copy_from_slice(&number.to_le_bytes());
        }
        Draws(ChaCha8Rng::from_seed(key))
    }

    /// A whole number below `bound`, each equally likely; 0 if the bound is 0.
    pub fn below(&mut self, bound: u32) -> u32 {
        // Lemire, "Fast random integer generation in an interval", 2019.
        let bound = u64::from(bound);
        if bound == 0 {
            return 0;
        }
        let refused = (1u64 << 32) % bound;
        loop {
            let product = u64::from(self.0.next_u32()) * bound;
            if (product & 0xffff_ffff) >= refused {
                return (product >> 32) as u32;
            }
        }
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}
