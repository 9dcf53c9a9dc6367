package example;

import com.sun.jna.IntegerType;
import com.sun.jna.Library;
import com.sun.jna.Memory;
import com.sun.jna.Native;
import com.sun.jna.Pointer;
import com.sun.jna.Structure;
import com.sun.jna.Structure.FieldOrder;
import com.sun.jna.ptr.PointerByReference;
import java.lang.ref.Reference;
import java.util.ArrayList;
import java.util.List;
import java.util.OptionalInt;

/**
 * The part of libvdna that Rank needs; declare other functions of lib/include/vdna the same way.
 *
 * <p>JNA frees memory that nothing in Java refers to, and does not see references from C. So an
 * object keeps a reference to everything the library borrows from it, and stays reachable until the
 * call returns.
 */
public final class Vdna {
    private static final C LIBRARY = Native.load("vdna", C.class);

    /** The C side, as in the headers. */
    private interface C extends Library {
        String vdna_status_text(int status);

        int vdna_range_clear(Pointer range, int neurons);

        int vdna_range_observe(Pointer range, int neurons, CActivations taps, SizeT count);

        int vdna_range_expand(Pointer range, int neurons, float factor, int rule);

        void vdna_hist_config_init(CHistConfig config);

        SizeT vdna_hist_mem_size(CHistConfig config);

        int vdna_hist_init(CHistConfig config, Pointer mem, SizeT size, CHist outHist);

        int vdna_hist_add(CHist hist, CActivations taps, SizeT count);

        void vdna_hist_view_of(CHist hist, CHistView outView);

        SizeT vdna_emd_scratch_size(int neurons);

        int vdna_rank(CHistView live, CHistView candidates, int count, Pointer scratch, SizeT size,
                      CRankEntry outRanking);

        int vdna_experience_open(String path, CError error, CExperience outExperience);

        void vdna_experience_close(CExperience experience);

        void vdna_experience_view(CExperience experience, CHistView outView);

        void vdna_select_config_init(CSelectConfig config);

        SizeT vdna_select_mem_size(CSelectConfig config);

        int vdna_select_init(CSelectConfig config, Pointer mem, SizeT size,
                             PointerByReference outSelect);

        int vdna_select_feed(Pointer select, CSelectFrame frame, CSelectAnswer outAnswer);

        int vdna_select_state(Pointer select);

        int vdna_select_chosen(Pointer select);

        double vdna_select_margin_bins(Pointer select);

        int vdna_select_window_frames(Pointer select);
    }

    public static final class SizeT extends IntegerType {
        public SizeT() {
            this(0);
        }

        public SizeT(long value) {
            super(Native.SIZE_T_SIZE, value, true);
        }
    }

    @FieldOrder({"values", "neurons", "samples", "layout"})
    public static final class CActivations extends Structure {
        public Pointer values;
        public int neurons, samples, layout;
    }

    @FieldOrder({"structSize", "neurons", "bins", "range"})
    public static final class CHistConfig extends Structure {
        public int structSize, neurons, bins;
        public Pointer range;
    }

    @FieldOrder({"range", "counts", "mass", "saturated", "neurons", "bins", "frames"})
    public static final class CHist extends Structure {
        public Pointer range, counts, mass, saturated;
        public int neurons, bins, frames;
    }

    @FieldOrder({"range", "counts", "mass", "neurons", "bins"})
    public static final class CHistView extends Structure {
        public Pointer range, counts, mass;
        public int neurons, bins;
    }

    @FieldOrder({"distanceBins", "candidate", "tied"})
    public static final class CRankEntry extends Structure {
        public double distanceBins;
        public int candidate, tied;
    }

    @FieldOrder({"text"})
    public static final class CError extends Structure {
        public byte[] text = new byte[512];
    }

    @FieldOrder({"backbone", "modelSha256", "preprocessing", "precision", "taps", "neurons", "dim",
        "bins", "range", "embedding", "projection", "rawDim", "reserved"})
    public static final class CIdentity extends Structure {
        public byte[] backbone = new byte[64], modelSha256 = new byte[65];
        public byte[] preprocessing = new byte[512], precision = new byte[16], taps = new byte[2048];
        public int neurons, dim, bins;
        public Pointer range;
        public byte[] embedding = new byte[256];
        public Pointer projection;
        public int rawDim, reserved;
    }

    @FieldOrder({"name", "identity", "comparable", "frames", "counts", "mass", "embeddings",
        "frameUtime", "framePlace", "framePosition", "frameGrey", "fileBytes", "fileSize",
        "positionFrame", "order", "lastLayer", "lastLayerScale", "lastLayerDim", "checksum",
        "embeddingCodes", "embeddingScale", "thumbnails", "thumbnailEnd", "thumbnailBytes", "source"})
    public static final class CExperience extends Structure {
        public byte[] name = new byte[64];
        public CIdentity identity;
        public byte[] comparable = new byte[65];
        public int frames;
        public Pointer counts, mass, embeddings, frameUtime, framePlace, framePosition, frameGrey;
        public Pointer fileBytes;
        public SizeT fileSize;
        public byte[] positionFrame = new byte[64], order = new byte[32];
        public Pointer lastLayer, lastLayerScale;
        public int lastLayerDim, checksum;
        public Pointer embeddingCodes, embeddingScale, thumbnails, thumbnailEnd;
        public int thumbnailBytes;
        public byte[] source = new byte[128];
    }

