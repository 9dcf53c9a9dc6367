// rank: which of three drives looks most like now, and where in it are we? Same program as
// ../rank.c, with the same output.
//
//	go run .    # libvdna not installed: with CGO_CFLAGS=-I..., CGO_LDFLAGS=-L..., LD_LIBRARY_PATH
package main

import (
	"fmt"
	"log"

	"example/rank/vdna"
)

const (
	neurons  = 8
	samples  = 4
	frames   = 50
	warmup   = 40
	bins     = 1000
	periodUs = int64(100000) // of the camera
)

// drive is synthetic: its activations lie in shift..shift + 1.
type drive struct {
	name  string
	seed  uint32
	shift float32
}

var (
	candidates = []drive{{"spring", 1, 0}, {"summer", 2, 0.25}, {"winter", 3, 0.75}}
	now        = drive{"now", 4, 0.3125}
)

// eachFrame calls f with the activations of each frame, [samples][neurons]. Each number is the
// upper half of x = 1664525 x + 1013904223 (mod 2^32), divided by 2^16: exact in any language.
func (d drive) eachFrame(f func(values []float32) error) error {
	x := d.seed
	values := make([]float32, samples*neurons)
	for frame := 0; frame < frames; frame++ {
		for i := range values {
			x = x*1664525 + 1013904223
			values[i] = float32(x>>16)/65536 + d.shift
		}
		if err := f(values); err != nil {
			return err
		}
	}
	return nil
}

func count(d drive, ranges vdna.Ranges) (*vdna.Histogram, error) {
	histogram, err := vdna.NewHistogram(ranges, bins)
	if err != nil {
		return nil, err
	}
	return histogram, d.eachFrame(histogram.Add)
}

// embedding of a frame: here just its first sample.
func embedding(values []float32) []float32 { return append([]float32{}, values[:neurons]...) }

// choose warms up on the first frames, chooses, and finds the last frame in the chosen drive.
func choose(histograms []*vdna.Histogram) error {
	experiences := make([]vdna.Candidate, len(candidates))
	for i, d := range candidates {
		experiences[i].Histogram = histograms[i]
		d.eachFrame(func(values []float32) error {
			experiences[i].Embeddings = append(experiences[i].Embeddings, embedding(values))
			return nil
		})
	}
	selector, err := vdna.NewSelector(experiences, warmup)
	if err != nil {
		return err
	}
	defer selector.Close()
	nearest, utime := -1, int64(0)
	err = now.eachFrame(func(values []float32) (err error) {
		nearest, err = selector.Feed(utime, values, embedding(values))
		utime += periodUs
		return err
	})
	if err != nil {
		return err
	}
	name := candidates[selector.Chosen()].name
	fmt.Printf("live: %s after %d frames, by %.17f bins\n",
		name, selector.WindowFrames(), selector.MarginBins())
	fmt.Printf("now is nearest to frame %d of %s\n", nearest, name)
	return nil
}

func run() error {
	// Ranges come from the map alone; the live drive never changes them.
	ranges := vdna.NewRanges(neurons)
	for _, d := range candidates {
		if err := d.eachFrame(ranges.Observe); err != nil {
			return err
		}
	}
	if err := ranges.Expand(1.2); err != nil {
		return err
	}

	live, err := count(now, ranges)
	if err != nil {
		return err
	}
	defer live.Close()
	histograms := make([]*vdna.Histogram, len(candidates))
	for i, d := range candidates {
		if histograms[i], err = count(d, ranges); err != nil {
			return err
		}
		defer histograms[i].Close()
	}

	ranking, err := vdna.Rank(live, histograms)
	if err != nil {
		return err
	}
	for place, entry := range ranking {
		name := candidates[entry.Candidate].name
		fmt.Printf("%d. %s is %.17f bins away\n", place+1, name, entry.DistanceBins)
	}
	return choose(histograms)
}

func main() {
	if err := run(); err != nil {
		log.Fatal("rank: ", err)
	}
}
