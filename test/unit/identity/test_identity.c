/* Identities: their rules, text and hash, taps and names. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <vdna/hist.h>
#include <vdna/identity.h>

#include "cmocka_all.h"

#define SHA256 "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

/* The identity of the experience in docs/reference/SPEC-map.md. */
static const float range[] = {-1, 1, 0, 6, -2.5f, 2.5f};
static const vdna_identity sample = {
    .backbone = "tiny-net_1.0",
    .model_sha256 = SHA256,
    .preprocessing = "rgb 8x8 \"area\" mean=0 std=1 \\",
    .taps = "mid:2:4,top:1:1",
    .neurons = 3,
    .dim = 5,
    .bins = 4,
    .range = range,
};

static void assert_refused(const vdna_identity *identity, vdna_status expected, const char *reason)
{
    vdna_error error = {""};
    assert_int_equal(vdna_identity_check(identity, &error), expected);
    if (!strstr(error.text, reason))
        fail_msg("expected \"%s\" in: %s", reason, error.text);
}

static void an_identity_may_leave_open_what_is_not_known_yet(void **state)
{
    (void)state;
    vdna_identity open = sample;
    assert_int_equal(vdna_identity_check(&sample, NULL), VDNA_OK);
    open.dim = open.bins = 0;
    open.range = NULL;
    assert_int_equal(vdna_identity_check(&open, NULL), VDNA_OK);
}

static void a_text_that_breaks_its_alphabet_is_refused_by_name(void **state)
{
    (void)state;
    vdna_identity i = sample;
    strcpy(i.backbone, "tiny/net");
    assert_refused(&i, VDNA_ERR_ARG,
                   "backbone has a character that is not allowed, expected 1 to"
                   " 63 letters, digits, '.', '_' or '-'");
    memset(i.backbone, 'a', sizeof i.backbone);
    assert_refused(&i, VDNA_ERR_ARG, "backbone is too long");
    i = sample;
    strcpy(i.preprocessing, "two\nlines");
    assert_refused(&i, VDNA_ERR_ARG,
                   "preprocessing has a character that is not allowed, expected"
                   " 1 to 511 printable ASCII characters");
    i = sample;
    strcpy(i.precision, "int 8");
    assert_refused(&i, VDNA_ERR_ARG, "precision has a character");
    i = sample;
    strcpy(i.embedding, "map\tgrid=3x3");
    assert_refused(&i, VDNA_ERR_ARG, "embedding has a character that is not allowed");
    memset(i.embedding, 'e', sizeof i.embedding);
    assert_refused(&i, VDNA_ERR_ARG, "embedding is too long, expected 1 to 255 printable");
    i = sample;
    i.taps[0] = '\0';
    assert_refused(&i, VDNA_ERR_ARG, "taps is empty");
    i = sample;
    i.model_sha256[63] = '\0';
    assert_refused(&i, VDNA_ERR_ARG, "model_sha256 is not 64 lower-case hexadecimal digits");
    i = sample;
    i.model_sha256[64] = '0';
    assert_refused(&i, VDNA_ERR_ARG, "model_sha256 is not 64");
    assert_refused(NULL, VDNA_ERR_ARG, "missing");
}

static void a_sha256_has_lower_case_hexadecimal_digits_only(void **state)
{
    (void)state;
    vdna_identity i = sample;
    for (int c = 1; c < 256; c++) {
        i.model_sha256[7] = (char)c;
        assert_int_equal(vdna_identity_check(&i, NULL),
                         strchr("0123456789abcdef", c) ? VDNA_OK : VDNA_ERR_ARG);
    }
}

static void numbers_that_break_a_rule_are_refused(void **state)
{
    (void)state;
    const float flat[] = {-1, 1, 6, 6, -2.5f, 2.5f};
    vdna_identity i = sample;
    strcpy(i.taps, "mid:2:4,top:1");
    assert_refused(&i, VDNA_ERR_ARG, "taps is \"mid:2:4,top:1\", expected NAME:NEURONS:SAMPLES");
    i = sample;
    i.neurons = 4;
    assert_refused(&i, VDNA_ERR_MISMATCH, "do not have the 4 neurons");
    i = sample;
    strcpy(i.taps, "mid:4294967295:4,top:4:1"); /* their sum is 3 modulo 2^32 */
    assert_refused(&i, VDNA_ERR_MISMATCH, "do not have the 3 neurons");
    i = sample;
    i.bins = 1;
    assert_refused(&i, VDNA_ERR_ARG, "bins is 1, expected 2 to 65536");
    i.bins = 65537;
    assert_refused(&i, VDNA_ERR_ARG, "bins is 65537, expected 2 to 65536");
    i = sample;
    i.range = flat;
    assert_refused(&i, VDNA_ERR_ARG, "the range of neuron 1 is 6..6, expected finite numbers");
}

