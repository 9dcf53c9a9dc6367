//! libvdna for Rust: the C functions that `rank` needs, and a safe layer over them. Declare other
//! functions of lib/include/vdna the same way.

use std::ffi::CStr;
use std::fmt;
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ptr;

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
    #[derive(Clone, Copy)]
    pub struct HistView {
        pub range: *const f32,
        pub counts: *const u32,
        pub mass: *const u32,
        pub neurons: u32,
        pub bins: u32,
    }

    #[repr(C)]
    pub struct SelectCandidate {
        pub dna: HistView,
        pub embeddings: *const f32,
        pub frames: u32,
        pub reserved: u32,
    }

    #[repr(C)]
    pub struct SelectConfig {
        pub struct_size: u32,
        pub candidate_count: u32,
        pub candidates: *const SelectCandidate,
        pub dim: u32,
        pub warmup_frames: u32,
        pub warmup_us: i64,
    }

    #[repr(C)]
    pub struct SelectFrame {
        pub utime: i64,
        pub taps: *const Activations,
        pub tap_count: usize,
        pub embedding: *const f32,
    }

    #[repr(C)]
    pub struct KnnMatch {
        pub distance_sq: f64,
        pub index: u32,
        pub reserved: u32,
    }

    #[repr(C)]
    pub struct SelectAnswer {
        pub state: u32,
        pub newly_ranked: u32,
        pub restarted: u32,
        pub localised: u32,
        pub nearest: KnnMatch,
    }

    /// Private to the library; only pointers to it exist.
    #[repr(C)]
    pub struct Select {
        _private: [u8; 0],
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
        pub fn vdna_select_config_init(config: *mut SelectConfig);
        pub fn vdna_select_mem_size(config: *const SelectConfig) -> usize;
        pub fn vdna_select_init(
            config: *const SelectConfig,
            mem: *mut c_void,
            mem_size: usize,
            out_select: *mut *mut Select,
        ) -> i32;
        pub fn vdna_select_feed(
            select: *mut Select,
            frame: *const SelectFrame,
            out_answer: *mut SelectAnswer,
        ) -> i32;
        pub fn vdna_select_state(select: *const Select) -> u32;
        pub fn vdna_select_chosen(select: *const Select) -> u32;
        pub fn vdna_select_margin_bins(select: *const Select) -> f64;
        pub fn vdna_select_window_frames(select: *const Select) -> u32;
    }
}

/// A VDNA_ERR_ code of the library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Error(pub i32);

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        // Sound: the result is a constant string for any status.
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

/// One frame of one tap, [samples][neurons], in the library's format; valid while `values` is.
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

    /// The table for histograms, [neurons][2], widened about the midpoint.
    pub fn expand(mut self, factor: f32) -> Result<Vec<f32>, Error> {
        let table = self.table.as_mut_ptr();
        check(unsafe { c::vdna_range_expand(table, self.neurons, factor, 0) })?;
        Ok(self.table)
    }
}

/// A histogram and its memory. It may be moved: its memory stays in place.
pub struct Histogram {
    hist: c::Hist,
    _range: Box<[f32]>,
    _memory: Box<[u32]>,
}

// Sound: the pointers in `hist` refer to memory that only this histogram owns.
unsafe impl Send for Histogram {}

impl Histogram {
    /// `range` is [neurons][2] and is copied.
    pub fn new(range: &[f32], bins: u32) -> Result<Histogram, Error> {
        let range: Box<[f32]> = range.into();
        let mut hist = MaybeUninit::uninit();
        // Sound: the library fills `config` and `hist` before they are read, and both blocks have
        // the stated size.
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
    /// 1 if a neighbour in the ranking has the same distance.
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

/// A recorded drive for the selector.
pub struct Candidate<'a> {
    /// Of all its frames.
    pub histogram: &'a Histogram,
    /// [frames][dim]
    pub embeddings: &'a [f32],
}

/// Warms up on the first live frames, chooses the most similar candidate, then finds every frame in
/// it. It may be moved: the library's object has its own memory.
pub struct Selector<'a> {
    select: *mut c::Select, // within `_memory`
    dim: usize,
    neurons: u32,
    _memory: Box<[i64]>,
    _candidates: Box<[c::SelectCandidate]>,
    _borrowed: PhantomData<&'a Histogram>,
}

impl<'a> Selector<'a> {
    /// Needs at least one candidate; all embeddings have `dim` elements.
    pub fn new(candidates: &[Candidate<'a>], dim: usize, warmup: u32) -> Result<Self, Error> {
        let kept: Box<[_]> = candidates
            .iter()
            .map(|candidate| {
                assert_eq!(candidate.embeddings.len() % dim, 0, "whole embeddings");
                c::SelectCandidate {
                    dna: candidate.histogram.view(),
                    embeddings: candidate.embeddings.as_ptr(),
                    frames: (candidate.embeddings.len() / dim) as u32,
                    reserved: 0,
                }
            })
            .collect();
        // Sound: the library fills `config` before it is read, the block has the stated size, and
        // this object borrows everything that the library borrows.
        unsafe {
            let mut config = MaybeUninit::uninit();
            c::vdna_select_config_init(config.as_mut_ptr());
            let mut config = config.assume_init();
            config.candidates = kept.as_ptr();
            config.candidate_count = kept.len() as u32;
            config.dim = dim as u32;
            config.warmup_frames = warmup;
            let size = c::vdna_select_mem_size(&config);
            let mut memory = vec![0i64; size.div_ceil(8)].into_boxed_slice();
            let mut select = ptr::null_mut();
            check(c::vdna_select_init(
                &config,
                memory.as_mut_ptr().cast(),
                size,
                &mut select,
            ))?;
            Ok(Selector {
                select,
                dim,
                neurons: kept[0].dna.neurons,
                _memory: memory,
                _candidates: kept,
                _borrowed: PhantomData,
            })
        }
    }

    /// Take one live frame, [samples][neurons]. Returns the nearest frame of the chosen candidate,
    /// or None during the warmup.
    pub fn feed(
        &mut self,
        utime: i64,
        values: &[f32],
        embedding: &[f32],
    ) -> Result<Option<u32>, Error> {
        assert_eq!(embedding.len(), self.dim, "an embedding of another size");
        let tap = tap_of(values, self.neurons);
        let frame = c::SelectFrame {
            utime,
            taps: &tap,
            tap_count: 1,
            embedding: embedding.as_ptr(),
        };
        let mut answer = MaybeUninit::uninit();
        let answer = unsafe {
            check(c::vdna_select_feed(
                self.select,
                &frame,
                answer.as_mut_ptr(),
            ))?;
            answer.assume_init()
        };
        Ok((answer.localised != 0).then_some(answer.nearest.index))
    }

    /// Index of the chosen candidate; None during the warmup.
    pub fn chosen(&self) -> Option<usize> {
        let (state, chosen) = unsafe {
            (
                c::vdna_select_state(self.select),
                c::vdna_select_chosen(self.select),
            )
        };
        (state == 1).then_some(chosen as usize)
    }

    /// Distance of the second choice less that of the first, in bins.
    pub fn margin_bins(&self) -> f64 {
        unsafe { c::vdna_select_margin_bins(self.select) }
    }

    /// Frames in the warmup window.
    pub fn window_frames(&self) -> u32 {
        unsafe { c::vdna_select_window_frames(self.select) }
    }
}
