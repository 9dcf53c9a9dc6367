// Package vdna is libvdna for Go, as far as rank needs it; other functions are called the same way.
//
// What the library keeps (ranges, counts) lies in C memory, because C may not keep Go pointers.
package vdna

/*
#cgo LDFLAGS: -lvdna
#include <stdlib.h>
#include <string.h>
#include <vdna/vdna.h>
*/
import "C"

import (
	"fmt"
	"runtime"
	"unsafe"
)

// Error is what the library refused: a VDNA_ERR_ code.
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

// withTap calls f with one frame, [samples][neurons], as the library reads it.
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

// NewRanges makes a table that has seen nothing yet; neurons is at least 1.
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

// Expand makes it the table to bin with, widened about the midpoint.
func (r Ranges) Expand(factor float32) error {
	rule := C.uint32_t(C.VDNA_RANGE_ABOUT_MIDPOINT)
	return check(C.vdna_range_expand(r.c(), r.neurons(), C.float(factor), rule))
}

// Histogram counts frames. Its memory is given back by Close.
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

// Close gives the memory back; the histogram cannot be used any more.
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

func (h *Histogram) view() (view C.vdna_hist_view) {
	C.vdna_hist_view_of(&h.hist, &view)
	return view
}

// RankEntry is one place of a ranking.
type RankEntry struct {
	DistanceBins float64
	Candidate    int  // index into the candidates
	Tied         bool // a neighbour in the ranking has the very same distance
}

// Rank orders at least one candidate by distance to a live histogram, nearest first.
func Rank(live *Histogram, candidates []*Histogram) ([]RankEntry, error) {
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