static void a_precision_that_is_not_stated_is_fp32(void **state)
{
    (void)state;
    vdna_identity i = sample;
    assert_string_equal(vdna_identity_precision(&i), "fp32");
    strcpy(i.precision, "int8");
    assert_string_equal(vdna_identity_precision(&i), "int8");
    assert_string_equal(vdna_identity_precision(NULL), "fp32");
    assert_int_equal(vdna_identity_check(&i, NULL), VDNA_OK);
}

static void assert_differ(const vdna_identity *a, const vdna_identity *b, const char *sentence)
{
    vdna_error error = {""};
    assert_int_equal(vdna_identity_compare(a, b, &error), VDNA_ERR_MISMATCH);
    assert_string_equal(error.text, sentence);
}

static void a_comparison_names_the_first_difference_and_both_values(void **state)
{
    (void)state;
    const float wider[] = {-1, 1, 0, 6, -2.5f, 2.75f};
    vdna_identity other = sample;
    other.range = wider;
    assert_differ(&sample, &other,
                  "range of neuron 2 is -2.5..2.5 in one and -2.5..2.75 in the other");
    other.bins = 8;
    assert_differ(&sample, &other, "bins is 4 in one and 8 in the other");
    other.dim = 6;
    assert_differ(&sample, &other, "dim is 5 in one and 6 in the other");
    other.neurons = 4;
    assert_differ(&sample, &other, "neurons is 3 in one and 4 in the other");
    strcpy(other.taps, "top:3:1");
    assert_differ(&sample, &other, "taps is mid:2:4,top:1:1 in one and top:3:1 in the other");
    strcpy(other.preprocessing, "none");
    assert_differ(&other, &sample,
                  "preprocessing is none in one and rgb 8x8 \"area\" mean=0 std=1 \\ in the other");
    other.model_sha256[0] = 'f';
    char hashes[256];
    snprintf(hashes, sizeof hashes, "model_sha256 is %s in one and %s in the other", SHA256,
             other.model_sha256);
    assert_differ(&sample, &other, hashes);
}

static void a_precision_that_explains_different_models_is_reported_instead(void **state)
{
    (void)state;
    vdna_identity int8 = sample;
    strcpy(int8.precision, "int8");
    /* Of the same model: its name makes no difference. */
    assert_int_equal(vdna_identity_compare(&sample, &int8, NULL), VDNA_OK);
    int8.model_sha256[0] = 'f';
    assert_differ(&sample, &int8, "precision is fp32 in one and int8 in the other");
    assert_differ(&int8, &sample, "precision is int8 in one and fp32 in the other");
}

static void long_values_are_shown_from_where_they_differ(void **state)
{
    (void)state;
    vdna_identity a = sample, b;
    static const char block[] = "blocks.11:768:197,";
    for (size_t i = 0; i < 12; i++)
        memcpy(a.taps + i * strlen(block), block, sizeof block);
    b = a;
    b.taps[11 * strlen(block) + 15] = '6';
    assert_differ(&a, &b,
                  "taps is ...:197,blocks.11:768:197, in one and ...:197,blocks.11:768:167, in the"
                  " other");
    /* One is the beginning of the other. */
    b.taps[11 * strlen(block)] = '\0';
    assert_differ(
        &b, &a,
        "taps is ...7,blocks.11:768:197, in one and ...7,blocks.11:768:197,blocks.11:768:197,"
        " in the other");
    /* With a difference at the beginning, and with only one long value. */
    strcpy(b.taps, "mid:2:4");
    char sentence[256];
    snprintf(sentence, sizeof sentence, "taps is mid:2:4 in one and %.100s in the other", a.taps);
    assert_differ(&b, &a, sentence);
    snprintf(sentence, sizeof sentence, "taps is %.100s in one and mid:2:4 in the other", a.taps);
    assert_differ(&a, &b, sentence);
}

