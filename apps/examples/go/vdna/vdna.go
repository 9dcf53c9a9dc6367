// Package vdna wraps the part of libvdna that rank needs; other functions are called the same way.
// Data that the library keeps (ranges, counts) is in C memory, because C may not keep Go pointers.
package vdna

/*
#cgo LDFLAGS: -lvdna
#include <stdlib.h>
#include <string.h>
#include <vdna/map.h>
#include <vdna/vdna.h>
*/
import "C"

import (
	"errors"
	"fmt"
	"runtime"
	"unsafe"
)

// Error is a VDNA_ERR_ code of the library.
type Error int32

func (e Error) Error() string {
	return C.GoString(C.vdna_status_text(C.vdna_status(e)))
}

func check(status C.vdna_status) error {
	if status == C.VDNA_OK {
		return nil
	}
	return Error(status)
}

// withTap calls f with one frame, [samples][neurons], in the library's format.
func withTap(values []float32, neurons int, f func(tap *C.vdna_activations) C.vdna_status) error {
	if len(values) == 0 || len(values)%neurons != 0 {
		return fmt.Errorf("%d activations are not whole samples of %d neurons", len(values), neurons)
	}
	var pin runtime.Pinner
	defer pin.Unpin()
	pin.Pin(&values[0])
	tap := C.vdna_activations{
		values:  (*C.float)(&values[0]),
		neurons: C.uint32_t(neurons),
		samples: C.uint32_t(len(values) / neurons),
		layout:  C.VDNA_LAYOUT_SAMPLES_NEURONS,
	}
	return check(f(&tap))
}

// Ranges is the table [neurons][2] of the least and the greatest activation of each neuron.
type Ranges []float32

// NewRanges makes an empty table; neurons is at least 1.
func NewRanges(neurons int) Ranges {
	table := make(Ranges, 2*neurons)
	C.vdna_range_clear(table.c(), table.neurons())
	return table
}

func (r Ranges) c() *C.float         { return (*C.float)(&r[0]) }
func (r Ranges) neurons() C.uint32_t { return C.uint32_t(len(r) / 2) }

// Observe widens the ranges to contain one frame, [samples][neurons].
func (r Ranges) Observe(values []float32) error {
	return withTap(values, len(r)/2, func(tap *C.vdna_activations) C.vdna_status {
		return C.vdna_range_observe(r.c(), r.neurons(), tap, 1)
	})
}

// Expand widens the ranges about their midpoints; use the result for histograms.
func (r Ranges) Expand(factor float32) error {
	rule := C.uint32_t(C.VDNA_RANGE_ABOUT_MIDPOINT)
	return check(C.vdna_range_expand(r.c(), r.neurons(), C.float(factor), rule))
}

// Histogram counts frames. Close frees its memory.
type Histogram struct {
	hist   C.vdna_hist
	memory unsafe.Pointer
}

// NewHistogram makes an empty histogram; the ranges are copied.
func NewHistogram(ranges Ranges, bins int) (*Histogram, error) {
	var config C.vdna_hist_config
	C.vdna_hist_config_init(&config)
	config.neurons = ranges.neurons()
	config.bins = C.uint32_t(bins)
	// One block: the counts, then the ranges.
	size := C.vdna_hist_mem_size(&config)
	rangeSize := C.size_t(len(ranges) * 4)
	h := &Histogram{memory: C.malloc(size + rangeSize)}
	config._range = (*C.float)(unsafe.Add(h.memory, size))
	C.memcpy(unsafe.Pointer(config._range), unsafe.Pointer(&ranges[0]), rangeSize)
	if err := check(C.vdna_hist_init(&config, h.memory, size, &h.hist)); err != nil {
		h.Close()
		return nil, err
	}
	return h, nil
}

// Close frees the memory; do not use the histogram afterwards.
func (h *Histogram) Close() {
	C.free(h.memory)
	*h = Histogram{}
}

// Add counts one frame, [samples][neurons].
func (h *Histogram) Add(values []float32) error {
	return withTap(values, int(h.hist.neurons), func(tap *C.vdna_activations) C.vdna_status {
		return C.vdna_hist_add(&h.hist, tap, 1)
	})
}

// DNA is what can be compared: a *Histogram or an *Experience.
type DNA interface {
	view() C.vdna_hist_view
}

// Experience is an open file: one recorded drive. Close unmaps it.
type Experience struct {
	file *C.vdna_experience // in C memory
}

// Open maps an experience file and checks every byte of it.
func Open(path string) (*Experience, error) {
	name := C.CString(path)
	defer C.free(unsafe.Pointer(name))
	e := &Experience{(*C.vdna_experience)(C.calloc(1, C.sizeof_vdna_experience))}
	var reason C.vdna_error
	if C.vdna_experience_open(name, &reason, e.file) != C.VDNA_OK {
		e.Close()
		return nil, errors.New(C.GoString(&reason.text[0]))
	}
	return e, nil
}

// Close unmaps the file; do not use the experience or its slices afterwards.
func (e *Experience) Close() {
	C.vdna_experience_close(e.file)
	C.free(unsafe.Pointer(e.file))
	*e = Experience{}
}

func (e *Experience) view() (view C.vdna_hist_view) {
	C.vdna_experience_view(e.file, &view)
	return view
}

// Name of the drive.
func (e *Experience) Name() string { return C.GoString(&e.file.name[0]) }

// Ranges are those of its counts, [neurons][2]; live histograms are made with them.
func (e *Experience) Ranges() Ranges {
	view := e.view()
	return unsafe.Slice((*float32)(view._range), 2*view.neurons)
}

