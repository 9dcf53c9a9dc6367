//! libvdna for Rust: the C functions that `rank` needs, and a safe layer over them. Other functions
//! are declared the same way, from lib/include/vdna.

use std::ffi::CStr;
use std::fmt;
use std::mem::MaybeUninit;

/// The C side, as in the headers.
mod c {
    use std::ffi::{c_char, c_void};

    #[repr(C)]
    pub struct Activations {
        pub values: *const f32,
        pub neurons: u32,
        pub samples: u32,
        pub layout: u32,
    }

    #[repr(C)]
    pub struct HistConfig {
        pub struct_size: u32,
        pub neurons: u32,
        pub bins: u32,
        pub range: *const f32,
    }

    #[repr(C)]
    pub struct Hist {
        pub range: *const f32,
        pub counts: *mut u32,
        pub mass: *mut u32,
        pub saturated: *mut u32,
        pub neurons: u32,
        pub bins: u32,
        pub frames: u32,
    }

    #[repr(C)]
    pub struct HistView {
        pub range: *const f32,
        pub counts: *const u32,
        pub mass: *const u32,
        pub neurons: u32,
        pub bins: u32,
    }

    #[link(name = "vdna")]
    extern "C" {
        pub fn vdna_status_text(status: i32) -> *const c_char;
        pub fn vdna_range_clear(range: *mut f32, neurons: u32) -> i32;
        pub fn vdna_range_observe(
            range: *mut f32,
            neurons: u32,
            taps: *const Activations,
            tap_count: usize,
        ) -> i32;
        pub fn vdna_range_expand(range: *mut f32, neurons: u32, factor: f32, rule: u32) -> i32;
        pub fn vdna_hist_config_init(config: *mut HistConfig);
        pub fn vdna_hist_mem_size(config: *const HistConfig) -> usize;
        pub fn vdna_hist_init(
            config: *const HistConfig,
            mem: *mut c_void,
            mem_size: usize,
            out_hist: *mut Hist,
        ) -> i32;
        pub fn vdna_hist_add(hist: *mut Hist, taps: *const Activations, tap_count: usize) -> i32;
        pub fn vdna_hist_view_of(hist: *const Hist, out_view: *mut HistView);
        pub fn vdna_emd_scratch_size(neurons: u32) -> usize;
        pub fn vdna_rank(
            live: *const HistView,
            candidates: *const HistView,
            count: u32,
            scratch: *mut c_void,
            scratch_size: usize,
            out_ranking: *mut super::RankEntry,
        ) -> i32;
    }
}

/// What the library refused: a VDNA_ERR_ code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Error(pub i32);

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        // Sound: a constant string for any status.
        let text = unsafe { CStr::from_ptr(c::vdna_status_text(self.0)) };
        out.write_str(&text.to_string_lossy())
    }
}

impl std::error::Error for Error {}

fn check(status: i32) -> Result<(), Error> {
    if status == 0 {
        Ok(())
    } else {
        Err(Error(status))
    }
}

/// One frame of one tap, [samples][neurons], as the library reads it; valid while `values` is.
fn tap_of(values: &[f32], neurons: u32) -> c::Activations {
    let samples = values.len() / neurons.max(1) as usize;
    assert_eq!(
        samples * neurons as usize,
        values.len(),
        "whole samples of {neurons} neurons"
    );
    c::Activations {
        values: values.as_ptr(),
        neurons,
        samples: samples as u32,
        layout: 0,
    }
}

/// The least and the greatest activation of each neuron.
pub struct Ranges {
    table: Vec<f32>,
    neurons: u32,
}

impl Ranges {
    pub fn new(neurons: u32) -> Result<Ranges, Error> {
        let mut table = vec![0.0; 2 * neurons as usize];
        check(unsafe { c::vdna_range_clear(table.as_mut_ptr(), neurons) })?;
        Ok(Ranges { table, neurons })
    }

    /// Widen the ranges to contain one frame, [samples][neurons].
    pub fn observe(&mut self, values: &[f32]) -> Result<(), Error> {
        let tap = tap_of(values, self.neurons);
        check(unsafe { c::vdna_range_observe(self.table.as_mut_ptr(), self.neurons, &tap, 1) })
    }

    /// The table to bin with, [neurons][2], widened about the midpoint.
    pub fn expand(mut self, factor: f32) -> Result<Vec<f32>, Error> {
        let table = self.table.as_mut_ptr();
        check(unsafe { c::vdna_range_expand(table, self.neurons, factor, 0) })?;
        Ok(self.table)
    }
}

/// A histogram, with the memory that the library counts in. It may be moved: its memory stays.
pub struct Histogram {
    hist: c::Hist,
    _range: Box<[f32]>,
    _memory: Box<[u32]>,
}

// Sound: the pointers in `hist` are to memory that only this histogram owns.
unsafe impl Send for Histogram {}

impl Histogram {
    /// `range` is [neurons][2] and is copied.
    pub fn new(range: &[f32], bins: u32) -> Result<Histogram, Error> {
        let range: Box<[f32]> = range.into();
        let mut hist = MaybeUninit::uninit();
        // Sound: the library fills `config` and `hist` before they are read, and both blocks are
        // as large as it is told.
        unsafe {
            let mut config = MaybeUninit::uninit();
            c::vdna_hist_config_init(config.as_mut_ptr());
            let mut config = config.assume_init();
            config.neurons = (range.len() / 2) as u32;
            config.bins = bins;
            config.range = range.as_ptr();
            let size = c::vdna_hist_mem_size(&config);
            let mut memory = vec![0u32; size / 4].into_boxed_slice();
            check(c::vdna_hist_init(
                &config,
                memory.as_mut_ptr().cast(),
                size,
                hist.as_mut_ptr(),
            ))?;
            Ok(Histogram {
                hist: hist.assume_init(),
                _range: range,
                _memory: memory,
            })
        }
    }

    /// Count one frame, [samples][neurons].
    pub fn add(&mut self, values: &[f32]) -> Result<(), Error> {
        let tap = tap_of(values, self.hist.neurons);
        check(unsafe { c::vdna_hist_add(&mut self.hist, &tap, 1) })
    }

    fn view(&self) -> c::HistView {
        let mut view = MaybeUninit::uninit();
        unsafe {
            c::vdna_hist_view_of(&self.hist, view.as_mut_ptr());
            view.assume_init()
        }
    }
}

/// One place of a ranking.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
pub struct RankEntry {
    pub distance_bins: f64,
    /// Index into the candidates.
    pub candidate: u32,
    /// 1 if a neighbour in the ranking has the very same distance.
    pub tied: u32,
}

/// Rank candidates by their distance to a live histogram, nearest first.
pub fn rank(live: &Histogram, candidates: &[Histogram]) -> Result<Vec<RankEntry>, Error> {
    let views: Vec<c::HistView> = candidates.iter().map(Histogram::view).collect();
    let mut ranking = vec![RankEntry::default(); views.len()];
    let size = unsafe { c::vdna_emd_scratch_size(live.hist.neurons) };
    let mut scratch = vec![0i64; size / 8];
    let (live, count) = (live.view(), views.len() as u32);
    let (scratch, out) = (scratch.as_mut_ptr().cast(), ranking.as_mut_ptr());
    check(unsafe { c::vdna_rank(&live, views.as_ptr(), count, scratch, size, out) })?;
    Ok(ranking)
}