static void embeddings_that_are_made_differently_do_not_compare(void **state)
{
    (void)state;
    vdna_identity grid = sample, bands = sample, plain = sample;
    strcpy(grid.embedding, "map grid=3x3 last=mean centred");
    strcpy(bands.embedding, "map grid=3x1 last=mean centred");
    bands.dim = 6; /* explained by the definition */
    assert_differ(&grid, &bands,
                  "embedding is map grid=3x3 last=mean centred in one and map grid=3x1 last=mean"
                  " centred in the other");
    assert_differ(&plain, &grid,
                  "embedding is one whole output in one and map grid=3x3 last=mean centred in the"
                  " other");
    /* Not known without the size: to a file of ranges, for instance. */
    plain.dim = 0;
    assert_int_equal(vdna_identity_compare(&plain, &grid, NULL), VDNA_OK);
    assert_int_equal(vdna_identity_compare(&grid, &plain, NULL), VDNA_OK);
}

/* Of six numbers the first three, then the sum of all. */
static const float directions[5][6] = {
    {1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}, {1, 1, 1, 1, 1, 1}, {0}};

static vdna_identity projected(void)
{
    vdna_identity identity = sample;
    identity.projection = directions[0];
    identity.raw_dim = 6;
    return identity;
}

static void a_projection_makes_fewer_numbers_and_is_finite(void **state)
{
    (void)state;
    vdna_identity i = projected();
    assert_int_equal(vdna_identity_check(&i, NULL), VDNA_OK);
    i.raw_dim = 4;
    assert_refused(&i, VDNA_ERR_ARG, "the projection has directions and makes 5 of 4 numbers");
    i.raw_dim = 0;
    assert_refused(&i, VDNA_ERR_ARG, "makes 5 of 0 numbers, expected 1 to all of them, or 0 and");
    i = projected();
    i.dim = 0;
    assert_refused(&i, VDNA_ERR_ARG, "makes 0 of 6 numbers");
    i = projected();
    i.projection = NULL;
    assert_refused(&i, VDNA_ERR_ARG, "the projection has no directions and makes 5 of 6 numbers");
    const float infinite[] = {0, 1, INFINITY, 0};
    i.projection = infinite;
    i.dim = i.raw_dim = 2;
    assert_refused(&i, VDNA_ERR_ARG, "direction 1 of the projection has a NaN or an infinity");
}

static void maps_of_two_projections_do_not_compare(void **state)
{
    (void)state;
    float other[5][6];
    memcpy(other, directions, sizeof other);
    other[3][2] = -1;
    vdna_identity a = projected(), b = projected(), none = sample;
    assert_int_equal(vdna_identity_compare(&a, &b, NULL), VDNA_OK);
    b.projection = other[0];
    assert_differ(&a, &b,
                  "number 2 of direction 3 of the projection is 1 in one and -1 in the other");
    b.dim = 4;
    assert_differ(&a, &b,
                  "projection is of 6 numbers to 5 in one and of 6 numbers to 4 in the"
                  " other");
    none.dim = 6;
    assert_differ(&none, &a, "projection is none in one and of 6 numbers to 5 in the other");
    assert_differ(&a, &sample, "dim is 6 in one and 5 in the other");
}

static void a_backbone_compares_with_maps_of_its_embeddings_projected_or_not(void **state)
{
    (void)state;
    vdna_identity backbone = sample;
    backbone.dim = 6;
    backbone.bins = 0;
    backbone.range = NULL;
    const vdna_identity map = projected();
    assert_int_equal(vdna_identity_compare(&backbone, &map, NULL), VDNA_OK);
    assert_int_equal(vdna_identity_compare(&map, &backbone, NULL), VDNA_OK);
    backbone.dim = 5;
    assert_differ(&map, &backbone, "dim is 6 in one and 5 in the other");
}

static void a_live_embedding_is_projected_as_the_map_keeps_it(void **state)
{
    (void)state;
    const float embedding[] = {1, 2, 4, 8, 16, 32}, expected[] = {1, 2, 4, 63, 0};
    float out[5];
    const vdna_identity map = projected();
    assert_int_equal(vdna_identity_project(&map, embedding, out), VDNA_OK);
    assert_memory_equal(out, expected, sizeof out);
    assert_int_equal(vdna_identity_project(&sample, embedding, out), VDNA_OK);
    assert_memory_equal(out, embedding, sizeof out);

    /* In double precision: floats would lose the 1. */
    const float far[] = {1, 1e12f, 1, -1e12f, 0, 0};
    assert_int_equal(vdna_identity_project(&map, far, out), VDNA_OK);
    assert_true(out[3] == 2);

    assert_int_equal(vdna_identity_project(NULL, embedding, out), VDNA_ERR_ARG);
    assert_int_equal(vdna_identity_project(&map, NULL, out), VDNA_ERR_ARG);
    assert_int_equal(vdna_identity_project(&map, embedding, NULL), VDNA_ERR_ARG);
}

