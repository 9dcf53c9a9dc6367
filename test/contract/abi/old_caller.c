/* A program that was compiled with the headers of version 0.1, and is linked with the libvdna.so of
 * today: its config structs lack what has been added since, so it must get the defaults of that,
 * and nothing may be written beyond them.
 *
 * The structs are those of commit e946394, to the letter but for comments. Never bring them up to
 * date: that they are old is what this program is for. */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vdna/activation.h>

typedef struct vdna_hist_config {
    uint32_t struct_size;
    uint32_t neurons;
    uint32_t bins;
    const float *range;
} vdna_hist_config;

typedef struct vdna_window_config {
    uint32_t struct_size;
    uint32_t capacity;
    int64_t length_us;
    const vdna_activations *taps;
    size_t tap_count;
    const float *range;
    uint32_t bins;
} vdna_window_config;

typedef struct vdna_hist_view {
    const float *range;
    const uint32_t *counts;
    const uint32_t *mass;
    uint32_t neurons;
    uint32_t bins;
} vdna_hist_view;

typedef struct vdna_select_candidate {
    vdna_hist_view dna;
    const float *embeddings;
    uint32_t frames;
    uint32_t reserved;
} vdna_select_candidate;

typedef struct vdna_select_config {
    uint32_t struct_size;
    uint32_t candidate_count;
    const vdna_select_candidate *candidates;
    uint32_t dim;
    uint32_t warmup_frames;
    int64_t warmup_us;
} vdna_select_config;

/* What it calls. */
typedef struct vdna_hist {
    const float *range;
    uint32_t *counts;
    uint32_t *mass;
    uint32_t *saturated;
    uint32_t neurons;
    uint32_t bins;
    uint32_t frames;
} vdna_hist;
typedef struct vdna_window vdna_window;
typedef struct vdna_select vdna_select;
VDNA_API void vdna_hist_config_init(vdna_hist_config *config);
VDNA_API size_t vdna_hist_mem_size(const vdna_hist_config *config);
VDNA_API vdna_status vdna_hist_init(const vdna_hist_config *config, void *mem, size_t mem_size,
                                    vdna_hist *out_hist);
VDNA_API void vdna_window_config_init(vdna_window_config *config);
VDNA_API size_t vdna_window_mem_size(const vdna_window_config *config);
VDNA_API vdna_status vdna_window_init(const vdna_window_config *config, void *mem, size_t mem_size,
                                      vdna_window **out_window);
VDNA_API vdna_status vdna_window_add(vdna_window *window, int64_t utime,
                                     const vdna_activations *taps, size_t tap_count,
                                     uint32_t *out_events);
VDNA_API const vdna_hist *vdna_window_hist(const vdna_window *window);
VDNA_API void vdna_select_config_init(vdna_select_config *config);
VDNA_API size_t vdna_select_mem_size(const vdna_select_config *config);
VDNA_API vdna_status vdna_select_init(const vdna_select_config *config, void *mem, size_t mem_size,
                                      vdna_select **out_select);

/* One neuron over 0..4, four bins. */
enum { BINS = 4 };
static const float range[] = {0, 4};

static void require(int condition, const char *what)
{
    if (condition)
        return;
    fprintf(stderr, "old_caller: %s\n", what);
    exit(1);
}

/* Memory around a config: what the caller has there, which the library must neither write nor read.
 */
#define AROUND(type)              \
    struct {                      \
        type config;              \
        unsigned char beyond[64]; \
    }

static void require_untouched(const unsigned char beyond[64], const char *what)
{
    for (size_t i = 0; i < 64; i++)
        require(beyond[i] == 0xAA, what);
}

static void make_a_histogram(void)
{
    AROUND(vdna_hist_config) h;
    memset(&h, 0xAA, sizeof h);
    vdna_hist_config_init(&h.config);
    require_untouched(h.beyond, "vdna_hist_config_init() wrote beyond the struct");
    require(h.config.struct_size == sizeof h.config, "vdna_hist_config: struct_size");
    require(h.config.bins == 1000, "vdna_hist_config: the default of bins");
    h.config.neurons = 1;
    h.config.bins = BINS;
    h.config.range = range;
    uint32_t mem[BINS + 2];
    vdna_hist hist;
    require(vdna_hist_mem_size(&h.config) == sizeof mem, "vdna_hist_mem_size()");
    require(vdna_hist_init(&h.config, mem, sizeof mem, &hist) == VDNA_OK, "vdna_hist_init()");
}

/* A window slides, as all did: it must not become one of the first frames. */
static void slide_a_window(void)
{
    const float value = 1.5f;
    const vdna_activations tap = {&value, 1, 1, VDNA_LAYOUT_SAMPLES_NEURONS};
    AROUND(vdna_window_config) w;
    memset(&w, 0xAA, sizeof w);
    vdna_window_config_init(&w.config);
    require_untouched(w.beyond, "vdna_window_config_init() wrote beyond the struct");
    require(w.config.struct_size == sizeof w.config, "vdna_window_config: struct_size");
    w.config.capacity = 2;
    w.config.taps = &tap;
    w.config.tap_count = 1;
    w.config.range = range;
    w.config.bins = BINS;
    /* Padding within the struct holds anything as well. */
    const size_t end = offsetof(vdna_window_config, bins) + sizeof w.config.bins;
    memset((unsigned char *)&w.config + end, 0x55, sizeof w.config - end);

    const size_t size = vdna_window_mem_size(&w.config);
    require(size > 0, "vdna_window_mem_size()");
    vdna_window *window;
    require(vdna_window_init(&w.config, malloc(size), size, &window) == VDNA_OK,
            "vdna_window_init()");
    for (int64_t utime = 0; utime < 10; utime++) {
        uint32_t events = 77;
        require(vdna_window_add(window, utime, &tap, 1, &events) == VDNA_OK && events == 1,
                "a frame was not added to the window");
    }
    require(vdna_window_hist(window)->frames == 2, "the window does not slide");
    free(window);
}

static void make_a_selector(void)
{
    static const uint32_t counts[BINS] = {1, 0, 2, 0}, mass = 3;
    static const float embedding = 0;
    const vdna_select_candidate only = {{range, counts, &mass, 1, BINS}, &embedding, 1, 0};
    AROUND(vdna_select_config) s;
    memset(&s, 0xAA, sizeof s);
    vdna_select_config_init(&s.config);
    require_untouched(s.beyond, "vdna_select_config_init() wrote beyond the struct");
    require(s.config.struct_size == sizeof s.config, "vdna_select_config: struct_size");
    s.config.candidates = &only;
    s.config.candidate_count = 1;
    s.config.dim = 1;
    s.config.warmup_frames = 1;
    const size_t size = vdna_select_mem_size(&s.config);
    require(size > 0, "vdna_select_mem_size()");
    vdna_select *select;
    require(vdna_select_init(&s.config, malloc(size), size, &select) == VDNA_OK,
            "vdna_select_init()");
    free(select);
}

int main(void)
{
    make_a_histogram();
    slide_a_window();
    make_a_selector();
    return 0;
}
