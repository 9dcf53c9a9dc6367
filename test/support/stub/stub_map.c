// stub_map DIRECTORY [NAME...]: write experiences that the stub backbone fits, by default spring
// and winter.
#include <sys/stat.h>

#include "map_files.h"

static int write_as(const char *folder, const char *name)
{
    vdna_experience experience = sample_experience();
    strcpy(experience.name, name);
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.vdna", folder, name);
    vdna_error error;
    const vdna_status status = vdna_experience_write(&experience, path, &error);
    if (status != VDNA_OK)
        fprintf(stderr, "stub_map: %s\n", error.text);
    return status == VDNA_OK;
}

int main(int argc, char **argv)
{
    if (argc < 2)
        return fprintf(stderr, "usage: stub_map DIRECTORY [NAME...]\n"), 2;
    mkdir(argv[1], 0777);
    if (argc == 2)
        return write_as(argv[1], "spring") && write_as(argv[1], "winter") ? 0 : 1;
    for (int i = 2; i < argc; i++)
        if (!write_as(argv[1], argv[i]))
            return 1;
    return 0;
}
