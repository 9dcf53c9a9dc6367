//! libvdna for Rust: the C functions that `rank` needs, and a safe layer over them. Declare other
//! functions of lib/include/vdna the same way.

use std::ffi::{c_char, CStr, CString};
use std::fmt;
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::path::Path;
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

    #[repr(C)]
    pub struct Identity {
        pub backbone: [c_char; 64],
        pub model_sha256: [c_char; 65],
        pub preprocessing: [c_char; 512],
        pub precision: [c_char; 16],
        pub taps: [c_char; 2048],
        pub neurons: u32,
        pub dim: u32,
        pub bins: u32,
        pub range: *const f32,
        pub embedding: [c_char; 256],
        pub projection: *const f32,
        pub raw_dim: u32,
        pub reserved: u32,
    }

    #[repr(C)]
    pub struct Experience {
        pub name: [c_char; 64],
        pub identity: Identity,
        pub comparable: [c_char; 65],
        pub frames: u32,
        pub counts: *const u32,
        pub mass: *const u32,
        pub embeddings: *const f32,
        pub frame_utime: *const i64,
        pub frame_place: *const i64,
        pub frame_position: *const f64,
        pub frame_grey: *const f32,
        pub file_bytes: *const c_void,
        pub file_size: usize,
        pub position_frame: [c_char; 64],
        pub order: [c_char; 32],
        pub last_layer: *const i8,
        pub last_layer_scale: *const f32,
        pub last_layer_dim: u32,
        pub checksum: u32,
        pub embedding_codes: *const i8,
        pub embedding_scale: *const f32,
        pub thumbnails: *const u8,
        pub thumbnail_end: *const u32,
        pub thumbnail_bytes: u32,
        pub source: [c_char; 128],
    }

    #[repr(C)]
    pub struct ErrorText {
        pub text: [c_char; 512],
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
        pub fn vdna_experience_open(
            path: *const c_char,
            error: *mut ErrorText,
            out_experience: *mut Experience,
        ) -> i32;
        pub fn vdna_experience_close(experience: *mut Experience);
        pub fn vdna_experience_view(experience: *const Experience, out_view: *mut HistView);
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

/// What the library refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// A VDNA_ERR_ code.
    pub status: i32,
    /// For people.
    pub text: String,
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.text)
    }
}

impl std::error::Error for Error {}

fn text_of(chars: &[c_char]) -> String {
    // Sound: the library ends its texts with a NUL.
    let text = unsafe { CStr::from_ptr(chars.as_ptr()) };
    text.to_string_lossy().into_owned()
}

fn check(status: i32) -> Result<(), Error> {
    if status == 0 {
        Ok(())
    } else {
        // Sound: the result is a constant string for any status.
        let text = unsafe { CStr::from_ptr(c::vdna_status_text(status)) };
        Err(Error {
            status,
            text: text.to_string_lossy().into_owned(),
        })
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
}

/// Counts that can be compared, as long as what holds them lives.
#[derive(Clone, Copy)]
pub struct View<'a> {
    view: c::HistView,
    held: PhantomData<&'a ()>,
}

impl<'a> View<'a> {
    fn new(fill: impl FnOnce(*mut c::HistView)) -> View<'a> {
        let mut view = MaybeUninit::uninit();
        fill(view.as_mut_ptr());
        // Sound: `fill` has filled it.
        let view = unsafe { view.assume_init() };
        let held = PhantomData;
        View { view, held }
    }

    /// [neurons][2], what other histograms must be made with to be compared.
    pub fn range(&self) -> &'a [f32] {
        // Sound: the library keeps so many numbers there.
        unsafe { std::slice::from_raw_parts(self.view.range, 2 * self.view.neurons as usize) }
    }
}

impl Histogram {
    pub fn view(&self) -> View<'_> {
        View::new(|view| unsafe { c::vdna_hist_view_of(&self.hist, view) })
    }
}

/// An open experience file: one recorded drive.
pub struct Experience(Box<c::Experience>);

// Sound: nothing changes what an open file points to.
unsafe impl Send for Experience {}

impl Experience {
    /// Map a file and check every byte of it.
    pub fn open(path: impl AsRef<Path>) -> Result<Experience, Error> {
        let name = path.as_ref().as_os_str().as_encoded_bytes();
        let name = CString::new(name).expect("a path without a NUL");
        let mut error = c::ErrorText { text: [0; 512] };
        let mut opened = MaybeUninit::uninit();
        // Sound: the library fills `opened` when it succeeds.
        unsafe {
            let status = c::vdna_experience_open(name.as_ptr(), &mut error, opened.as_mut_ptr());
            if status != 0 {
                let text = text_of(&error.text);
                return Err(Error { status, text });
            }
            Ok(Experience(Box::new(opened.assume_init())))
        }
    }

    pub fn name(&self) -> String {
        text_of(&self.0.name)
    }

    /// Of all its frames.
    pub fn view(&self) -> View<'_> {
        View::new(|view| unsafe { c::vdna_experience_view(&*self.0, view) })
    }

    /// [frames][dim]
    pub fn embeddings(&self) -> &[f32] {
        let count = self.0.frames as usize * self.0.identity.dim as usize;
        // Sound: the file was checked to have so many.
        unsafe { std::slice::from_raw_parts(self.0.embeddings, count) }
    }
}

impl Drop for Experience {
    fn drop(&mut self) {
        unsafe { c::vdna_experience_close(&mut *self.0) }
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
pub fn rank(live: &Histogram, candidates: &[View]) -> Result<Vec<RankEntry>, Error> {
    let views: Vec<c::HistView> = candidates.iter().map(|candidate| candidate.view).collect();
    let mut ranking = vec![RankEntry::default(); views.len()];
    let size = unsafe { c::vdna_emd_scratch_size(live.hist.neurons) };
    let mut scratch = vec![0i64; size / 8];
    let (live, count) = (live.view().view, views.len() as u32);
    let (scratch, out) = (scratch.as_mut_ptr().cast(), ranking.as_mut_ptr());
    check(unsafe { c::vdna_rank(&live, views.as_ptr(), count, scratch, size, out) })?;
    Ok(ranking)
}

/// A recorded drive for the selector.
pub struct Candidate<'a> {
    /// Of all its frames.
    pub dna: View<'a>,
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
                    dna: candidate.dna.view,
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
