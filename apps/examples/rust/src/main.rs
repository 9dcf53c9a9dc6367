//! rank [FILE.vdna...]: which of three drives looks most like now, and where in it are we? Same
//! program as ../rank.c, with the same output.
//!
//!     cargo run    # libvdna not installed: with RUSTFLAGS=-L..., LD_LIBRARY_PATH

mod vdna;

use vdna::{rank, Candidate, Error, Experience, Histogram, Ranges, Selector, View};

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

const DRIVES: [Drive; 3] = [
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

/// A drive to choose from: made up here, or opened from a file.
enum Recorded {
    MadeUp {
        name: &'static str,
        histogram: Histogram,
        embeddings: Vec<f32>,
    },
    File(Experience),
}

impl Recorded {
    fn name(&self) -> String {
        match self {
            Recorded::MadeUp { name, .. } => name.to_string(),
            Recorded::File(experience) => experience.name(),
        }
    }

    fn candidate(&self) -> Candidate<'_> {
        match self {
            Recorded::MadeUp {
                histogram,
                embeddings,
                ..
            } => Candidate {
                dna: histogram.view(),
                embeddings,
            },
            Recorded::File(experience) => Candidate {
                dna: experience.view(),
                embeddings: experience.embeddings(),
            },
        }
    }
}

/// Make the drives up. Ranges come from the map alone; the live drive never changes them.
fn make_up() -> Result<Vec<Recorded>, Error> {
    let mut ranges = Ranges::new(NEURONS as u32)?;
    for values in DRIVES.iter().flat_map(Drive::frames) {
        ranges.observe(&values)?;
    }
    let range = ranges.expand(1.2)?;
    let make = |drive: &Drive| {
        Ok(Recorded::MadeUp {
            name: drive.name,
            histogram: count(drive, &range)?,
            embeddings: drive
                .frames()
                .flat_map(|values| embedding(&values).to_vec())
                .collect(),
        })
    };
    DRIVES.iter().map(make).collect()
}

/// Warm up on the first frames, choose, and find the last frame in the chosen drive.
fn choose(recorded: &[Recorded]) -> Result<(), Error> {
    let candidates: Vec<Candidate> = recorded.iter().map(Recorded::candidate).collect();
    let mut selector = Selector::new(&candidates, NEURONS, WARMUP)?;
    let mut nearest = None;
    for (index, values) in NOW.frames().enumerate() {
        nearest = selector.feed(index as i64 * PERIOD_US, &values, embedding(&values))?;
    }
    let chosen = selector.chosen().expect("a choice after the warmup");
    let frame = nearest.expect("a place after the warmup");
    let name = recorded[chosen].name();
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
    let files: Vec<_> = std::env::args_os().skip(1).collect();
    let recorded: Vec<Recorded> = if files.is_empty() {
        make_up()?
    } else {
        let open = |path| Ok(Recorded::File(Experience::open(path)?));
        files.iter().map(open).collect::<Result<_, _>>()?
    };
    let views: Vec<View> = recorded.iter().map(|one| one.candidate().dna).collect();
    let live = count(&NOW, views[0].range())?;
    for (place, entry) in rank(&live, &views)?.iter().enumerate() {
        println!(
            "{}. {} is {:.17} bins away",
            place + 1,
            recorded[entry.candidate as usize].name(),
            entry.distance_bins
        );
    }
    choose(&recorded)
}
