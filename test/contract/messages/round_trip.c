// round_trip SAMPLES OUT: decode each sample, encode it again. <messages.h> includes the generated
// headers and lists the types.
#include <messages.h>
#include <stdint.h>
#include <stdio.h>

static int fail(const char *what, const char *name)
{
    return fprintf(stderr, "round_trip: cannot %s %s\n", what, name), 0;
}

static FILE *open_in(const char *folder, const char *name, const char *mode)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return fopen(path, mode);
}

static int read_sample(const char *folder, const char *name, uint8_t *out_bytes, size_t room)
{
    FILE *const file = open_in(folder, name, "rb");
    if (!file)
        return 0;
    const size_t size = fread(out_bytes, 1, room, file);
    fclose(file);
    return (int)size;
}

static int write_sample(const char *folder, const char *name, const uint8_t *bytes, int size)
{
    FILE *const file = open_in(folder, name, "wb");
    if (!file)
        return 0;
    const int written = fwrite(bytes, (size_t)size, 1, file) == 1;
    return fclose(file) == 0 && written;
}

#define MESSAGE(package, type)                                                                  \
    static int round_trip_##type(const char *from, const char *to)                              \
    {                                                                                           \
        const char *const name = #package "." #type;                                            \
        uint8_t bytes[4096];                                                                    \
        const int size = read_sample(from, name, bytes, sizeof bytes);                          \
        package##_##type message;                                                               \
        if (package##_##type##_decode(bytes, 0, size, &message) != size)                        \
            return fail("decode", name);                                                        \
        const int encoded = package##_##type##_encode(bytes, 0, sizeof bytes, &message);        \
        package##_##type##_decode_cleanup(&message);                                            \
        return (encoded > 0 && write_sample(to, name, bytes, encoded)) || fail("encode", name); \
    }
MESSAGES
#undef MESSAGE

int main(int argc, char **argv)
{
    if (argc != 3)
        return fprintf(stderr, "usage: round_trip SAMPLES OUT\n"), 2;
    int good = 1;
#define MESSAGE(package, type) good &= round_trip_##type(argv[1], argv[2]);
    MESSAGES
    return good ? 0 : 1;
}