    @FieldOrder({"dna", "embeddings", "frames", "reserved"})
    public static final class CSelectCandidate extends Structure {
        public CHistView dna;
        public Pointer embeddings;
        public int frames, reserved;
    }

    @FieldOrder({"structSize", "candidateCount", "candidates", "dim", "warmupFrames", "warmupUs"})
    public static final class CSelectConfig extends Structure {
        public int structSize, candidateCount;
        public Pointer candidates;
        public int dim, warmupFrames;
        public long warmupUs;
    }

    @FieldOrder({"utime", "taps", "tapCount", "embedding"})
    public static final class CSelectFrame extends Structure {
        public long utime;
        public Pointer taps;
        public SizeT tapCount;
        public Pointer embedding;
    }

    @FieldOrder({"state", "newlyRanked", "restarted", "localised", "distanceSq", "index", "reserved"})
    public static final class CSelectAnswer extends Structure {
        public int state, newlyRanked, restarted, localised;
        public double distanceSq;
        public int index, reserved;
    }

    /** An error of the library; {@code status} is a VDNA_ERR_ code. */
    public static final class VdnaException extends RuntimeException {
        public final int status;

        VdnaException(int status) {
            this(status, LIBRARY.vdna_status_text(status));
        }

        VdnaException(int status, String text) {
            super(text);
            this.status = status;
        }
    }

    private static void check(int status) {
        if (status != 0) {
            throw new VdnaException(status);
        }
    }

    private static Memory copyOf(float[] values) {
        Memory memory = new Memory(4L * values.length);
        memory.write(0, values, 0, values.length);
        return memory;
    }

    /** One frame, [samples][neurons], in the library's format. */
    private static CActivations tapOf(float[] values, int neurons) {
        if (values.length == 0 || values.length % neurons != 0) {
            throw new IllegalArgumentException(
                values.length + " activations are not whole samples of " + neurons + " neurons");
        }
        CActivations tap = new CActivations();
        tap.values = copyOf(values);
        tap.neurons = neurons;
        tap.samples = values.length / neurons;
        return tap;
    }

    /** The least and the greatest activation of each neuron. */
    public static final class Ranges {
        private final int neurons;
        private final Memory table;

        public Ranges(int neurons) {
            this.neurons = neurons;
            this.table = new Memory(8L * neurons);
            check(LIBRARY.vdna_range_clear(table, neurons));
        }

        /** Widen the ranges to contain one frame, [samples][neurons]. */
        public void observe(float[] values) {
            check(LIBRARY.vdna_range_observe(table, neurons, tapOf(values, neurons), new SizeT(1)));
        }

        /** The table for histograms, [neurons][2], widened about the midpoint; call once. */
        public float[] expand(float factor) {
            check(LIBRARY.vdna_range_expand(table, neurons, factor, 0));
            return table.getFloatArray(0, 2 * neurons);
        }
    }

    /** What can be compared: a histogram or an experience. */
    public interface Dna {
        /** Fill it; it is valid as long as this object is reachable. */
        void view(CHistView out);
    }

    /** An open experience file: one recorded drive. */
    public static final class Experience implements Dna, AutoCloseable {
        private final CExperience file = new CExperience();

        /** Map a file and check every byte of it. */
        public Experience(String path) {
            CError error = new CError();
            int status = LIBRARY.vdna_experience_open(path, error, file);
            if (status != 0) {
                throw new VdnaException(status, Native.toString(error.text));
            }
        }

        public String name() {
            return Native.toString(file.name);
        }

        /** [neurons][2], what live histograms are made with. */
        public float[] range() {
            return file.identity.range.getFloatArray(0, 2 * file.identity.neurons);
        }

        /** [frames][dim], a copy. */
        public float[] embeddings() {
            return file.embeddings.getFloatArray(0, file.frames * file.identity.dim);
        }

        @Override
        public void view(CHistView out) {
            LIBRARY.vdna_experience_view(file, out);
        }

        /** Unmap the file; nothing that uses it may be used afterwards. */
        @Override
        public void close() {
            LIBRARY.vdna_experience_close(file);
        }
    }

    /** A histogram and its memory. */
    public static final class Histogram implements Dna {
        private final CHist hist = new CHist();
        private final Memory range;
        private final Memory memory;

        /** {@code range} is [neurons][2] and is copied. */
        public Histogram(float[] range, int bins) {
            this.range = copyOf(range);
            CHistConfig config = new CHistConfig();
            LIBRARY.vdna_hist_config_init(config);
            config.neurons = range.length / 2;
            config.bins = bins;
            config.range = this.range;
            SizeT size = LIBRARY.vdna_hist_mem_size(config);
            this.memory = new Memory(Math.max(1, size.longValue()));
            check(LIBRARY.vdna_hist_init(config, memory, size, hist));
        }

