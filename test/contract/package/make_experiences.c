/* make_experiences FOLDER: writes live.vdna, near.vdna and far.vdna for apps/examples/choose.c. */
#define _POSIX_C_SOURCE 200809L
#include "map_files.h"

static int write_named(const char *folder, const char *name, const uint32_t counts[4][3])
{
    vdna_experience experience = sample_experience();
    snprintf(experience.name, sizeof experience.name, "%s", name);
    experience.counts = counts[0];
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.vdna", folder, name);
    vdna_error error;
    if (vdna_experience_write(&experience, path, &error) == VDNA_OK)
        return 0;
    fprintf(stderr, "%s\n", error.text);
    return 1;
}

int main(int argc, char **argv)
{
    static const uint32_t live[4][3] = {{1, 8, 0}, {2, 0, 0}, {3, 0, 1}, {2, 0, 1}};
    static const uint32_t near_[4][3] = {{1, 8, 0}, {3, 0, 0}, {2, 0, 2}, {2, 0, 0}};
    static const uint32_t far_[4][3] = {{8, 0, 1}, {0, 0, 1}, {0, 0, 0}, {0, 8, 0}};
    if (argc != 2)
        return 2;
    return write_named(argv[1], "live", live) | write_named(argv[1], "near", near_) |
           write_named(argv[1], "far", far_);
}
