package example;

import example.Vdna.Candidate;
import example.Vdna.Experience;
import example.Vdna.Histogram;
import example.Vdna.Ranges;
import example.Vdna.RankEntry;
import example.Vdna.Selector;
import java.math.BigDecimal;
import java.math.RoundingMode;
import java.nio.FloatBuffer;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.OptionalInt;
import java.util.function.Consumer;

/**
 * rank [FILE.vdna...]: which of three drives looks most like now, and where in it are we? Same
 * program as rank.c, with the same output.
 *
 * <p>mvn compile exec:java, with -Djna.library.path=DIR if libvdna is not installed.
 */
public final class Rank {
    private static final int NEURONS = 8, SAMPLES = 4, FRAMES = 50, WARMUP = 40, BINS = 1000;
    private static final long PERIOD_US = 100_000; // of the camera

    /** A synthetic drive: its activations lie in shift..shift + 1. */
    private record Drive(String name, int seed, float shift) {
        /**
         * Pass on the activations of each frame, [samples][neurons]. Each number is the upper half
         * of x = 1664525 x + 1013904223 (mod 2^32), divided by 2^16: exact in any language.
         */
        void eachFrame(Consumer<float[]> consumer) {
            int x = seed;
            float[] values = new float[SAMPLES * NEURONS];
            for (int frame = 0; frame < FRAMES; frame++) {
                for (int i = 0; i < values.length; i++) {
                    x = x * 1664525 + 1013904223;
                    values[i] = (x >>> 16) / 65536f + shift;
                }
                consumer.accept(values);
            }
        }
    }

    private static final List<Drive> DRIVES = List.of(
        new Drive("spring", 1, 0f), new Drive("summer", 2, 0.25f), new Drive("winter", 3, 0.75f));
    private static final Drive NOW = new Drive("now", 4, 0.3125f);

    private static Histogram count(Drive drive, float[] range) {
        Histogram histogram = new Histogram(range, BINS);
        drive.eachFrame(histogram::add);
        return histogram;
    }

    /** The embedding of a frame: here just its first sample. */
    private static float[] embedding(float[] values) {
        return Arrays.copyOf(values, NEURONS);
    }

    private static float[] embeddings(Drive drive) {
        FloatBuffer all = FloatBuffer.allocate(FRAMES * NEURONS);
        drive.eachFrame(values -> all.put(embedding(values)));
        return all.array();
    }

    /** A drive to choose from, and the ranges of its counts. */
    private record Recorded(String name, Candidate candidate, float[] range) {}

    /** Make the drives up. Ranges come from the map alone; the live drive never changes them. */
    private static List<Recorded> makeUp() {
        Ranges ranges = new Ranges(NEURONS);
        DRIVES.forEach(drive -> drive.eachFrame(ranges::observe));
        float[] range = ranges.expand(1.2f);
        return DRIVES.stream()
            .map(drive -> new Recorded(drive.name(),
                new Candidate(count(drive, range), embeddings(drive)), range))
            .toList();
    }

    /** Open files, until the program ends. */
    private static Recorded open(String path) {
        Experience experience = new Experience(path);
        return new Recorded(experience.name(),
            new Candidate(experience, experience.embeddings()), experience.range());
    }

    /** Not "%.17f", which stops at the shortest digits that identify a double. */
    private static BigDecimal digits(double bins) {
        return new BigDecimal(bins).setScale(17, RoundingMode.HALF_EVEN);
    }

    /** Warm up on the first frames, choose, and find the last frame in the chosen drive. */
    private static void choose(List<Recorded> recorded) {
        List<Candidate> candidates = recorded.stream().map(Recorded::candidate).toList();
        Selector selector = new Selector(candidates, NEURONS, WARMUP);
        List<OptionalInt> nearest = new ArrayList<>();
        NOW.eachFrame(
            values -> nearest.add(selector.feed(nearest.size() * PERIOD_US, values, embedding(values))));
        String name = recorded.get(selector.chosen().getAsInt()).name();
        System.out.printf("live: %s after %d frames, by %s bins%n", name, selector.windowFrames(),
            digits(selector.marginBins()));
        System.out.printf("now is nearest to frame %d of %s%n",
            nearest.get(FRAMES - 1).getAsInt(), name);
    }

    public static void main(String[] arguments) {
        List<Recorded> recorded =
            arguments.length == 0 ? makeUp() : Arrays.stream(arguments).map(Rank::open).toList();
        Histogram live = count(NOW, recorded.get(0).range());
        int place = 1;
        for (RankEntry entry :
            Vdna.rank(live, recorded.stream().map(one -> one.candidate().dna()).toList())) {
            String name = recorded.get(entry.candidate()).name();
            System.out.printf(
                "%d. %s is %s bins away%n", place++, name, digits(entry.distanceBins()));
        }
        choose(recorded);
    }
}
