/* A user's program: ranks three candidates and feeds a selector, with made-up activations, and
 * prints all bits of what comes out. */
#include <stdio.h>
#include <stdlib.h>

#include <vdna/vdna.h>

enum { NEURONS = 24, FRAMES = 40, CANDIDATES = 3 };

static float range[NEURONS][2];
static float frames[CANDIDATES + 1][FRAMES][NEURONS];

static void require(vdna_status status)
{
    if (status != VDNA_OK) {
        fprintf(stderr, "%s\n", vdna_status_text(status));
        exit(1);
    }
}

/* The same numbers everywhere: a generator of the textbook's, and a drift per experience. */
static void make_up_activations(void)
{
    uint32_t state = 1;
    for (int e = 0; e <= CANDIDATES; e++)
        for (int f = 0; f < FRAMES; f++)
            for (int n = 0; n < NEURONS; n++) {
                state = state * 1664525u + 1013904223u;
                frames[e][f][n] = (float)(state >> 8) / 16777216.0f + 0.125f * (float)e;
            }
}

static vdna_activations taps_of(int experience, int frame)
{
    const vdna_activations taps = {frames[experience][frame], NEURONS, 1,
                                   VDNA_LAYOUT_SAMPLES_NEURONS};
    return taps;
}

static vdna_hist_view histogram_of(int experience)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.range = range[0];
    const size_t size = vdna_hist_mem_size(&config);
    vdna_hist hist;
    require(vdna_hist_init(&config, malloc(size), size, &hist));
    for (int f = 0; f < FRAMES; f++) {
        const vdna_activations taps = taps_of(experience, f);
        require(vdna_hist_add(&hist, &taps, 1));
    }
    vdna_hist_view view;
    vdna_hist_view_of(&hist, &view);
    return view;
}

int main(void)
{
    make_up_activations();
    require(vdna_range_clear(range[0], NEURONS));
    for (int e = 1; e <= CANDIDATES; e++)
        for (int f = 0; f < FRAMES; f++) {
            const vdna_activations taps = taps_of(e, f);
            require(vdna_range_observe(range[0], NEURONS, &taps, 1));
        }
    require(vdna_range_expand(range[0], NEURONS, VDNA_RANGE_FACTOR, VDNA_RANGE_ABOUT_MIDPOINT));

    vdna_select_candidate candidates[CANDIDATES] = {{{0}, NULL, 0, 0}};
    vdna_hist_view dna[CANDIDATES];
    for (int e = 0; e < CANDIDATES; e++) {
        dna[e] = histogram_of(1 + e);
        candidates[e].dna = dna[e];
        candidates[e].embeddings = frames[1 + e][0];
        candidates[e].frames = FRAMES;
    }

    const vdna_hist_view live = histogram_of(0);
    vdna_rank_entry ranking[CANDIDATES];
    const size_t scratch_size = vdna_emd_scratch_size(NEURONS);
    require(vdna_rank(&live, dna, CANDIDATES, malloc(scratch_size), scratch_size, ranking));
    printf("vdna %s\n", vdna_version());
    for (int i = 0; i < CANDIDATES; i++)
        printf("candidate %u at %a bins\n", ranking[i].candidate, ranking[i].distance_bins);

    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = CANDIDATES;
    config.dim = NEURONS;
    config.warmup_frames = FRAMES / 2;
    const size_t size = vdna_select_mem_size(&config);
    vdna_select *select;
    require(vdna_select_init(&config, malloc(size), size, &select));
    for (int f = 0; f < FRAMES; f++) {
        const vdna_activations taps = taps_of(0, f);
        const vdna_select_frame frame = {f, &taps, 1, frames[0][f]};
        vdna_select_answer answer;
        require(vdna_select_feed(select, &frame, &answer));
        if (answer.localised)
            printf("frame %d at %u, %a\n", f, answer.match.index, answer.match.distance_sq);
    }
    return 0;
}