        @Override
        public void view(CHistView out) {
            LIBRARY.vdna_hist_view_of(hist, out);
        }

        /** Count one frame, [samples][neurons]. */
        public void add(float[] values) {
            check(LIBRARY.vdna_hist_add(hist, tapOf(values, hist.neurons), new SizeT(1)));
            Reference.reachabilityFence(this);
        }
    }

    /** One place of a ranking; {@code candidate} is an index into the candidates. */
    public record RankEntry(double distanceBins, int candidate, boolean tied) {}

    /** Rank at least one candidate by distance to a live histogram, nearest first. */
    public static List<RankEntry> rank(Dna live, List<? extends Dna> candidates) {
        CHistView liveView = new CHistView();
        live.view(liveView);
        CHistView[] views = (CHistView[]) new CHistView().toArray(candidates.size());
        for (int i = 0; i < views.length; i++) {
            candidates.get(i).view(views[i]);
        }
        CRankEntry[] places = (CRankEntry[]) new CRankEntry().toArray(candidates.size());
        SizeT size = LIBRARY.vdna_emd_scratch_size(liveView.neurons);
        Memory scratch = new Memory(size.longValue());
        check(LIBRARY.vdna_rank(liveView, views[0], views.length, scratch, size, places[0]));
        Reference.reachabilityFence(live);
        Reference.reachabilityFence(candidates);

        List<RankEntry> ranking = new ArrayList<>();
        for (CRankEntry place : places) {
            ranking.add(new RankEntry(place.distanceBins, place.candidate, place.tied != 0));
        }
        return ranking;
    }

    /** A recorded drive for the selector: the DNA of all frames, and [frames][dim] embeddings. */
    public record Candidate(Dna dna, float[] embeddings) {}

    /**
     * Warms up on the first live frames, chooses the most similar candidate, then finds every frame
     * in it.
     */
    public static final class Selector {
        private final Pointer select; // within memory
        private final Memory memory;
        private final List<Object> borrowed = new ArrayList<>();
        private final int dim;
        private final int neurons;

        /** Needs at least one candidate; embeddings are copied. */
        public Selector(List<Candidate> candidates, int dim, int warmupFrames) {
            CSelectCandidate[] structs =
                (CSelectCandidate[]) new CSelectCandidate().toArray(candidates.size());
            for (int i = 0; i < structs.length; i++) {
                Candidate candidate = candidates.get(i);
                Memory embeddings = copyOf(candidate.embeddings());
                candidate.dna().view(structs[i].dna);
                structs[i].embeddings = embeddings;
                structs[i].frames = candidate.embeddings().length / dim;
                structs[i].write();
                borrowed.addAll(List.of(structs[i], candidate.dna(), embeddings));
            }
            CSelectConfig config = new CSelectConfig();
            LIBRARY.vdna_select_config_init(config);
            config.candidates = structs[0].getPointer();
            config.candidateCount = structs.length;
            config.dim = dim;
            config.warmupFrames = warmupFrames;
            SizeT size = LIBRARY.vdna_select_mem_size(config);
            this.memory = new Memory(Math.max(1, size.longValue()));
            PointerByReference made = new PointerByReference();
            check(LIBRARY.vdna_select_init(config, memory, size, made));
            this.select = made.getValue();
            this.dim = dim;
            this.neurons = structs[0].dna.neurons;
        }

        /**
         * Take one live frame, [samples][neurons]; return the nearest frame of the chosen
         * candidate, or nothing during the warmup.
         */
        public OptionalInt feed(long utime, float[] values, float[] embedding) {
            if (embedding.length != dim) {
                throw new IllegalArgumentException("an embedding of " + embedding.length + " numbers");
            }
            CActivations tap = tapOf(values, neurons);
            tap.write();
            Memory copied = copyOf(embedding);
            CSelectFrame frame = new CSelectFrame();
            frame.utime = utime;
            frame.taps = tap.getPointer();
            frame.tapCount = new SizeT(1);
            frame.embedding = copied;
            CSelectAnswer answer = new CSelectAnswer();
            check(LIBRARY.vdna_select_feed(select, frame, answer));
            Reference.reachabilityFence(tap);
            Reference.reachabilityFence(this);
            return answer.localised != 0 ? OptionalInt.of(answer.index) : OptionalInt.empty();
        }

        /** Index of the chosen candidate, or nothing during the warmup. */
        public OptionalInt chosen() {
            boolean selected = LIBRARY.vdna_select_state(select) == 1;
            int chosen = LIBRARY.vdna_select_chosen(select);
            Reference.reachabilityFence(this);
            return selected ? OptionalInt.of(chosen) : OptionalInt.empty();
        }

        /** Distance of the second choice less that of the first, in bins. */
        public double marginBins() {
            double margin = LIBRARY.vdna_select_margin_bins(select);
            Reference.reachabilityFence(this);
            return margin;
        }

        /** Frames in the warmup window. */
        public int windowFrames() {
            int frames = LIBRARY.vdna_select_window_frames(select);
            Reference.reachabilityFence(this);
            return frames;
        }
    }

    private Vdna() {}
}
