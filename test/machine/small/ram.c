/* Prints the memory that the library asks of its caller: first the bytes that one more experience
 * adds to a selector, and to one with trust; then, a configuration a line, neurons, bins, and the
 * bytes of a histogram, of the distance's working memory, and of a selector among CANDIDATES
 * experiences; then frames, dim, and the bytes of a prepared experience and of a localiser in it;
 * then experiences, and the bytes of trust in the choice among them. */
#include <stdio.h>
#include <stdlib.h>
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

/* @param trust  NULL = none */
static size_t select_size(uint32_t neurons, uint32_t bins, uint32_t count, vdna_trust *trust)
{
    static const float embedding = 0;
    vdna_select_candidate candidates[CANDIDATES + 1];
    vdna_trust_run runs[CANDIDATES + 1];
    memset(candidates, 0, sizeof candidates);
    memset(runs, 0, sizeof runs);
    for (uint32_t i = 0; i < count; i++) {
        candidates[i].dna.range = range;
        candidates[i].dna.neurons = neurons;
        candidates[i].dna.bins = bins;
        candidates[i].embeddings = &embedding;
        candidates[i].frames = 1;
        runs[i].embeddings = &embedding;
        runs[i].frames = runs[i].dim = 1;
    }
    vdna_select_config config;
    vdna_select_config_init(&config);
    config.candidates = candidates;
    config.candidate_count = count;
    config.dim = 1;
    config.warmup_frames = 1;
    config.trust = trust;
    config.runs = runs;
    return vdna_select_mem_size(&config);
}

static size_t localise_map_size(uint32_t frames, uint32_t dim)
{
    vdna_localise_map_config config;
    vdna_localise_map_config_init(&config);
    config.frames = frames;
    config.dim = dim;
    return vdna_localise_map_mem_size(&config);
}

static size_t localise_size(uint32_t frames, uint32_t dim)
{
    const size_t size = localise_map_size(frames, dim);
    vdna_localise_map_config map;
    vdna_localise_map_config_init(&map);
    map.frames = frames;
    map.dim = dim;
    float *embeddings = calloc((size_t)frames * dim, sizeof *embeddings);
    map.embeddings = embeddings;
    void *mem = malloc(size);
    vdna_localise_config config;
    vdna_localise_config_init(&config);
    vdna_localise_map *prepared;
    if (!embeddings || !mem || vdna_localise_map_init(&map, mem, size, &prepared) != VDNA_OK)
        abort();
    config.map = prepared;
    const size_t found = vdna_localise_mem_size(&config);
    free(mem);
    free(embeddings);
    return found;
}

static size_t trust_size(uint32_t runs)
{
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = runs;
    return vdna_trust_mem_size(&config);
}

static size_t trusting_select_size(uint32_t count)
{
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = count;
    const size_t size = trust_size(count);
    void *mem = malloc(size);
    vdna_trust *trust;
    if (!mem || vdna_trust_init(&config, mem, size, &trust) != VDNA_OK)
        abort();
    const size_t found = select_size(128, 100, count, trust);
    free(mem);
    return found;
}

int main(void)
{
    static const struct {
        uint32_t neurons, bins;
    } shapes[] = {{128, 100}, {128, 1000}, {768, 100}, {768, 1000}, {1280, 100}, {1280, 1000}};
    printf("%zu %zu\n",
           select_size(128, 100, CANDIDATES + 1, NULL) - select_size(128, 100, CANDIDATES, NULL),
           trusting_select_size(CANDIDATES + 1) - trusting_select_size(CANDIDATES));
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        printf("%u %u %zu %zu %zu\n", (unsigned)shapes[i].neurons, (unsigned)shapes[i].bins,
               hist_size(shapes[i].neurons, shapes[i].bins),
               vdna_emd_scratch_size(shapes[i].neurons),
               select_size(shapes[i].neurons, shapes[i].bins, CANDIDATES, NULL));
    static const struct {
        uint32_t frames, dim;
    } maps[] = {{100, 64}, {1150, 64}, {1150, 1008}, {100000, 64}};
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++)
        printf("%u %u %zu %zu\n", (unsigned)maps[i].frames, (unsigned)maps[i].dim,
               localise_map_size(maps[i].frames, maps[i].dim),
               localise_size(maps[i].frames, maps[i].dim));
    static const uint32_t runs[] = {4, 10, 100, 1000};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++)
        printf("%u %zu\n", (unsigned)runs[i], trust_size(runs[i]));
    return 0;
}
