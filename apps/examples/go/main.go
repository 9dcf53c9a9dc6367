// rank [FILE.vdna...]: which of three drives looks most like now, and where in it are we? Same program
// as ../rank.c, with the same output.
//
//	go run .    # libvdna not installed: with CGO_CFLAGS=-I..., CGO_LDFLAGS=-L..., LD_LIBRARY_PATH
package main

import (
	"fmt"
	"log"
	"os"

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
	drives = []drive{{"spring", 1, 0}, {"summer", 2, 0.25}, {"winter", 3, 0.75}}
	now    = drive{"now", 4, 0.3125}
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

// recorded is a set of drives to choose from: made up here, or opened from files.
type recorded struct {
	names      []string
	ranges     vdna.Ranges
	candidates []vdna.Candidate
	close      []func()
}

func (r *recorded) add(name string, candidate vdna.Candidate, close func()) {
	r.names = append(r.names, name)
	r.candidates = append(r.candidates, candidate)
	r.close = append(r.close, close)
}

// makeUp makes the drives up. Ranges come from the map alone; the live drive never changes them.
func (r *recorded) makeUp() error {
	r.ranges = vdna.NewRanges(neurons)
	for _, d := range drives {
		if err := d.eachFrame(r.ranges.Observe); err != nil {
			return err
		}
	}
	if err := r.ranges.Expand(1.2); err != nil {
		return err
	}
	for _, d := range drives {
		histogram, err := count(d, r.ranges)
		if err != nil {
			return err
		}
		candidate := vdna.Candidate{DNA: histogram}
		d.eachFrame(func(values []float32) error {
			candidate.Embeddings = append(candidate.Embeddings, embedding(values))
			return nil
		})
		r.add(d.name, candidate, histogram.Close)
	}
	return nil
}

func (r *recorded) open(paths []string) error {
	for _, path := range paths {
		experience, err := vdna.Open(path)
		if err != nil {
			return err
		}
		r.ranges = experience.Ranges() // of all of them: they compare
		candidate := vdna.Candidate{DNA: experience, Embeddings: experience.Embeddings()}
		r.add(experience.Name(), candidate, experience.Close)
	}
	return nil
}

// choose warms up on the first frames, chooses, and finds the last frame in the chosen drive.
func (r *recorded) choose() error {
	selector, err := vdna.NewSelector(r.candidates, warmup)
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
	name := r.names[selector.Chosen()]
	fmt.Printf("live: %s after %d frames, by %.17f bins\n",
		name, selector.WindowFrames(), selector.MarginBins())
	fmt.Printf("now is nearest to frame %d of %s\n", nearest, name)
	return nil
}

func (r *recorded) rank() error {
	live, err := count(now, r.ranges)
	if err != nil {
		return err
	}
	defer live.Close()
	dna := make([]vdna.DNA, len(r.candidates))
	for i, candidate := range r.candidates {
		dna[i] = candidate.DNA
	}
	ranking, err := vdna.Rank(live, dna)
	if err != nil {
		return err
	}
	for place, entry := range ranking {
		fmt.Printf("%d. %s is %.17f bins away\n", place+1, r.names[entry.Candidate], entry.DistanceBins)
	}
	return nil
}

func run(paths []string) (err error) {
	var r recorded
	defer func() {
		for _, close := range r.close {
			close()
		}
	}()
	if len(paths) > 0 {
		err = r.open(paths)
	} else {
		err = r.makeUp()
	}
	if err == nil {
		err = r.rank()
	}
	if err == nil {
		err = r.choose()
	}
	return err
}

func main() {
	if err := run(os.Args[1:]); err != nil {
		log.Fatal("rank: ", err)
	}
}
