/* Run a network on pictures and write all its outputs for test_export.py.
 *
 *     export_check MANIFEST BINS LOW HIGH PICTURE... >OUTPUT
 *
 * A picture is a file of RGB bytes of the network's own size, so that nothing gets resized. OUTPUT
 * is a line "DIM NAME:NEURONS:SAMPLES[,...]", for each picture its embedding and its taps as
 * floats, and the counts of a histogram over all of them as uint32, in the machine's byte order. */
#include <stdio.h>
#include <stdlib.h>

#include <vdna/backbone.h>
#include <vdna/hist.h>

static void die(const char *where, const char *what)
{
    fprintf(stderr, "export_check: %s: %s\n", where, what);
    exit(1);
}

static void *allocate(size_t size)
{
    void *block = malloc(size);
    if (!block)
        die("memory", "no more of it");
    return block;
}

static void write_out(const void *values, size_t size, size_t count)
{
    if (fwrite(values, size, count, stdout) != count)
        die("stdout", "cannot be written");
}

static vdna_backbone *open_backbone(const char *manifest)
{
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.manifest = manifest;
    vdna_backbone *backbone = NULL;
    vdna_error error;
    if (vdna_backbone_open(&config, &error, &backbone) != VDNA_OK)
        die(manifest, error.text);
    return backbone;
}

/* All neurons have one range. The caller frees `range` of the histogram and `*out_block`. */
static vdna_hist make_hist(uint32_t neurons, uint32_t bins, float low, float high, void **out_block)
{
    float *range = allocate(2 * sizeof *range * neurons);
    for (uint32_t n = 0; n < neurons; n++) {
        range[2 * n] = low;
        range[2 * n + 1] = high;
    }
    vdna_hist_config config;
    vdna_hist_config_init(&config);
    config.neurons = neurons;
    config.bins = bins;
    config.range = range;
    const size_t size = vdna_hist_mem_size(&config);
    *out_block = allocate(size);
    vdna_hist hist;
    if (vdna_hist_init(&config, *out_block, size, &hist) != VDNA_OK)
        die("arguments", "BINS, LOW and HIGH make no histogram");
    return hist;
}

static void read_picture(const char *path, uint8_t *pixels, size_t size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        die(path, "cannot be opened");
    if (fread(pixels, 1, size, file) != size)
        die(path, "is shorter than a picture of the network's size");
    fclose(file);
}

static void run(vdna_backbone *backbone, const vdna_backbone_info *info, const char *path,
                vdna_hist *hist)
{
    const uint32_t width = info->input_width, height = info->input_height;
    const size_t size = (size_t)3 * width * height;
    uint8_t *pixels = allocate(size);
    read_picture(path, pixels, size);
    const vdna_image image = {pixels, size, width, height, 0, VDNA_PIXEL_RGB3};
    vdna_backbone_frame frame;
    vdna_error error;
    if (vdna_backbone_run(backbone, &image, &error, &frame) != VDNA_OK)
        die(path, error.text);
    free(pixels);

    write_out(frame.embedding, sizeof *frame.embedding, frame.dim);
    for (size_t t = 0; t < frame.tap_count; t++)
        write_out(frame.taps[t].values, sizeof *frame.taps[t].values,
                  (size_t)frame.taps[t].neurons * frame.taps[t].samples);
    if (vdna_hist_add(hist, frame.taps, frame.tap_count) != VDNA_OK)
        die(path, "the histogram refuses what the network gave");
}

int main(int argc, char **argv)
{
    if (argc < 6)
        die("usage", "export_check MANIFEST BINS LOW HIGH PICTURE... >OUTPUT");
    vdna_backbone *backbone = open_backbone(argv[1]);
    vdna_backbone_info info;
    vdna_backbone_describe(backbone, &info);
    void *block = NULL;
    vdna_hist hist = make_hist(info.identity.neurons, (uint32_t)strtoul(argv[2], NULL, 10),
                               strtof(argv[3], NULL), strtof(argv[4], NULL), &block);

    printf("%u %s\n", (unsigned)info.identity.dim, info.identity.taps);
    for (int i = 5; i < argc; i++)
        run(backbone, &info, argv[i], &hist);
    write_out(hist.counts, sizeof *hist.counts, (size_t)hist.neurons * hist.bins);

    vdna_backbone_close(backbone);
    free((void *)hist.range);
    free(block);
    return fclose(stdout) == 0 ? 0 : 1;
}
