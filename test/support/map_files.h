/* A small experience whose numbers can be checked by hand, and a directory to keep its files in. */
#ifndef MAP_FILES_H
#define MAP_FILES_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <vdna/map.h>

#define SAMPLE_SHA256 "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

/* Two frames of three neurons in four bins. Two neurons are of tap "mid" with four samples a frame,
 * so their mass is 8; the third is of tap "top" with one sample a frame, so its mass is 2. */
static inline vdna_experience sample_experience(void)
{
    static const float range[3][2] = {{-1.0f, 1.0f}, {0.0f, 6.0f}, {-2.5f, 2.5f}};
    static const uint32_t counts[4][3] = {{1, 8, 0}, {2, 0, 0}, {3, 0, 1}, {2, 0, 1}};
    static const uint32_t mass[3] = {8, 8, 2};
    static const float embeddings[2][5] = {{1, 0, 0, 0, 0}, {0, 0.5f, -0.5f, 0.5f, -0.5f}};
    static const int64_t utime[2] = {1000000, 1033333};
    static const int64_t place[2] = {17, 18};
    static const double position[2][3] = {{0, 0, 0}, {1.5, -2, 0.25}};
    static const float grey[2] = {0, 127.5f};
    const vdna_experience sample = {
        .name = "winter",
        .identity = {.backbone = "tiny-net_1.0",
                     .model_sha256 = SAMPLE_SHA256,
                     .preprocessing = "rgb 8x8 \"area\" mean=0 std=1 \\",
                     .taps = "mid:2:4,top:1:1",
                     .neurons = 3,
                     .dim = 5,
                     .bins = 4,
                     .range = range[0]},
        .frames = 2,
        .counts = counts[0],
        .mass = mass,
        .embeddings = embeddings[0],
        .frame_utime = utime,
        .frame_place = place,
        .frame_position = position[0],
        .frame_grey = grey,
        .position_frame = "local",
        .order = "utime",
    };
    return sample;
}

/* The same of a network with a grid for an embedding, which keeps that of its last layer as well.
 * Codes of one byte, an odd number of them, come before the checksum. */
static inline vdna_experience grid_experience(void)
{
    static const int8_t last_layer[2][7] = {{127, 0, -64, 1, 2, 3, 4}, {-127, 3, 127, 0, 0, 9, 0}};
    static const float scale[2] = {0.5f, 0};
    vdna_experience grid = sample_experience();
    strcpy(grid.identity.embedding, "mid grid=1x5 last=top centred");
    grid.last_layer = last_layer[0];
    grid.last_layer_scale = scale;
    grid.last_layer_dim = 7;
    return grid;
}

/* That one with codes in place of its embeddings, which they give exactly. */
static inline vdna_experience coded_experience(void)
{
    static const int8_t codes[2][5] = {{127, 0, 0, 0, 0}, {0, 64, -64, 64, -64}};
    static const float scale[2] = {0.5f, 0.25f};
    static const float embeddings[2][5] = {{63.5f, 0, 0, 0, 0}, {0, 16, -16, 16, -16}};
    vdna_experience coded = grid_experience();
    coded.embeddings = embeddings[0];
    coded.embedding_codes = codes[0];
    coded.embedding_scale = scale;
    return coded;
}

/* The one with the grid, of whose six numbers the map keeps five: not the third. */
static inline vdna_experience projected_experience(void)
{
    static const float projection[5][6] = {{1, 0, 0, 0, 0, 0},
                                           {0, -1, 0, 0, 0, 0},
                                           {0, 0, 0, 0.5f, 0, 0},
                                           {0, 0, 0, 0, 1, 1},
                                           {0, 0, 0, 0, -1, 1}};
    vdna_experience projected = grid_experience();
    strcpy(projected.identity.embedding, "mid grid=1x3 last=top centred");
    projected.identity.projection = projection[0];
    projected.identity.raw_dim = 6;
    return projected;
}

/* The sample with thumbnails, of three and five bytes, and a source. */
static inline vdna_experience pictured_experience(void)
{
    static const uint8_t thumbnails[8] = "onethree";
    static const uint32_t end[2] = {3, 8};
    vdna_experience pictured = sample_experience();
    pictured.thumbnails = thumbnails;
    pictured.thumbnail_end = end;
    pictured.thumbnail_bytes = 8;
    strcpy(pictured.source, "winter \"drive\".mp4");
    return pictured;
}

/* Where a test's files are; made by make_directory(), removed with all in it by
 * remove_directory(). */
typedef struct directory {
    char path[64];
} directory;

static inline directory make_directory(void)
{
    directory made = {"/tmp/vdna-test-map-XXXXXX"};
    if (!mkdtemp(made.path)) {
        perror(made.path);
        abort();
    }
    return made;
}

/* The same in memory, if the system has such a place: for tests with thousands of files that care
 * for no disk. */
static inline directory make_directory_in_memory(void)
{
    directory made = {"/dev/shm/vdna-test-map-XXXXXX"};
    return mkdtemp(made.path) ? made : make_directory();
}

static inline void remove_directory(const directory *made)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", made->path);
    if (system(command) != 0)
        abort();
}

static inline void remove_all_files(const directory *made)
{
    DIR *listing = opendir(made->path);
    for (const struct dirent *entry; (entry = readdir(listing)) != NULL;)
        unlinkat(dirfd(listing), entry->d_name, 0);
    closedir(listing);
}

/* CMocka's set-up and tear-down: each test gets an empty directory as its *state. */
static inline int set_up_directory(void **state)
{
    directory *made = malloc(sizeof *made);
    *made = make_directory();
    *state = made;
    return 0;
}

static inline int set_up_directory_in_memory(void **state)
{
    directory *made = malloc(sizeof *made);
    *made = make_directory_in_memory();
    *state = made;
    return 0;
}

static inline int tear_down_directory(void **state)
{
    remove_directory(*state);
    free(*state);
    return 0;
}

/* The path of a file in it; valid until the eighth call after this one. */
static inline const char *path_in(const directory *made, const char *name)
{
    static char paths[8][192];
    static unsigned next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", made->path, name);
    return path;
}

static inline size_t load_file(const char *path, unsigned char *out, size_t capacity)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        abort();
    const size_t size = fread(out, 1, capacity, file);
    fclose(file);
    return size;
}

static inline void save_file(const char *path, const void *bytes, size_t size)
{
    /* ext4 waits for the disk when an old file is cut and rewritten. */
    unlink(path);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0)
        abort();
}

static inline int files_in(const char *path)
{
    DIR *listing = opendir(path);
    int files = 0;
    for (const struct dirent *entry; (entry = readdir(listing)) != NULL;)
        files += entry->d_name[0] != '.';
    closedir(listing);
    return files;
}

#endif
