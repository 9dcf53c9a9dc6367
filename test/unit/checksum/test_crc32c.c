/* CRC-32C: tables against the definition, and the processor's instruction against tables. */
#include <cmocka_all.h>
#include <crc32c.h>
#include <stdlib.h>

enum { SIZE = 100000, ALIGNMENTS = 16 };

static unsigned char bytes[SIZE + ALIGNMENTS];

static uint32_t random_below(uint32_t limit)
{
    static uint64_t state = 1;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % limit;
}

static int fill(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)random_below(256);
    return 0;
}

static uint32_t by_bits(uint32_t crc, const unsigned char *at, size_t size)
{
    crc = ~crc;
    for (; size > 0; size--, at++) {
        crc ^= *at;
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78 : 0);
    }
    return ~crc;
}

static uint32_t by_instruction(uint32_t crc, const void *at, size_t size)
{
    if (!vdna_crc32c_by_instruction(&crc, at, size))
        skip();
    return crc;
}

static void the_published_check_value_comes_out(void **state)
{
    (void)state;
    assert_int_equal(vdna_crc32c(0, "123456789", 9), 0xE3069283);
    assert_int_equal(vdna_crc32c_by_tables(0, "123456789", 9), 0xE3069283);
    assert_int_equal(by_instruction(0, "123456789", 9), 0xE3069283);
}

static void the_tables_give_what_the_definition_gives(void **state)
{
    (void)state;
    for (size_t size = 0; size < 300; size++)
        assert_int_equal(vdna_crc32c_by_tables(7, bytes + size % ALIGNMENTS, size),
                         by_bits(7, bytes + size % ALIGNMENTS, size));
}

static void the_instruction_gives_what_the_tables_give_at_every_length_and_alignment(void **state)
{
    (void)state;
    for (size_t size = 0; size <= 1000; size++)
        for (size_t a = 0; a < ALIGNMENTS; a++)
            assert_int_equal(by_instruction((uint32_t)size, bytes + a, size),
                             vdna_crc32c_by_tables((uint32_t)size, bytes + a, size));
}

static void the_instruction_gives_what_the_tables_give_for_long_files(void **state)
{
    (void)state;
    for (int i = 0; i < 300; i++) {
        const size_t size = random_below(SIZE + 1);
        const unsigned char *at = bytes + random_below(ALIGNMENTS);
        assert_int_equal(by_instruction(0, at, size), vdna_crc32c_by_tables(0, at, size));
    }
}

static void parts_give_what_the_whole_gives(void **state)
{
    (void)state;
    const uint32_t whole = vdna_crc32c_by_tables(0, bytes, SIZE);
    for (int i = 0; i < 300; i++) {
        const size_t a = random_below(SIZE + 1), b = a + random_below((uint32_t)(SIZE - a) + 1);
        const uint32_t first = vdna_crc32c(0, bytes, a);
        const uint32_t second = vdna_crc32c_by_tables(first, bytes + a, b - a);
        assert_int_equal(vdna_crc32c(second, bytes + b, SIZE - b), whole);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_published_check_value_comes_out),
        cmocka_unit_test(the_tables_give_what_the_definition_gives),
        cmocka_unit_test(the_instruction_gives_what_the_tables_give_at_every_length_and_alignment),
        cmocka_unit_test(the_instruction_gives_what_the_tables_give_for_long_files),
        cmocka_unit_test(parts_give_what_the_whole_gives),
    };
    return cmocka_run_group_tests_name("crc32c", tests, fill, NULL);
}
