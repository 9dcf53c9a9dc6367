/* make_drives FOLDER: writes the drives of apps/examples/rank.c as experience files, so that a
 * program that opens them prints what one that makes them up does. */
#define main rank_main
#include "../../../apps/examples/rank.c" /* NOLINT(bugprone-suspicious-include): the same drives */
#undef main

static int write_drive(const char *folder, const candidate *c)
{
    static int64_t utime[FRAMES];
    static const float grey[FRAMES];
    vdna_experience e = {.frames = c->frames,
                         .counts = c->dna.counts,
                         .mass = c->dna.mass,
                         .embeddings = c->embeddings,
                         .frame_utime = utime,
                         .frame_grey = grey};
    for (int i = 0; i < FRAMES; i++)
        utime[i] = (int64_t)i * PERIOD_US;
    snprintf(e.name, sizeof e.name, "%s", c->name);
    strcpy(e.identity.backbone, "made-up");
    memset(e.identity.model_sha256, '0', sizeof e.identity.model_sha256 - 1);
    strcpy(e.identity.preprocessing, "none");
    snprintf(e.identity.taps, sizeof e.identity.taps, "tap:%d:%d", NEURONS, SAMPLES);
    e.identity.neurons = e.identity.dim = NEURONS;
    e.identity.bins = BINS;
    e.identity.range = c->dna.range;

    char path[4096];
    vdna_error error;
    snprintf(path, sizeof path, "%s/%s.vdna", folder, c->name);
    if (vdna_experience_write(&e, path, &error) == VDNA_OK)
        return 0;
    fprintf(stderr, "make_drives: %s\n", error.text);
    return 1;
}

int main(int argc, char **argv)
{
    candidate candidates[CANDIDATES];
    if (argc != 2)
        return 2;
    record(candidates);
    int failed = 0;
    for (int i = 0; i < CANDIDATES; i++)
        failed |= write_drive(argv[1], &candidates[i]);
    return failed;
}