static void the_last_word_says_whether_embeddings_are_centred(void **state)
{
    (void)state;
    static const char *const no[] = {"",         "map",           "map grid=3x3",        "centred",
                                     " centred", "map uncentred", "map centred grid=3x3"};
    vdna_identity i = sample;
    for (size_t n = 0; n < sizeof no / sizeof *no; n++) {
        strcpy(i.embedding, no[n]);
        assert_int_equal(vdna_identity_is_centred(&i), 0);
    }
    strcpy(i.embedding, "map grid=3x3 centred");
    assert_int_equal(vdna_identity_is_centred(&i), 1);
    assert_int_equal(vdna_identity_is_centred(NULL), 0);
}

static void a_field_unknown_to_one_side_is_not_compared(void **state)
{
    (void)state;
    vdna_identity open = sample;
    open.dim = open.bins = 0;
    open.range = NULL;
    strcpy(open.backbone, "renamed");
    assert_int_equal(vdna_identity_compare(&sample, &open, NULL), VDNA_OK);
    assert_int_equal(vdna_identity_compare(&open, &sample, NULL), VDNA_OK);
    assert_int_equal(vdna_identity_compare(NULL, &sample, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_identity_compare(&sample, NULL, NULL), VDNA_ERR_ARG);
}

static void the_text_has_a_line_for_each_field(void **state)
{
    (void)state;
    char text[VDNA_IDENTITY_TEXT_SIZE];
    assert_int_equal(vdna_identity_text(&sample, text), VDNA_OK);
    assert_string_equal(text, "vdna-comparable 1\n" SHA256 "\n"
                              "rgb 8x8 \"area\" mean=0 std=1 \\\nmid:2:4,top:1:1\n5\n4\n");
    vdna_identity defined = sample;
    strcpy(defined.embedding, "map grid=3x3 centred");
    assert_int_equal(vdna_identity_text(&defined, text), VDNA_OK);
    assert_string_equal(text, "vdna-comparable 2\n" SHA256 "\n"
                              "rgb 8x8 \"area\" mean=0 std=1 \\\nmid:2:4,top:1:1\n5\n4\n"
                              "map grid=3x3 centred\n");
    const vdna_identity map = projected();
    assert_int_equal(vdna_identity_text(&map, text), VDNA_OK);
    assert_string_equal(text, "vdna-comparable 3\n" SHA256 "\n"
                              "rgb 8x8 \"area\" mean=0 std=1 \\\nmid:2:4,top:1:1\n5\n4\n\n6\n");
    assert_int_equal(vdna_identity_text(NULL, text), VDNA_ERR_ARG);
    assert_int_equal(vdna_identity_text(&sample, NULL), VDNA_ERR_ARG);
}

static void the_longest_identity_has_room_in_its_text(void **state)
{
    (void)state;
    char text[VDNA_IDENTITY_TEXT_SIZE];
    vdna_identity longest = sample;
    memset(longest.preprocessing, 'p', sizeof longest.preprocessing - 1);
    memset(longest.taps, 't', sizeof longest.taps - 1);
    longest.dim = longest.bins = UINT32_MAX;
    memset(longest.embedding, 'e', sizeof longest.embedding - 1);
    assert_int_equal(vdna_identity_text(&longest, text), VDNA_OK);
    const char end[] = "e\n";
    assert_int_equal(strlen(text), 18 + 65 + 512 + 2048 + 11 + 11 + 256);
    assert_string_equal(text + strlen(text) - strlen(end), end);
    longest.projection = directions[0];
    longest.raw_dim = UINT32_MAX;
    assert_int_equal(vdna_identity_text(&longest, text), VDNA_OK);
    assert_int_equal(strlen(text), 18 + 65 + 512 + 2048 + 11 + 11 + 256 + 11);
    assert_string_equal(text + strlen(text) - 13, "e\n4294967295\n");
}

static void the_hash_is_that_of_the_specification(void **state)
{
    (void)state;
    char sha256[VDNA_SHA256_SIZE];
    assert_int_equal(vdna_identity_hash(&sample, sha256), VDNA_OK);
    assert_string_equal(sha256, "33eb312321a71d537313127f48a50950d6620be9c61d9d81abd40b07496209eb");
    /* By Python's hashlib. */
    const vdna_identity map = projected();
    assert_int_equal(vdna_identity_hash(&map, sha256), VDNA_OK);
    assert_string_equal(sha256, "d7fcf9561b38a82e7adb99c10fbd0dc44cc1e30677e966b9a9133e7b990c44f7");
}

static void an_identity_that_is_not_complete_has_no_hash(void **state)
{
    (void)state;
    char sha256[VDNA_SHA256_SIZE] = "untouched";
    vdna_identity open[3] = {sample, sample, sample};
    open[0].dim = 0;
    open[1].bins = 0;
    open[2].range = NULL;
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(vdna_identity_hash(&open[i], sha256), VDNA_ERR_ARG);
    assert_int_equal(vdna_identity_hash(NULL, sha256), VDNA_ERR_ARG);
    assert_int_equal(vdna_identity_hash(&sample, NULL), VDNA_ERR_ARG);
    assert_string_equal(sha256, "untouched");
}

static void assert_tap(const char **text, const char *name, uint32_t neurons, uint32_t samples)
{
    vdna_tap tap;
    assert_int_equal(vdna_taps_next(text, &tap), VDNA_OK);
    assert_int_equal(tap.name_length, strlen(name));
    assert_memory_equal(tap.name, name, tap.name_length);
    assert_int_equal(tap.neurons, neurons);
    assert_int_equal(tap.samples, samples);
}

static void taps_are_read_one_by_one_and_their_names_may_hold_colons(void **state)
{
    (void)state;
    const char *rest = "mid:2:4,block:11:out:768:197,1:4294967295:1";
    vdna_tap tap;
    assert_tap(&rest, "mid", 2, 4);
    assert_tap(&rest, "block:11:out", 768, 197);
    assert_tap(&rest, "1", UINT32_MAX, 1);
    assert_int_equal(vdna_taps_next(&rest, &tap), VDNA_ERR_EMPTY);
}

static void invalid_taps_are_refused_and_not_skipped(void **state)
{
    (void)state;
    static const char *const lists[] = {
        "a",
        "a:1",
        ":1:1",
        "a:1:",
        "a::1",
        "a:1:-1",
        "a:x:1",
        "1:1",
        "a:0:1",
        "a:1:0",
        "a:01:1",
        "a:1:01",
        ",",
        "a:1:1,",
        ",a:1:1",
        "a:1 :1",
        ":::",
        "a:4294967296:1",
        "a:1:99999999999",
        "11:1",
    };
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        const char *rest = lists[i];
        vdna_tap tap = {NULL, 7, 7, 7};
        if (vdna_taps_next(&rest, &tap) != VDNA_ERR_FORMAT)
            fail_msg("taken for a tap: %s", lists[i]);
        assert_ptr_equal(rest, lists[i]);
        assert_int_equal(tap.neurons, 7);
    }
    const char *none = NULL, *some = "a:1:1";
    vdna_tap tap;
    assert_int_equal(vdna_taps_next(NULL, &tap), VDNA_ERR_ARG);
    assert_int_equal(vdna_taps_next(&none, &tap), VDNA_ERR_ARG);
    assert_int_equal(vdna_taps_next(&some, NULL), VDNA_ERR_ARG);
}

