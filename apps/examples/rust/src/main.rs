//! rank: which of three drives looks most like now? As ../rank.c, and it prints the same bytes.
//!
//!     cargo run    # libvdna not installed: with RUSTFLAGS=-L..., LD_LIBRARY_PATH

mod vdna;

use vdna::{rank, Error, Histogram, Ranges};

const NEURONS: usize = 8;
const SAMPLES: usize = 4;
const FRAMES: usize = 50;
const BINS: u32 = 1000;

/// A made-up drive: its activations lie in shift..shift + 1.
struct Drive {
    name: &'static str,
    seed: u32,
    shift: f32,
}

const CANDIDATES: [Drive; 3] = [
    Drive {
        name: "spring",
        seed: 1,
        shift: 0.0,
    },
    Drive {
        name: "summer",
        seed: 2,
        shift: 0.25,
    },
    Drive {
        name: "winter",
        seed: 3,
        shift: 0.75,
    },
];
const NOW: Drive = Drive {
    name: "now",
    seed: 4,
    shift: 0.3125,
};

impl Drive {
    /// The activations of each frame, [samples][neurons]. Each number is the upper half of
    /// x = 1664525 x + 1013904223 (mod 2^32), divided by 2^16: exact in any language.
    fn frames(&self) -> impl Iterator<Item = Vec<f32>> + '_ {
        let mut x = self.seed;
        let mut next = move || {
            x = x.wrapping_mul(1664525).wrapping_add(1013904223);
            (x >> 16) as f32 / 65536.0 + self.shift
        };
        (0..FRAMES).map(move |_| (0..SAMPLES * NEURONS).map(|_| next()).collect())
    }
}

fn count(drive: &Drive, range: &[f32]) -> Result<Histogram, Error> {
    let mut histogram = Histogram::new(range, BINS)?;
    for values in drive.frames() {
        histogram.add(&values)?;
    }
    Ok(histogram)
}

fn main() -> Result<(), Error> {
    // Ranges come from the map alone; the live drive never changes them.
    let mut ranges = Ranges::new(NEURONS as u32)?;
    for values in CANDIDATES.iter().flat_map(Drive::frames) {
        ranges.observe(&values)?;
    }
    let range = ranges.expand(1.2)?;

    let live = count(&NOW, &range)?;
    let candidates: Result<Vec<_>, _> = CANDIDATES.iter().map(|d| count(d, &range)).collect();
    for (place, entry) in rank(&live, &candidates?)?.iter().enumerate() {
        let name = CANDIDATES[entry.candidate as usize].name;
        println!(
            "{}. {} is {:.17} bins away",
            place + 1,
            name,
            entry.distance_bins
        );
    }
    Ok(())
}