// Embeddings has one for each frame.
func (e *Experience) Embeddings() [][]float32 {
	dim := int(e.file.identity.dim)
	all := unsafe.Slice((*float32)(e.file.embeddings), int(e.file.frames)*dim)
	embeddings := make([][]float32, e.file.frames)
	for f := range embeddings {
		embeddings[f] = all[f*dim : (f+1)*dim]
	}
	return embeddings
}

func (h *Histogram) view() (view C.vdna_hist_view) {
	C.vdna_hist_view_of(&h.hist, &view)
	return view
}

// RankEntry is one place of a ranking.
type RankEntry struct {
	DistanceBins float64
	Candidate    int  // index into the candidates
	Tied         bool // a neighbour in the ranking has the same distance
}

// Rank orders at least one candidate by distance to a live histogram, nearest first.
func Rank(live DNA, candidates []DNA) ([]RankEntry, error) {
	views := make([]C.vdna_hist_view, len(candidates))
	for i, candidate := range candidates {
		views[i] = candidate.view()
	}
	liveView := live.view()
	size := C.vdna_emd_scratch_size(liveView.neurons)
	scratch := make([]int64, size/8)
	places := make([]C.vdna_rank_entry, len(candidates))
	err := check(C.vdna_rank(&liveView, &views[0], C.uint32_t(len(views)),
		unsafe.Pointer(&scratch[0]), size, &places[0]))
	if err != nil {
		return nil, err
	}
	ranking := make([]RankEntry, len(places))
	for i, p := range places {
		ranking[i] = RankEntry{float64(p.distance_bins), int(p.candidate), p.tied != 0}
	}
	return ranking, nil
}

// Candidate is a recorded drive for the selector.
type Candidate struct {
	DNA        DNA         // of all its frames
	Embeddings [][]float32 // one for each frame, all of one length
}

// Selector warms up on the first live frames, chooses the most similar candidate, then finds every
// frame in it. Close frees its memory; call it before closing what has their DNA.
type Selector struct {
	choice  *C.vdna_select // within memory
	memory  unsafe.Pointer
	kept    []unsafe.Pointer // candidates and their embeddings, in C memory
	dim     int
	neurons int
}

// NewSelector makes a selector among at least one candidate; embeddings are copied.
func NewSelector(candidates []Candidate, warmupFrames int) (*Selector, error) {
	count := len(candidates)
	array := C.malloc(C.size_t(count) * C.sizeof_vdna_select_candidate)
	s := &Selector{
		kept:    []unsafe.Pointer{array},
		dim:     len(candidates[0].Embeddings[0]),
		neurons: int(candidates[0].DNA.view().neurons),
	}
	structs := unsafe.Slice((*C.vdna_select_candidate)(array), count)
	for i, candidate := range candidates {
		frames := len(candidate.Embeddings)
		copied := C.malloc(C.size_t(frames * s.dim * 4))
		s.kept = append(s.kept, copied)
		for f, embedding := range candidate.Embeddings {
			copy(unsafe.Slice((*float32)(copied), frames*s.dim)[f*s.dim:], embedding)
		}
		structs[i] = C.vdna_select_candidate{
			dna:        candidate.DNA.view(),
			embeddings: (*C.float)(copied),
			frames:     C.uint32_t(frames),
		}
	}

	var config C.vdna_select_config
	C.vdna_select_config_init(&config)
	config.candidates = (*C.vdna_select_candidate)(array)
	config.candidate_count = C.uint32_t(count)
	config.dim = C.uint32_t(s.dim)
	config.warmup_frames = C.uint32_t(warmupFrames)
	size := C.vdna_select_mem_size(&config)
	s.memory = C.malloc(size + 1)
	if err := check(C.vdna_select_init(&config, s.memory, size, &s.choice)); err != nil {
		s.Close()
		return nil, err
	}
	return s, nil
}

// Close frees the memory; do not use the selector afterwards.
func (s *Selector) Close() {
	C.free(s.memory)
	for _, kept := range s.kept {
		C.free(kept)
	}
	*s = Selector{}
}

// Feed takes one live frame, [samples][neurons]. It returns the nearest frame of the chosen
// candidate, or -1 during the warmup.
func (s *Selector) Feed(utime int64, values, embedding []float32) (int, error) {
	if len(embedding) != s.dim {
		return -1, fmt.Errorf("an embedding of %d numbers, expected %d", len(embedding), s.dim)
	}
	var pin runtime.Pinner
	defer pin.Unpin()
	pin.Pin(&embedding[0])
	var answer C.vdna_select_answer
	err := withTap(values, s.neurons, func(tap *C.vdna_activations) C.vdna_status {
		pin.Pin(tap)
		frame := C.vdna_select_frame{
			utime:     C.int64_t(utime),
			taps:      tap,
			tap_count: 1,
			embedding: (*C.float)(&embedding[0]),
		}
		return C.vdna_select_feed(s.choice, &frame, &answer)
	})
	if err != nil || answer.localised == 0 {
		return -1, err
	}
	return int(answer.match.index), nil
}

// Chosen is the index of the chosen candidate, or -1 during the warmup.
func (s *Selector) Chosen() int {
	if C.vdna_select_state(s.choice) != C.VDNA_SELECT_SELECTED {
		return -1
	}
	return int(C.vdna_select_chosen(s.choice))
}

// MarginBins is the distance of the second choice less that of the first.
func (s *Selector) MarginBins() float64 { return float64(C.vdna_select_margin_bins(s.choice)) }

// WindowFrames is the number of frames in the warmup window.
func (s *Selector) WindowFrames() int { return int(C.vdna_select_window_frames(s.choice)) }
