//! rank: which of three drives looks most like now, and where in it are we? Same program as
//! ../rank.c, with the same output.
//!
//!     cargo run    # libvdna not installed: with RUSTFLAGS=-L..., LD_LIBRARY_PATH

mod vdna;

use vdna::{rank, Candidate, Error, Histogram, Ranges, Selector};

const NEURONS: usize = 8;
const SAMPLES: usize = 4;
const FRAMES: usize = 50;
const WARMUP: u32 = 40;
const BINS: u32 = 1000;
const PERIOD_US: i64 = 100_000; // of the camera

/// A synthetic drive: its activations lie in shift..shift + 1.
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

/// The embedding of a frame: here just its first sample.
fn embedding(values: &[f32]) -> &[f32] {
    &values[..NEURONS]
}

/// Warm up on the first frames, choose, and find the last frame in the chosen drive.
fn choose(histograms: &[Histogram]) -> Result<(), Error> {
    let mut embeddings: Vec<Vec<f32>> = Vec::new();
    for drive in &CANDIDATES {
        let frames = drive.frames().map(|values| embedding(&values).to_vec());
        embeddings.push(frames.flatten().collect());
    }
    let experiences: Vec<Candidate> = histograms
        .iter()
        .zip(&embeddings)
        .map(|(histogram, embeddings)| Candidate {
            histogram,
            embeddings,
        })
        .collect();
    let mut selector = Selector::new(&experiences, NEURONS, WARMUP)?;
    let mut nearest = None;
    for (index, values) in NOW.frames().enumerate() {
        nearest = selector.feed(index as i64 * PERIOD_US, &values, embedding(&values))?;
    }
    let chosen = selector.chosen().expect("a choice after the warmup");
    let frame = nearest.expect("a place after the warmup");
    let name = CANDIDATES[chosen].name;
    println!(
        "live: {} after {} frames, by {:.17} bins",
        name,
        selector.window_frames(),
        selector.margin_bins()
    );
    println!("now is nearest to frame {frame} of {name}");
    Ok(())
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
    let candidates = candidates?;
    for (place, entry) in rank(&live, &candidates)?.iter().enumerate() {
        let name = CANDIDATES[entry.candidate as usize].name;
        println!(
            "{}. {} is {:.17} bins away",
            place + 1,
            name,
            entry.distance_bins
        );
    }
    choose(&candidates)
}
