/* first: which of two recorded drives looks most like now? */
#include <stdio.h>

#include <vdna/vdna.h>

enum { NEURONS = 2, SAMPLES = 3, BINS = 10, DRIVES = 3 };

static const char *const name[DRIVES] = {"now", "summer", "winter"};

/* What a network gave for a frame of each drive, [samples][neurons]. */
static const float activations[DRIVES][SAMPLES * NEURONS] = {
    {0.15f, 0.95f, 0.25f, 0.85f, 0.15f, 0.75f},
    {0.85f, 0.15f, 0.95f, 0.25f, 0.75f, 0.15f},
    {0.25f, 0.85f, 0.35f, 0.95f, 0.15f, 0.65f}};
static const float range[NEURONS * 2] = {0, 1, 0, 1}; /* of each neuron */

int main(void)
{
    static uint32_t memory[DRIVES][NEURONS * (BINS + 2)];
    static int64_t scratch[64];
    vdna_hist hist[DRIVES];
    vdna_hist_view dna[DRIVES];
    vdna_rank_entry ranking[DRIVES - 1];

    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = NEURONS;
    config.bins = BINS;
    config.range = range;
    for (int d = 0; d < DRIVES; d++) {
        const vdna_activations frame = {activations[d], NEURONS, SAMPLES,
                                        VDNA_LAYOUT_SAMPLES_NEURONS};
        if (vdna_hist_init(&config, memory[d], sizeof memory[d], &hist[d]) != VDNA_OK ||
            vdna_hist_add(&hist[d], &frame, 1) != VDNA_OK) /* and so on for all frames */
            return 1;
        vdna_hist_view_of(&hist[d], &dna[d]);
    }
    if (vdna_rank(&dna[0], &dna[1], DRIVES - 1, scratch, sizeof scratch, ranking) != VDNA_OK)
        return 1;
    for (int i = 0; i < DRIVES - 1; i++)
        printf("%s is %.2f bins away\n", name[1 + ranking[i].candidate], ranking[i].distance_bins);
    return 0;
}
