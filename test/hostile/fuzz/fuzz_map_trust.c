/* Any bytes as the file of what a map knows about itself. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "fuzz.h"
#include "map_files.h"
#include "map_trust_file.h"
#include "right_checksum.h"

/* Trust can be made of accepted tables, and says nothing without live frames; the sanitisers watch
 * the reads. */
static void use_tables(const vdna_map_trust_file *file)
{
    vdna_trust_config config;
    vdna_trust_config_init(&config);
    config.runs = file->members;
    config.tables = &file->tables;
    config.localiser = file->localiser;
    const size_t size = vdna_trust_mem_size(&config);
    MUST(size > 0);
    void *mem = malloc(size);
    vdna_trust_prediction *predictions = calloc(file->members, sizeof *predictions);
    vdna_trust *trust = NULL;
    vdna_trust_answer answer;
    if (mem && predictions) {
        MUST(vdna_trust_init(&config, mem, size, &trust) == VDNA_OK);
        MUST(vdna_trust_predict(trust, NULL, predictions, &answer) == VDNA_OK);
        MUST(predictions[0].reason != VDNA_TRUST_REASON_NONE);
    }
    free(predictions);
    free(mem);
}

static volatile uint32_t checksum_read;

static void use_members(const vdna_map_trust_file *file)
{
    MUST(file->members >= 1 && file->members <= VDNA_TRUST_RUNS_MAX);
    MUST(isfinite(*file->tolerance) && *file->tolerance >= 0);
    for (uint32_t m = 0; m < file->members; m++) {
        MUST(vdna_name_check(vdna_map_trust_name(file, m), NULL) == VDNA_OK);
        checksum_read = file->checksums[m];
    }
}

static void read_and_use(const unsigned char *bytes, size_t size)
{
    vdna_map_trust_file file;
    vdna_error reason = {""};
    if (vdna_map_trust_read(bytes, size, &reason, &file) != VDNA_OK) {
        MUST(reason.text[0] != '\0');
        return;
    }
    use_members(&file);
    use_tables(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    try_file(bytes, size, read_and_use);
    return 0;
}

/* Experiences of two frames, so with two windows each. */
static size_t write_seed(const directory *made, uint32_t runs, uint8_t *out, size_t capacity)
{
    vdna_experience experiences[3];
    vdna_trust_cell cells[9];
    const uint32_t frames[3] = {2, 2, 2};
    const double own_scale[3] = {1, 0.5, 0.25}, correlation[3] = {NAN, 2, 3};
    for (uint32_t i = 0; i < runs; i++) {
        vdna_experience sample = sample_experience();
        const char *path = path_in(made, "seed" VDNA_MAP_EXTENSION);
        snprintf(sample.name, sizeof sample.name, "run%u", (unsigned)i);
        MUST(vdna_experience_write(&sample, path, NULL) == VDNA_OK);
        MUST(vdna_experience_open(path, NULL, &experiences[i]) == VDNA_OK);
    }
    for (uint32_t c = 0; c < 9; c++)
        for (uint32_t i = 0; i < VDNA_TRUST_WINDOWS; i++) {
            const double x = 0.01 * (7 * c + i);
            cells[c].nearest[i] = cells[c].likeness[i] = cells[c].recall[i] = x;
            cells[c].distance[i] = x;
        }
    const vdna_map_trust trust = {
        .tables = {frames, own_scale, correlation, cells}, .tolerance = 5, .runs = runs};
    MUST(vdna_map_trust_write(made->path, experiences, &trust, NULL) == VDNA_OK);
    for (uint32_t i = 0; i < runs; i++)
        vdna_experience_close(&experiences[i]);
    return load_file(path_in(made, VDNA_MAP_TRUST_FILE), out, capacity);
}

/* Files of one, two and three experiences. */
size_t vdna_fuzz_seed(unsigned index, uint8_t *out, size_t capacity)
{
    if (index > 2)
        return 0;
    const directory made = make_directory();
    const size_t size = write_seed(&made, index + 1, out, capacity);
    remove_directory(&made);
    return size;
}
