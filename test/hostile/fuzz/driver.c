/* Fuzzing without libFuzzer: the seeds of a target under mutations that repeat on every run.
 *
 *     test_fuzz_NAME             all inputs, in a child process; says which one ended it
 *     test_fuzz_NAME NUMBER      one of them, in this process, for a debugger
 *     test_fuzz_NAME DIRECTORY   write the seeds there, for libFuzzer */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fuzz.h"

#define INPUTS 20000u
#define INPUTS_OF_ALL 200000u /* with VDNA_ALL, as ./dev test --all sets it */

/* Most seeds that a target may have. */
#define SEEDS 64u

typedef struct input {
    uint8_t bytes[FUZZ_SIZE];
    size_t size;
    uint64_t random; /* state of the generator */
} input;

/* A number below `limit`, which is at least 1: xorshift64*. */
static size_t pick(input *in, size_t limit)
{
    in->random ^= in->random >> 12;
    in->random ^= in->random << 25;
    in->random ^= in->random >> 27;
    return (size_t)((in->random * 2685821657736338717u) >> 33) % limit;
}

static void flip_a_bit(input *in)
{
    in->bytes[pick(in, in->size)] ^= (uint8_t)(1u << pick(in, 8));
}

static void set_a_byte(input *in)
{
    static const uint8_t values[] = "\0\1\x7F\x80\xFF \"\\{}[],:-.eu";
    in->bytes[pick(in, in->size)] = values[pick(in, sizeof values - 1)];
}

/* Numbers written as text: keep the text valid and make its meaning wrong. */
static void set_a_digit(input *in)
{
    const size_t first = pick(in, in->size);
    for (size_t i = first; i < in->size; i++)
        if (in->bytes[i] >= '0' && in->bytes[i] <= '9') {
            in->bytes[i] = (uint8_t)('0' + pick(in, 10));
            return;
        }
}

static void set_an_integer(input *in)
{
    static const uint64_t values[] = {0,
                                      1,
                                      8,
                                      0x7FFFFFFF,
                                      0x80000000,
                                      0xFFFFFFFF,
                                      0x100000000,
                                      0x7FFFFFFFFFFFFFFF,
                                      0x8000000000000000,
                                      UINT64_MAX};
    const uint64_t value = values[pick(in, sizeof values / sizeof *values)];
    const size_t width = (size_t)1 << pick(in, 4);
    if (in->size >= width)
        memcpy(in->bytes + pick(in, in->size - width + 1), &value, width);
}

static void truncate_it(input *in)
{
    in->size = pick(in, in->size) + 1;
}

static void remove_a_block(input *in)
{
    const size_t from = pick(in, in->size), size = pick(in, in->size - from);
    memmove(in->bytes + from, in->bytes + from + size, in->size - from - size);
    in->size -= size;
}

static void copy_a_block(input *in)
{
    const size_t from = pick(in, in->size), to = pick(in, in->size);
    const size_t room = in->size - (from > to ? from : to);
    memmove(in->bytes + to, in->bytes + from, pick(in, room) + 1);
}

static void insert_a_block(input *in)
{
    const size_t from = pick(in, in->size), to = pick(in, in->size);
    const size_t size = pick(in, in->size - from) + 1;
    if (size > FUZZ_SIZE - in->size)
        return;
    memmove(in->bytes + to + size, in->bytes + to, in->size - to);
    memmove(in->bytes + to, in->bytes + (from < to ? from : from + size), size);
    in->size += size;
}

static void mutate(input *in)
{
    static void (*const mutations[])(input *) = {flip_a_bit,     set_a_byte,    set_a_digit,
                                                 set_an_integer, truncate_it,   remove_a_block,
                                                 copy_a_block,   insert_a_block};
    for (size_t left = pick(in, 4) + 1; left > 0; left--)
        mutations[pick(in, sizeof mutations / sizeof *mutations)](in);
}

/* The seeds of the target, as many as there are. */
typedef struct seeds {
    uint8_t bytes[SEEDS][FUZZ_SIZE];
    size_t sizes[SEEDS];
    unsigned count;
} seeds;

static const seeds *load_seeds(void)
{
    static seeds all;
    for (; all.count < SEEDS; all.count++) {
        all.sizes[all.count] = vdna_fuzz_seed(all.count, all.bytes[all.count], FUZZ_SIZE);
        if (all.sizes[all.count] == 0)
            break;
    }
    return &all;
}

/* Input `number` depends only on its number; the first inputs are the unchanged seeds. */
static void run(unsigned number, const seeds *all)
{
    static input in;
    const unsigned seed = number % all->count;
    in.random = number * 0x9E3779B97F4A7C15u + 1;
    in.size = all->sizes[seed];
    memcpy(in.bytes, all->bytes[seed], in.size);
    if (number >= all->count)
        mutate(&in);
    /* A copy of its exact size, so that sanitizers see the first byte beyond it. */
    uint8_t *exact = malloc(in.size);
    if (!exact)
        abort();
    memcpy(exact, in.bytes, in.size);
    LLVMFuzzerTestOneInput(exact, in.size);
    free(exact);
}

/* Run all inputs in a child, so that the parent can report the input that ended it. */
static int run_all(const char *program)
{
    volatile unsigned *at =
        mmap(NULL, sizeof *at, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED)
        return EXIT_FAILURE;
    const pid_t child = fork();
    if (child == 0) {
        const seeds *all = load_seeds();
        const unsigned inputs = getenv("VDNA_ALL") ? INPUTS_OF_ALL : INPUTS;
        for (*at = 0; *at < inputs; ++*at)
            run(*at, all);
        exit(EXIT_SUCCESS);
    }
    int status;
    if (child < 0 || waitpid(child, &status, 0) != child)
        return EXIT_FAILURE;
    if (status == 0)
        return EXIT_SUCCESS;
    fprintf(stderr, "input %u ended the process; rerun it with: %s %u\n", *at, program, *at);
    return EXIT_FAILURE;
}

static int write_seeds(const char *directory)
{
    const seeds *all = load_seeds();
    for (unsigned i = 0; i < all->count; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/seed-%u", directory, i);
        FILE *file = fopen(path, "wb");
        if (!file || fwrite(all->bytes[i], 1, all->sizes[i], file) != all->sizes[i] ||
            fclose(file) != 0) {
            perror(path);
            return EXIT_FAILURE;
        }
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    if (argc < 2)
        return run_all(argv[0]);
    if (argv[1][strspn(argv[1], "0123456789")] != '\0')
        return write_seeds(argv[1]);
    run((unsigned)strtoul(argv[1], NULL, 10), load_seeds());
    return EXIT_SUCCESS;
}
