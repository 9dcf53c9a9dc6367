/* Prints the memory that the library asks of its caller: first the bytes that one more experience
 * adds to a selector; then, a configuration a line, neurons, bins, and the bytes of a histogram, of
 * the distance's working memory, and of a selector among CANDIDATES experiences. */
#include <stdio.h>
#include <string.h>

#include <vdna/vdna.h>

enum { CANDIDATES = 4, NEURONS_MOST = 1280 };

static float range[2 * NEURONS_MOST];

static size_t hist_size(uint32_t neurons, uint32_t bins)
{
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = neurons;
    config.bins = bins;
    config.range = range;
    return vdna_hist_mem_size(&config);
}

static size_t select_size(uint32_t neurons, uint32_t bins, uint32_t count)
{
    static const float embedding = 0;
    vdna_select_candidate candidates[CANDIDATES + 1];
    memset(candidates, 0, sizeof candidates);
    for (uint32_t i = 0; i < count; i++) {
        candidates[i].dna.range = range;
        candidates[i].dna.neurons = neurons;
        candidates[i].dna.bins = bins;
        candidates[i].embeddings = &embedding;
        candidates[i].frames = 1;
    }
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = count;
    config.dim = 1;
    config.warmup_frames = 1;
    return vdna_select_mem_size(&config);
}

int main(void)
{
    static const struct {
        uint32_t neurons, bins;
    } shapes[] = {{128, 100}, {128, 1000}, {768, 100}, {768, 1000}, {1280, 100}, {1280, 1000}};
    printf("%zu\n", select_size(128, 100, CANDIDATES + 1) - select_size(128, 100, CANDIDATES));
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        printf("%u %u %zu %zu %zu\n", (unsigned)shapes[i].neurons, (unsigned)shapes[i].bins,
               hist_size(shapes[i].neurons, shapes[i].bins),
               vdna_emd_scratch_size(shapes[i].neurons),
               select_size(shapes[i].neurons, shapes[i].bins, CANDIDATES));
    return 0;
}