static void taps_are_written_as_they_are_read(void **state)
{
    (void)state;
    const char list[] = "mid:2:4,block:11:out:768:197,1:4294967295:4294967295";
    char text[sizeof list] = "";
    const char *rest = list;
    for (vdna_tap tap; vdna_taps_next(&rest, &tap) == VDNA_OK;)
        assert_int_equal(vdna_taps_append(text, sizeof text, &tap), VDNA_OK);
    assert_string_equal(text, list);
}

static void a_tap_that_cannot_be_read_back_is_not_written(void **state)
{
    (void)state;
    const vdna_tap good = {"top", 3, 1, 1};
    vdna_tap bad[7] = {good, good, good, good, good, good, good};
    bad[0].name = NULL;
    bad[1].name_length = 0;
    bad[2].neurons = 0;
    bad[3].samples = 0;
    bad[4].name = "t,p";
    bad[5].name = "t\np";
    bad[6].name = "t\xC3\xA9";
    char text[32] = "mid:2:4";
    for (size_t i = 0; i < 7; i++)
        assert_int_equal(vdna_taps_append(text, sizeof text, &bad[i]), VDNA_ERR_ARG);
    assert_int_equal(vdna_taps_append(text, sizeof text, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_taps_append(NULL, sizeof text, &good), VDNA_ERR_ARG);
    assert_string_equal(text, "mid:2:4");
}

static void a_list_of_taps_may_fill_its_room_to_the_last_byte(void **state)
{
    (void)state;
    const vdna_tap tap = {"top", 3, 1, 1};
    char text[] = "mid:2:4\0.top:1:1";
    for (size_t size = 0; size < sizeof "mid:2:4,top:1:1"; size++)
        assert_int_equal(vdna_taps_append(text, size, &tap), VDNA_ERR_NOMEM);
    assert_string_equal(text, "mid:2:4");
    assert_int_equal(vdna_taps_append(text, sizeof "mid:2:4,top:1:1", &tap), VDNA_OK);
    assert_string_equal(text, "mid:2:4,top:1:1");
    assert_int_equal(vdna_taps_append(text, sizeof text, &tap), VDNA_ERR_NOMEM);
}

static void a_name_has_letters_digits_and_three_marks_only(void **state)
{
    (void)state;
    static const char allowed[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZ.abcdefghijklmnopqrstuvwxyz_0123456789-";
    for (int c = 1; c < 256; c++) {
        char name[] = {'a', (char)c, '\0'};
        const int is_allowed = strchr(allowed, c) != NULL;
        assert_int_equal(vdna_name_check(name, NULL), is_allowed ? VDNA_OK : VDNA_ERR_ARG);
        vdna_name_replace(name);
        assert_int_equal(name[1], is_allowed ? (char)c : '_');
        assert_int_equal(name[0], 'a');
    }
    vdna_name_replace(NULL);
}

static void a_name_has_one_to_63_characters(void **state)
{
    (void)state;
    vdna_error error;
    char name[VDNA_NAME_SIZE];
    memset(name, 'n', sizeof name);
    assert_int_equal(vdna_name_check(name, &error), VDNA_ERR_ARG);
    assert_string_equal(error.text,
                        "is too long, expected 1 to 63 letters, digits, '.', '_' or '-'");
    name[63] = '\0';
    assert_int_equal(vdna_name_check(name, NULL), VDNA_OK);
    assert_int_equal(vdna_name_check("", &error), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "is empty"));
    assert_int_equal(vdna_name_check(NULL, &error), VDNA_ERR_ARG);
    assert_non_null(strstr(error.text, "is missing"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_identity_may_leave_open_what_is_not_known_yet),
        cmocka_unit_test(a_text_that_breaks_its_alphabet_is_refused_by_name),
        cmocka_unit_test(a_sha256_has_lower_case_hexadecimal_digits_only),
        cmocka_unit_test(numbers_that_break_a_rule_are_refused),
        cmocka_unit_test(a_precision_that_is_not_stated_is_fp32),
        cmocka_unit_test(a_comparison_names_the_first_difference_and_both_values),
        cmocka_unit_test(a_precision_that_explains_different_models_is_reported_instead),
        cmocka_unit_test(long_values_are_shown_from_where_they_differ),
        cmocka_unit_test(embeddings_that_are_made_differently_do_not_compare),
        cmocka_unit_test(a_projection_makes_fewer_numbers_and_is_finite),
        cmocka_unit_test(maps_of_two_projections_do_not_compare),
        cmocka_unit_test(a_backbone_compares_with_maps_of_its_embeddings_projected_or_not),
        cmocka_unit_test(a_live_embedding_is_projected_as_the_map_keeps_it),
        cmocka_unit_test(the_last_word_says_whether_embeddings_are_centred),
        cmocka_unit_test(a_field_unknown_to_one_side_is_not_compared),
        cmocka_unit_test(the_text_has_a_line_for_each_field),
        cmocka_unit_test(the_longest_identity_has_room_in_its_text),
        cmocka_unit_test(the_hash_is_that_of_the_specification),
        cmocka_unit_test(an_identity_that_is_not_complete_has_no_hash),
        cmocka_unit_test(taps_are_read_one_by_one_and_their_names_may_hold_colons),
        cmocka_unit_test(invalid_taps_are_refused_and_not_skipped),
        cmocka_unit_test(taps_are_written_as_they_are_read),
        cmocka_unit_test(a_tap_that_cannot_be_read_back_is_not_written),
        cmocka_unit_test(a_list_of_taps_may_fill_its_room_to_the_last_byte),
        cmocka_unit_test(a_name_has_letters_digits_and_three_marks_only),
        cmocka_unit_test(a_name_has_one_to_63_characters),
    };
    return cmocka_run_group_tests_name("identity", tests, NULL, NULL);
}
