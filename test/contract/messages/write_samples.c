// write_samples FOLDER: a message of each type as the programs encode it, one file each, such as
// vdna_msg.status_t.
#include <stdint.h>
#include <stdio.h>
#include <vdna_messages.h>

#include "lcm_samples.h"

static int write_sample(const char *folder, const vdna_message_type *type, const void *message)
{
    uint8_t bytes[4096];
    const int32_t size = type->encode(message, bytes, sizeof bytes);
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, type->name);
    FILE *const file = size < 0 ? NULL : fopen(path, "wb");
    const int written = file && fwrite(bytes, (size_t)size, 1, file) == 1;
    if (!file || fclose(file) != 0 || !written)
        return fprintf(stderr, "write_samples: cannot write %s\n", path), 0;
    return 1;
}

int main(int argc, char **argv)
{
    if (argc != 2)
        return fprintf(stderr, "usage: write_samples FOLDER\n"), 2;
    const int written =
        write_sample(argv[1], &vdna_message_image, &sample_image) &&
        write_sample(argv[1], &vdna_message_pose, &sample_pose) &&
        write_sample(argv[1], &vdna_message_gps_data, &sample_gps_data) &&
        write_sample(argv[1], &vdna_message_command, &sample_command) &&
        write_sample(argv[1], &vdna_message_command_result, &sample_command_result) &&
        write_sample(argv[1], &vdna_message_ranking, &sample_ranking) &&
        write_sample(argv[1], &vdna_message_localisation, &sample_localisation) &&
        write_sample(argv[1], &vdna_message_status, &sample_status);
    return written ? 0 : 1;
}
