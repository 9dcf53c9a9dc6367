/* Experience files: written ones are read back, and only valid ones are read. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <sys/stat.h>

#include "cmocka_all.h"
#include "edited_file.h"

static int set_up(void **state)
{
    set_up_file(state);
    edited_file *f = *state;
    const vdna_experience sample = sample_experience();
    const char *path = path_in(&f->directory, "sample");
    if (vdna_experience_write(&sample, path, NULL) != VDNA_OK)
        return -1;
    f->size = load_file(path, f->bytes, sizeof f->bytes);
    return 0;
}

static vdna_status open_bytes(const edited_file *f, vdna_error *error, vdna_experience *out)
{
    return vdna_experience_open(save_edited(f), error, out);
}

static void assert_opens(const edited_file *f)
{
    vdna_error error = {""};
    vdna_experience e;
    const vdna_status status = open_bytes(f, &error, &e);
    if (status != VDNA_OK)
        fail_msg("refused: %s", error.text);
    vdna_experience_close(&e);
}

static void assert_refused(const edited_file *f, vdna_status expected, const char *reason)
{
    refusal_by(vdna_experience_open, f, expected, reason);
}

static void what_is_written_is_read_back(void **state)
{
    const edited_file *f = *state;
    const vdna_experience sample = sample_experience();
    vdna_experience e;
    assert_int_equal(vdna_experience_open(path_in(&f->directory, "sample"), NULL, &e), VDNA_OK);
    assert_string_equal(e.name, sample.name);
    assert_string_equal(e.identity.backbone, sample.identity.backbone);
    assert_string_equal(e.identity.model_sha256, sample.identity.model_sha256);
    assert_string_equal(e.identity.preprocessing, sample.identity.preprocessing);
    assert_string_equal(e.identity.taps, sample.identity.taps);
    assert_int_equal(e.identity.neurons, 3);
    assert_int_equal(e.identity.bins, 4);
    assert_int_equal(e.frames, 2);
    assert_int_equal(e.identity.dim, 5);
    assert_memory_equal(e.identity.range, sample.identity.range, 3 * 2 * sizeof(float));
    assert_memory_equal(e.counts, sample.counts, 4 * 3 * sizeof(uint32_t));
    assert_memory_equal(e.mass, sample.mass, 3 * sizeof(uint32_t));
    assert_memory_equal(e.embeddings, sample.embeddings, 2 * 5 * sizeof(float));
    assert_memory_equal(e.frame_utime, sample.frame_utime, 2 * sizeof(int64_t));
    assert_memory_equal(e.frame_place, sample.frame_place, 2 * sizeof(int64_t));
    assert_memory_equal(e.frame_position, sample.frame_position, 2 * 3 * sizeof(double));
    assert_memory_equal(e.frame_grey, sample.frame_grey, 2 * sizeof(float));
    assert_string_equal(e.position_frame, "local");
    assert_string_equal(e.order, "utime");
    assert_int_equal(e.file_size, f->size);
    assert_memory_equal(e.file_bytes, f->bytes, f->size);

    vdna_hist_view view;
    vdna_experience_view(&e, &view);
    assert_ptr_equal(view.counts, e.counts);
    assert_ptr_equal(view.mass, e.mass);
    assert_ptr_equal(view.range, e.identity.range);
    assert_int_equal(view.neurons, 3);
    assert_int_equal(view.bins, 4);
    const vdna_hist_view seen = view;
    vdna_experience_view(NULL, &view);
    vdna_experience_view(&e, NULL);
    assert_memory_equal(&view, &seen, sizeof view);
    vdna_experience_close(&e);
    assert_null(e.file_bytes);
    assert_int_equal(e.file_size, 0);
    vdna_experience_close(&e);
    vdna_experience_close(NULL);
}

static void an_experience_needs_no_places_and_no_positions(void **state)
{
    const edited_file *f = *state;
    const char *path = path_in(&f->directory, "bare");
    vdna_experience sample = sample_experience(), e;
    sample.frame_place = NULL;
    sample.frame_position = NULL;
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_null(e.frame_place);
    assert_null(e.frame_position);
    assert_string_equal(e.position_frame, "");
    assert_int_equal(e.frame_utime[1], 1033333);
    vdna_experience_close(&e);
}

static void a_precision_is_kept_and_defaults_to_fp32(void **state)
{
    const edited_file *f = *state;
    const char *path = path_in(&f->directory, "int8");
    vdna_experience sample = sample_experience(), e;
    assert_int_equal(vdna_experience_open(path_in(&f->directory, "sample"), NULL, &e), VDNA_OK);
    assert_string_equal(e.identity.precision, "fp32");
    vdna_experience_close(&e);

    strcpy(sample.identity.precision, "int8");
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_string_equal(e.identity.precision, "int8");
    vdna_experience_close(&e);

    strcpy(sample.identity.precision, "int 8");
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_ERR_ARG);
}

static void the_longest_taps_are_kept(void **state)
{
    const edited_file *f = *state;
    const char *path = path_in(&f->directory, "tapped");
    static const char rest[] = ":2:4,top:1:1";
    vdna_experience sample = sample_experience(), e;
    /* Escaped in the file, each of these takes two bytes. */
    memset(sample.identity.taps, '"', sizeof sample.identity.taps - sizeof rest);
    memcpy(sample.identity.taps + sizeof sample.identity.taps - sizeof rest, rest, sizeof rest);
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_string_equal(e.identity.taps, sample.identity.taps);
    vdna_experience_close(&e);
}

static void the_checksum_is_crc32c_of_all_before_it(void **state)
{
    const edited_file *f = *state;
    assert_int_equal(crc32c((const unsigned char *)"123456789", 9), 0xE3069283);
    uint32_t written;
    memcpy(&written, f->bytes + f->size - 4, sizeof written);
    assert_int_equal(written, crc32c(f->bytes, f->size - 4));
}

static void every_other_spelling_of_the_header_opens(void **state)
{
    static const struct {
        const char *from, *to;
    } edits[] = {
        {"\"name\":\"winter\"", "\"name\" :\n\t\"\\u0077in\\u0074er\"\r"},
        {"mean=0", "mean\\u003D0"},
        {"\"backbone\"", "\"b\\u0061ckbone\""},
        {"\"mass\":{\"dtype\":\"U32\",\"shape\":[3],",
         "\"mass\":{\"shape\":[ 3 ],\"dtype\":\"U32\","},
        /* Additions of others: a text with two, three and four bytes and escapes, a tensor. */
        {"{\"format\"",
         "{\"note\":\"\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\\n\\\"\\/\\ud83d\\ude00\","
         "\"format\""},
        {"\"mass\":",
         "\"mean\":{\"dtype\":\"BF16\",\"shape\":[0,7],\"data_offsets\":[0,0]},\"mass\":"},
        {"\"mass\":",
         "\"scalar\":{\"dtype\":\"F64\",\"shape\":[],\"data_offsets\":[80,80]},\"mass\":"},
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = *(const edited_file *)*state;
        edit_header(&f, edits[i].from, edits[i].to);
        assert_opens(&f);
    }
}

/* Write positions whose frame is not said, in a file or in a struct; the frame that is read. */
static void assert_frame(const edited_file *f, const double position[2][3], const char *expected)
{
    const char *path = path_in(&f->directory, "positions");
    vdna_experience sample = sample_experience(), e;
    sample.frame_position = position[0];
    sample.position_frame[0] = '\0';
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_string_equal(e.position_frame, expected);
    vdna_experience_close(&e);
}

static void positions_near_the_surface_of_the_earth_are_of_gps_if_nothing_is_said(void **state)
{
    const double gps[2][3] = {{6378137, 0, 0}, {0, 0, -6356752}},
                 half[2][3] = {{6378137, 0, 0}, {1, 2, 3}},
                 one[2][3] = {{NAN, NAN, NAN}, {0, 6.4e6, 0}}, low[2][3] = {{0, 6.29e6, 0}},
                 high[2][3] = {{0, 6.51e6, 0}, {0, 6.4e6, 0}};
    assert_frame(*state, gps, "wgs84");
    assert_frame(*state, one, "wgs84");
    assert_frame(*state, half, "local");
    assert_frame(*state, low, "local");
    assert_frame(*state, high, "local");
}

static void a_file_that_does_not_say_the_frame_is_read_as_before(void **state)
{
    edited_file f = *(const edited_file *)*state;
    vdna_experience e;
    edit_header(&f, ",\"position_frame\":\"local\",\"order\":\"utime\"", "");
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_string_equal(e.position_frame, "local");
    assert_string_equal(e.order, "");
    vdna_experience_close(&e);
}

static void frames_may_lack_the_truth_that_others_have_since_version_2(void **state)
{
    const edited_file *f = *state;
    const char *path = path_in(&f->directory, "gaps");
    const int64_t place[] = {VDNA_PLACE_NONE, 3};
    const double position[2][3] = {{1, 2, 3}, {NAN, NAN, NAN}};
    vdna_experience sample = sample_experience(), e;
    sample.frame_position = position[0];
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_true(e.frame_position[2] == 3 && isnan(e.frame_position[3]));
    const char *const header = (const char *)e.file_bytes + 8;
    assert_non_null(strstr(header, "\"format_version\":\"2\""));
    vdna_experience_close(&e);

    sample = sample_experience();
    sample.frame_place = place;
    assert_int_equal(vdna_experience_write(&sample, path, NULL), VDNA_OK);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    assert_true(e.frame_place[0] == VDNA_PLACE_NONE && e.frame_place[1] == 3);
    assert_non_null(strstr((const char *)e.file_bytes + 8, "\"format_version\":\"2\""));
    vdna_experience_close(&e);
}

/* Put an experience's file in place of the sample's. */
static void load(edited_file *f, vdna_experience e)
{
    const char *path = path_in(&f->directory, "other");
    assert_int_equal(vdna_experience_write(&e, path, NULL), VDNA_OK);
    f->size = load_file(path, f->bytes, sizeof f->bytes);
}

static void a_second_embedding_is_kept_since_version_3(void **state)
{
    edited_file f = *(const edited_file *)*state;
    const vdna_experience grid = grid_experience();
    vdna_experience e;
    load(&f, grid);
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_string_equal(e.identity.embedding, "mid grid=1x5 last=top centred");
    assert_int_equal(e.last_layer_dim, 7);
    assert_memory_equal(e.last_layer, grid.last_layer, 2 * 7);
    assert_memory_equal(e.last_layer_scale, grid.last_layer_scale, 2 * sizeof(float));
    assert_null(e.embedding_codes);
    assert_non_null(strstr((const char *)e.file_bytes + 8, "\"format_version\":\"3\""));
    vdna_experience_close(&e);

    /* It alone is enough, and a definition without it. */
    vdna_experience either = grid;
    either.identity.embedding[0] = '\0';
    load(&f, either);
    assert_non_null(strstr((const char *)f.bytes + 8, "\"format_version\":\"3\""));
    either = sample_experience();
    strcpy(either.identity.embedding, "mid grid=1x5");
    load(&f, either);
    assert_non_null(strstr((const char *)f.bytes + 8, "\"format_version\":\"3\""));

    /* Without either it is an older file, and says nothing of it. */
    assert_int_equal(vdna_experience_open(path_in(&f.directory, "sample"), NULL, &e), VDNA_OK);
    assert_string_equal(e.identity.embedding, "");
    assert_true(!e.last_layer && !e.last_layer_scale && e.last_layer_dim == 0);
    vdna_experience_close(&e);
}

/* With one of the three changed. */
static uint32_t counts_last_layer(const char *taps, uint32_t dim, const char *embedding)
{
    vdna_experience e = grid_experience();
    strcpy(e.identity.taps, taps);
    strcpy(e.identity.embedding, embedding);
    e.last_layer_dim = dim;
    return vdna_experience_counts_last_layer(&e);
}

static void the_last_layer_stands_for_the_activations_where_it_is_the_only_tap(void **state)
{
    (void)state;
    assert_int_equal(counts_last_layer("top:7:1", 7, "mid grid=1x5 last=top centred"), 1);
    assert_int_equal(counts_last_layer("top:7:1", 7, "mid last=top"), 1);
    assert_int_equal(counts_last_layer("top:7:1", 7, "mid last=topmost"), 0);
    assert_int_equal(counts_last_layer("top:7:1", 7, "mid last=to"), 0);
    assert_int_equal(counts_last_layer("top:7:1", 7, "mid grid=1x5"), 0);
    assert_int_equal(counts_last_layer("top:7:1", 7, ""), 0);
    assert_int_equal(counts_last_layer("top:7:4", 7, "mid last=top"), 0);
    assert_int_equal(counts_last_layer("top:6:1", 7, "mid last=top"), 0);
    assert_int_equal(counts_last_layer("mid:2:4,top:7:1", 7, "mid last=top"), 0);
    assert_int_equal(counts_last_layer("top:7:1,mid:2:4", 7, "mid last=top"), 0);
    assert_int_equal(counts_last_layer("", 7, "mid last=top"), 0);
    assert_int_equal(vdna_experience_counts_last_layer(NULL), 0);
    const vdna_experience without = sample_experience();
    assert_int_equal(vdna_experience_counts_last_layer(&without), 0);
}

static void embeddings_stored_as_codes_are_read_as_floats(void **state)
{
    edited_file f = *(const edited_file *)*state;
    const vdna_experience coded = coded_experience();
    vdna_experience e;
    load(&f, coded);
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_int_equal(e.identity.dim, 5);
    assert_memory_equal(e.embeddings, coded.embeddings, 2 * 5 * sizeof(float));
    assert_memory_equal(e.embedding_codes, coded.embedding_codes, 2 * 5);
    assert_memory_equal(e.embedding_scale, coded.embedding_scale, 2 * sizeof(float));
    const char *const header = (const char *)e.file_bytes + 8;
    assert_null(strstr(header, "\"embeddings\""));
    assert_non_null(strstr(header, "\"format_version\":\"3\""));
    vdna_experience_close(&e);
    assert_null(e.embeddings);

    /* They compare with those that are stored as floats, and codes alone make version 3. */
    const vdna_experience grid = grid_experience();
    assert_int_equal(vdna_experience_compare(&coded, &grid, NULL), VDNA_OK);
    vdna_experience plain = coded_experience();
    plain.identity.embedding[0] = '\0';
    plain.last_layer = NULL;
    plain.last_layer_scale = NULL;
    plain.last_layer_dim = 0;
    load(&f, plain);
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_non_null(strstr((const char *)e.file_bytes + 8, "\"format_version\":\"3\""));
    vdna_experience_close(&e);
}

static void a_projection_is_kept_since_version_4(void **state)
{
    edited_file f = *(const edited_file *)*state;
    const vdna_experience projected = projected_experience();
    vdna_experience e;
    load(&f, projected);
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_int_equal(e.identity.dim, 5);
    assert_int_equal(e.identity.raw_dim, 6);
    assert_memory_equal(e.identity.projection, projected.identity.projection, 30 * sizeof(float));
    assert_memory_equal(e.embeddings, projected.embeddings, 2 * 5 * sizeof(float));
    assert_non_null(strstr((const char *)e.file_bytes + 8, "\"format_version\":\"4\""));
    assert_int_equal(vdna_experience_compare(&e, &projected, NULL), VDNA_OK);
    vdna_experience_close(&e);

    /* Files without one are as old as before, and say nothing of it. */
    assert_int_equal(vdna_experience_open(path_in(&f.directory, "sample"), NULL, &e), VDNA_OK);
    assert_true(!e.identity.projection && e.identity.raw_dim == 0);
    vdna_experience_close(&e);
}

static void a_projection_that_breaks_a_rule_is_refused(void **state)
{
    static const struct {
        const char *from, *to, *reason;
    } edits[] = {
        {"\"shape\":[5,6]", "\"shape\":[6,5]", "tensor projection has a dtype or shape"},
        {"\"shape\":[5,6]", "\"shape\":[30]", "tensor projection has a shape that does not fit"},
        {"\"shape\":[5,6]", "\"shape\":[5,4]", "tensor projection has 120 bytes, expected 20"},
        {"\"projection\":{\"dtype\":\"F32\"", "\"projection\":{\"dtype\":\"I32\"",
         "tensor projection has a dtype"},
        {"\"projection\":", "\"acme_projection\":", "comparable is not"},
    };
    edited_file projected = *(const edited_file *)*state;
    load(&projected, projected_experience());
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = projected;
        edit_header(&f, edits[i].from, edits[i].to);
        assert_refused(&f, VDNA_ERR_FORMAT, edits[i].reason);
    }
    const float nan = NAN, other = 0.25f;
    edited_file f = projected;
    edit_data(&f, "projection", 8, &nan, 4);
    assert_refused(&f, VDNA_ERR_FORMAT, "direction 1 of the projection has a NaN or an infinity");
    edit_data(&projected, "projection", 8, &other, 4);
    assert_refused(&projected, VDNA_ERR_FORMAT, "comparable is not");
}

static void codes_that_break_a_rule_are_refused(void **state)
{
    static const struct {
        const char *from, *to, *reason;
    } edits[] = {
        {"\"frame_last_layer\":", "\"acme_last_layer\":", "the last layer has no codes, scales"},
        {"\"frame_last_layer_scale\":", "\"acme_last_layer_scale\":",
         "the last layer has codes, no scales and 7 numbers"},
        {"\"shape\":[2,7]", "\"shape\":[7,2]", "tensor frame_last_layer has a dtype or shape"},
        {"\"shape\":[2,7]", "\"shape\":[14]", "tensor frame_last_layer has a shape"},
        {"\"frame_last_layer\":{\"dtype\":\"I8\"", "\"frame_last_layer\":{\"dtype\":\"U8\"",
         "tensor frame_last_layer has a dtype"},
        {"\"frame_embedding\":", "\"acme_embedding\":", "tensor embeddings is missing"},
        {"\"frame_embedding_scale\":", "\"acme_embedding_scale\":",
         "frame_embedding_scale is missing"},
        {"mid grid", "mid\\tgrid", "embedding has a character"},
        {"mid grid=1x5", "mid grid=" SAMPLE_SHA256 SAMPLE_SHA256 SAMPLE_SHA256 SAMPLE_SHA256,
         "embedding in __metadata__ is too long, expected at most 255 bytes"},
        {"mid grid=1x5 last=top centred", "mid grid=1x5 last=top", "comparable is not"},
    };
    const float nan = NAN, infinity = INFINITY, negative = -1, huge = 1e13f;
    edited_file coded = *(const edited_file *)*state;
    load(&coded, coded_experience());
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = coded;
        edit_header(&f, edits[i].from, edits[i].to);
        assert_refused(&f, VDNA_ERR_FORMAT, edits[i].reason);
    }
    static const char *const scales[] = {"frame_embedding_scale", "frame_last_layer_scale"};
    const float *const bad[] = {&nan, &infinity, &negative, &huge};
    for (size_t i = 0; i < 8; i++) {
        edited_file f = coded;
        char reason[64];
        snprintf(reason, sizeof reason, "%s of frame 1 is ", scales[i % 2]);
        edit_data(&f, scales[i % 2], 1, bad[i / 2], 4);
        assert_refused(&f, VDNA_ERR_FORMAT, reason);
    }
}

static void assert_thumbnail(const vdna_experience *e, uint32_t frame, const char *expected)
{
    const uint8_t *jpeg = NULL;
    size_t size = 0;
    assert_int_equal(vdna_experience_thumbnail(e, frame, &jpeg, &size), VDNA_OK);
    assert_int_equal(size, strlen(expected));
    assert_memory_equal(jpeg, expected, size);
}

static void assert_no_thumbnail(const vdna_experience *e, uint32_t frame, vdna_status expected)
{
    const uint8_t *jpeg = NULL;
    size_t size = 77;
    assert_int_equal(vdna_experience_thumbnail(e, frame, &jpeg, &size), expected);
    assert_true(!jpeg && size == 77);
}

static void thumbnails_and_a_source_are_kept_and_change_nothing_else(void **state)
{
    edited_file f = *(const edited_file *)*state;
    const vdna_experience pictured = pictured_experience(), sample = sample_experience();
    vdna_experience e, plain;
    load(&f, pictured);
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_string_equal(e.source, pictured.source);
    assert_int_equal(e.thumbnail_bytes, 8);
    assert_thumbnail(&e, 0, "one");
    assert_thumbnail(&e, 1, "three");
    assert_no_thumbnail(&e, 2, VDNA_ERR_ARG);
    assert_non_null(strstr((const char *)e.file_bytes + 8, "\"format_version\":\"1\""));

    assert_int_equal(vdna_experience_open(path_in(&f.directory, "sample"), NULL, &plain), VDNA_OK);
    assert_string_equal(e.comparable, plain.comparable);
    assert_string_equal(plain.source, "");
    assert_true(!plain.thumbnails && !plain.thumbnail_end && plain.thumbnail_bytes == 0);
    assert_no_thumbnail(&plain, 0, VDNA_ERR_EMPTY);
    assert_memory_equal(e.embeddings, sample.embeddings, 2 * 5 * sizeof(float));
    vdna_experience_close(&plain);
    vdna_experience_close(&e);

    const uint32_t none_of_the_first[2] = {0, 8};
    vdna_experience gap = pictured;
    gap.thumbnail_end = none_of_the_first;
    load(&f, gap);
    assert_int_equal(open_bytes(&f, NULL, &e), VDNA_OK);
    assert_no_thumbnail(&e, 0, VDNA_ERR_EMPTY);
    assert_thumbnail(&e, 1, "onethree");
    const uint8_t *jpeg;
    size_t size;
    assert_int_equal(vdna_experience_thumbnail(NULL, 0, &jpeg, &size), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_thumbnail(&e, 0, NULL, &size), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_thumbnail(&e, 0, &jpeg, NULL), VDNA_ERR_ARG);
    vdna_experience_close(&e);
}

static void thumbnails_and_sources_that_break_a_rule_are_refused(void **state)
{
    static const struct {
        const char *from, *to, *reason;
    } edits[] = {
        {"\"thumbnails\":", "\"acme_thumbnails\":", "have no pictures, ends and 0 bytes"},
        {"\"frame_thumbnail_end\":", "\"acme_end\":", "have pictures, no ends and 8 bytes"},
        {"\"shape\":[8]", "\"shape\":[8,1]", "tensor thumbnails has a shape"},
        {"\"shape\":[8]", "\"shape\":[0]", "tensor thumbnails has a shape"},
        {"\"shape\":[8]", "\"shape\":[4294967304]", "tensor thumbnails has a shape"},
        {"\"shape\":[8]", "\"shape\":[9]", "tensor thumbnails has 8 bytes, expected 9"},
        {"\"dtype\":\"U8\"", "\"dtype\":\"I8\"", "tensor thumbnails has a dtype"},
        {"winter \\\"drive", "win\\tter", "source is not 0 to 127 printable"},
        {"winter \\\"drive", "win\\u007fter", "source is not 0 to 127 printable"},
        {"winter \\\"drive", SAMPLE_SHA256 SAMPLE_SHA256, "source in __metadata__ is too long"},
    };
    static const struct {
        size_t frame;
        uint32_t end;
        const char *reason;
    } ends[] = {
        {0, 9, "the thumbnail of frame 1 ends at byte 8, expected 9 and at most 4096 more"},
        {0, 4097, "the thumbnail of frame 0 ends at byte 4097, expected 0 and at most 4096 more"},
        {1, 7, "the last thumbnail ends at byte 7, expected 8"},
        {1, 9, "the last thumbnail ends at byte 9, expected 8"},
    };
    edited_file pictured = *(const edited_file *)*state;
    load(&pictured, pictured_experience());
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = pictured;
        edit_header(&f, edits[i].from, edits[i].to);
        assert_refused(&f, VDNA_ERR_FORMAT, edits[i].reason);
    }
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        edited_file f = pictured;
        edit_data(&f, "frame_thumbnail_end", ends[i].frame, &ends[i].end, 4);
        assert_refused(&f, VDNA_ERR_FORMAT, ends[i].reason);
    }
}

static void numbers_too_large_to_localise_by_are_refused(void **state)
{
    const float most[] = {1e15f, -1e15f}, beyond[] = {1.1e15f, 3.4e38f, -1.1e15f};
    edited_file good = *(const edited_file *)*state;
    vdna_experience e;
    for (size_t i = 0; i < 2; i++)
        edit_data(&good, "embeddings", 6 + i, &most[i], 4);
    assert_int_equal(open_bytes(&good, NULL, &e), VDNA_OK);
    vdna_experience_close(&e);
    for (size_t i = 0; i < 3; i++) {
        edited_file f = good;
        edit_data(&f, "embeddings", 7, &beyond[i], 4);
        assert_refused(&f, VDNA_ERR_FORMAT,
                       "the embedding of frame 1 has a number beyond 1e+15, by which no frame");
    }
}

static void a_newer_format_version_is_unsupported_and_says_what_to_do(void **state)
{
    edited_file f = *(const edited_file *)*state;
    edit_header(&f, "\"format_version\":\"1\"", "\"format_version\":\"5\"");
    assert_refused(&f, VDNA_ERR_UNSUPPORTED, "update this program");
    edit_header(&f, "\"format_version\":\"5\"", "\"format_version\":\"10\"");
    assert_refused(&f, VDNA_ERR_UNSUPPORTED, "version 10 is newer");
}

static void metadata_that_breaks_a_rule_is_refused(void **state)
{
    static const struct {
        const char *from, *to, *reason;
    } edits[] = {
        {"vdna-experience", "vdna-experiences", "format is not vdna-experience"},
        {"\"format\":\"vdna-experience\",", "", "format is not vdna-experience"},
        {"\"format_version\":\"1\"", "\"format_version\":\"0\"", "format_version"},
        {"\"format_version\":\"1\"", "\"format_version\":\"1.0\"", "format_version"},
        {"\"format_version\":\"1\"", "\"format_version\":\"\"", "format_version"},
        {"\"format_version\"", "\"version\"", "format_version"},
        {"\"name\":", "\"title\":", "name in __metadata__ is missing"},
        {"\"backbone\":", "\"bone\":", "backbone in __metadata__ is missing"},
        {"\"model_sha256\":", "\"sha\":", "model_sha256 in __metadata__ is missing"},
        {"\"preprocessing\":", "\"pre\":", "preprocessing in __metadata__ is missing"},
        {"\"taps\":", "\"tap\":", "taps in __metadata__ is missing"},
        {"\"comparable\":", "\"same\":", "comparable in __metadata__ is missing"},
        {"\"taps\":", "\"precision\":\"0123456789abcdef\",\"taps\":",
         "precision in __metadata__ is too long"},
        {"winter", "", "name is empty"},
        {"\"taps\":", "\"precision\":\"" SAMPLE_SHA256 "\",\"taps\":",
         "precision in __metadata__ is too long"},
        {"\"local\"", "\"my site\"", "position_frame has a character"},
        {"\"local\"", "\"" SAMPLE_SHA256 "\"", "position_frame in __metadata__ is too long"},
        {"\"local\"", "\"wgs84\"", "the position of frame 0 is not 6.3e6 to 6.5e6 m"},
        {"\"utime\"", "\"u time\"", "order has a character"},
        {"\"utime\"", "\"0123456789abcdef0123456789abcdef\"", "order in __metadata__ is too long"},
        {"winter", "win ter", "name has a character"},
        {"winter", "../winter", "name has a character"},
        {"winter", SAMPLE_SHA256, "name in __metadata__ is too long"},
        {"tiny-net_1.0", "tiny/net", "backbone has a character"},
        {"\"model_sha256\":\"0", "\"model_sha256\":\"", "model_sha256 is not 64"},
        {"\"model_sha256\":\"0123456789a", "\"model_sha256\":\"0123456789A",
         "model_sha256 is not 64"},
        {"rgb 8x8", "rgb\\n8x8", "preprocessing has a character"},
        {"rgb 8x8", "rgb\xC3\xA9", "preprocessing has a character"},
        {"mid:2:4,top:1:1", "", "taps is empty"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4,1", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1:", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1:1,", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", ":2:4,top:1:1", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:02:4,top:1:1", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:0:4,top:1:1", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1:-1", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1:4294967297", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1:10000000001", "NAME:NEURONS:SAMPLES"},
        {"mid:2:4,top:1:1", "mid:2:4", "do not have the 3 neurons"},
        {"mid:2:4,top:1:1", "mid:2:4,top:2:1", "do not have the 3 neurons"},
        {"mid:2:4,top:1:1", "mid:2:4,top:4294967295:1", "do not have the 3 neurons"},
        {"mid:2:4,top:1:1", "mid:2:4,top:1:2", "the mass of neuron 2 is 2, expected 4"},
        {"mid:2:4,top:1:1", "mad:2:4,top:1:1", "comparable is not"},
        {"tiny-net", "tiny\\u0000net", "a character of a JSON string"},
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = *(const edited_file *)*state;
        edit_header(&f, edits[i].from, edits[i].to);
        assert_refused(&f, VDNA_ERR_FORMAT, edits[i].reason);
    }
}

static void a_tensor_that_breaks_a_rule_is_refused(void **state)
{
    static const struct {
        const char *from, *to, *reason;
    } edits[] = {
        {"\"counts\":", "\"count\":", "tensor counts is missing"},
        {"\"embeddings\":", "\"embedding\":", "tensor embeddings is missing"},
        {"\"mass\":", "\"mess\":", "mass is missing"},
        {"\"range\":", "\"ranges\":", "range is missing"},
        {"\"frame_utime\":", "\"utime\":", "frame_utime is missing"},
        {"\"frame_grey\":", "\"grey\":", "frame_grey is missing"},
        {"\"crc32c\":", "\"crc\":", "tensor crc32c is missing"},
        {"\"counts\":{\"dtype\":\"U32\"", "\"counts\":{\"dtype\":\"I32\"",
         "tensor counts has a dtype"},
        {"\"mass\":{\"dtype\":\"U32\"", "\"mass\":{\"dtype\":\"F32\"", "tensor mass has a dtype"},
        {"\"frame_place\":{\"dtype\":\"I64\"", "\"frame_place\":{\"dtype\":\"F64\"",
         "tensor frame_place has a dtype"},
        {"\"crc32c\":{\"dtype\":\"U32\"", "\"crc32c\":{\"dtype\":\"F32\"",
         "tensor crc32c has a dtype"},
        {"\"shape\":[4,3]", "\"shape\":[12]", "tensor counts has a shape"},
        {"\"shape\":[4,3]", "\"shape\":[4,3,1]", "tensor counts has a shape"},
        {"\"shape\":[4,3]", "\"shape\":[0,3]", "tensor counts has a shape"},
        {"\"shape\":[4,3]", "\"shape\":[4294967296,3]", "tensor counts has a shape"},
        {"\"shape\":[4,3]", "\"shape\":[4,0]", "tensor counts has a shape"},
        {"\"shape\":[4,3]", "\"shape\":[4,4294967296]", "tensor counts has a shape"},
        {"\"shape\":[4,3]", "\"shape\":[3,4]", "tensor mass has a dtype or shape"},
        {"\"shape\":[4,3]", "\"shape\":[5,3]", "48 bytes, expected 15 numbers of 4"},
        /* Their product, in bytes, is 2^64. */
        {"\"shape\":[2,5]", "\"shape\":[2147483648,2147483648]", "tensor frame_utime has a dtype"},
        {"\"shape\":[3,2]", "\"shape\":[2,3]", "tensor range has a dtype or shape"},
        {"\"shape\":[3,2]", "\"shape\":[3,3]", "tensor range has a dtype or shape"},
        {"\"shape\":[3,2]", "\"shape\":[3]", "tensor range has a dtype or shape"},
        {"[204,212]},\"crc32c\":{\"dtype\":\"U32\",\"shape\":[1],\"data_offsets\":[212",
         "[204,210]},\"crc32c\":{\"dtype\":\"U32\",\"shape\":[1],\"data_offsets\":[210",
         "tensor crc32c has 6 bytes, expected 1 numbers of 4"},
        {"\"crc32c\":{\"dtype\":\"U32\",\"shape\":[1]",
         "\"crc32c\":{\"dtype\":\"U32\",\"shape\":[]", "tensor crc32c has a dtype or shape"},
        /* The eight bytes of place 1 go to frame_position. */
        {"\"data_offsets\":[16,32]", "\"data_offsets\":[16,24]", "leave a gap or overlap"},
        {"\"data_offsets\":[16,32]", "\"data_offsets\":[8,32]", "leave a gap or overlap"},
        {"\"data_offsets\":[16,32]", "\"data_offsets\":[32,16]", "leave a gap or overlap"},
        {"\"data_offsets\":[0,16]", "\"data_offsets\":[4,16]", "leave a gap or overlap"},
        {"\"data_offsets\":[16,32]", "\"data_offsets\":[16,18446744073709551615]",
         "leave a gap or overlap"},
        {"\"mass\":{", "\"counts\":{", "each tensor once"},
        {"\"taps\":", "\"name\":", "each key of __metadata__ once"},
        {"{\"__metadata__\":", "{\"__metadata__\":{},\"__metadata__\":", "one __metadata__ only"},
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = *(const edited_file *)*state;
        edit_header(&f, edits[i].from, edits[i].to);
        assert_refused(&f, VDNA_ERR_FORMAT, edits[i].reason);
    }
}

static void a_number_that_breaks_a_rule_is_refused(void **state)
{
    const float nan = NAN, infinity = INFINITY, one = 1, negative = -1, too_bright = 255.5f;
    const double infinite = INFINITY, no_number = NAN;
    const uint32_t seven = 7;
    const struct {
        const char *tensor;
        size_t index;
        const void *number;
        size_t width;
        const char *reason;
    } edits[] = {
        {"mass", 1, &seven, 4, "the mass of neuron 1 is 7, expected 8"},
        {"counts", 10, &seven, 4, "the counts of neuron 1 add up to 15"},
        {"range", 0, &one, 4, "the range of neuron 0"},
        {"range", 3, &nan, 4, "the range of neuron 1"},
        {"range", 5, &infinity, 4, "the range of neuron 2"},
        {"range", 5, &one, 4, "comparable is not"},
        {"embeddings", 9, &nan, 4, "the embedding of frame 1"},
        {"embeddings", 0, &infinity, 4, "the embedding of frame 0"},
        {"frame_grey", 1, &nan, 4, "the grey level of frame 1"},
        {"frame_grey", 0, &negative, 4, "the grey level of frame 0"},
        {"frame_grey", 0, &too_bright, 4, "the grey level of frame 0 is 255.5"},
        {"frame_position", 4, &infinite, 8, "the position of frame 1"},
        {"frame_position", 4, &no_number, 8, "expected three NaNs"},
        {"frame_position", 0, &no_number, 8, "the position of frame 0"},
    };
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file f = *(const edited_file *)*state;
        edit_data(&f, edits[i].tensor, edits[i].index, edits[i].number, edits[i].width);
        assert_refused(&f, VDNA_ERR_FORMAT, edits[i].reason);
    }
}

static void counts_that_match_only_modulo_32_bits_are_refused(void **state)
{
    edited_file f = *(const edited_file *)*state;
    const uint32_t half = 0x80000000;
    edit_data(&f, "counts", 4, &half, 4);
    edit_data(&f, "counts", 7, &half, 4);
    assert_refused(&f, VDNA_ERR_FORMAT, "the counts of neuron 1 add up to 4294967304");
}

static void a_header_that_is_no_json_of_safetensors_is_refused(void **state)
{
    static const char *const headers[] = {
        "",
        " {}",
        "{",
        "{}",
        "[]",
        "null",
        "{\"a\"",
        "{\"a\":",
        "{\"a\":1}",
        "{\"a\":{}}",
        "{\"a\":[[[[[[[[[[[[[[[[[[[[[[",
        "{\"a\":{\"a\":{\"a\":{\"a\":{\"a\":",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[0],\"data_offsets\":[0,0],\"x\":1}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[0],\"shape\":[0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[-1],\"data_offsets\":[0,0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[00],\"data_offsets\":[0,0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[1e3],\"data_offsets\":[0,0]}}",
        "{\"abcdefgh\":{\"shape\":[10", /* 24 bytes: no padding behind the number */
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[0,],\"data_offsets\":[0,0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[18446744073709551616],\"data_offsets\":[0,0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[1,1,1,1,1,1,1,1,1],\"data_offsets\":[0,0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[0],\"data_offsets\":[0]}}",
        "{\"a\":{\"dtype\":\"U8\",\"shape\":[0],\"data_offsets\":[0,0,0]}}",
        "{\"a\":{\"dtype\":8,\"shape\":[0],\"data_offsets\":[0,0]}}",
        "{\"__metadata__\":{\"a\":1}}",
        "{\"__metadata__\":{\"a\":\"\n\"}}",
        "{\"__metadata__\":{\"a\":\"\\x\"}}",
        "{\"__metadata__\":{\"a\":\"\\u12\"}}",
        "{\"__metadata__\":{\"a\":\"\\u12g4\"}}",
        "{\"__metadata__\":{\"a\":\"\\ud83d\"}}",
        "{\"__metadata__\":{\"a\":\"\\ude00\\ud83d\"}}",
        "{\"__metadata__\":{\"a\":\"\\ud83d.ude00\"}}",
        "{\"__metadata__\":{\"a\":\"\\ud83d\\nde00\"}}",
        "{\"__metadata__\":{\"a\":\"\\ud83d\\ue000\"}}",
        "{\"__metadata__\":{\"a\":\"\x80\"}}",
        "{\"__metadata__\":{\"a\":\"\xC0\xAF\"}}",
        "{\"__metadata__\":{\"a\":\"\xE0\x80\xAF\"}}",
        "{\"__metadata__\":{\"a\":\"\xED\xA0\x80\"}}",
        "{\"__metadata__\":{\"a\":\"\xF4\x90\x80\x80\"}}",
        "{\"__metadata__\":{\"a\":\"\xF5\x80\x80\x80\"}}",
        "{\"__metadata__\":{\"a\":\"\xE2\x82",
        "{\"__metadata__\":{\"a\":\"\xE2\x82\xC0\"}}",
        "{\"__metadata__\":{\"a\":\"\\u00",
        "{\"__metadata__\":{\"ab\":\"\\", /* 24 bytes: no padding behind the backslash */
        "{\"__metadata__\":{}",
        "{\"__metadata__\":{}} x",
    };
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        edited_file f = *(const edited_file *)*state;
        set_header(&f, headers[i]);
        assert_refused(&f, VDNA_ERR_FORMAT, "expected ");
    }
}

static void a_key_may_have_63_bytes_and_no_more(void **state)
{
    edited_file f = *(const edited_file *)*state;
    edit_header(
        &f, "{\"format\"",
        "{\"123456789012345678901234567890123456789012345678901234567890123\":\"\",\"format\"");
    assert_opens(&f);
    edit_header(&f, "{\"123", "{\"0123");
    assert_refused(&f, VDNA_ERR_FORMAT, "a string that is too long");
}

static void a_key_is_the_same_however_it_is_escaped(void **state)
{
    static const char *const pairs[] = {
        "{\"A\":\"\",\"\\u0041\":\"\",\"format\"",
        "{\"\xC3\xA9\":\"\",\"\\u00e9\":\"\",\"format\"",
        "{\"\xE2\x82\xAC\":\"\",\"\\u20AC\":\"\",\"format\"",
        "{\"\xEE\x80\x80\":\"\",\"\\uE000\":\"\",\"format\"",
        "{\"\xF0\x9F\x98\x80\":\"\",\"\\ud83d\\ude00\":\"\",\"format\"",
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        edited_file f = *(const edited_file *)*state;
        edit_header(&f, "{\"format\"", pairs[i]);
        assert_refused(&f, VDNA_ERR_FORMAT, "each key of __metadata__ once");
    }
}

static void more_tensors_or_texts_than_a_header_may_have_are_refused(void **state)
{
    edited_file f = *(const edited_file *)*state;
    char tensors[FILE_SIZE / 2] = "", texts[FILE_SIZE / 2] = "";
    for (int i = 0; i < 33; i++) {
        sprintf(tensors + strlen(tensors),
                "\"%d\":{\"dtype\":\"U8\",\"shape\":[0],\"data_offsets\":[0,0]},", i);
        sprintf(texts + strlen(texts), "\"%d\":\"\",", i);
    }
    strcat(tensors, "\"counts\":");
    strcat(texts, "\"name\":");
    edit_header(&f, "\"counts\":", tensors);
    assert_refused(&f, VDNA_ERR_FORMAT, "no more than 32 tensors");
    f = *(const edited_file *)*state;
    edit_header(&f, "\"name\":", texts);
    assert_refused(&f, VDNA_ERR_FORMAT, "no more than 32 texts");
}

static void data_that_is_not_aligned_is_refused(void **state)
{
    edited_file f = *(const edited_file *)*state;
    memmove(f.bytes + 9, f.bytes + 8, f.size - 8);
    f.bytes[8] = '{';
    f.bytes[9] = ' ';
    f.bytes[0]++;
    f.size++;
    seal(&f);
    assert_refused(&f, VDNA_ERR_FORMAT, "expected a multiple of");
}

static void a_file_cut_at_any_length_is_refused(void **state)
{
    edited_file f = *(const edited_file *)*state;
    for (size_t size = 0; size < ((const edited_file *)*state)->size; size++) {
        f.size = size;
        assert_refused(&f, VDNA_ERR_FORMAT, size < 8 ? "expected at least" : "cut short");
    }
}

static void a_byte_more_is_refused(void **state)
{
    edited_file f = *(const edited_file *)*state;
    f.size++;
    assert_refused(&f, VDNA_ERR_FORMAT, "bytes, but");
}

static void any_damaged_byte_is_refused(void **state)
{
    const edited_file *f = *state;
    for (size_t i = 0; i < f->size; i++)
        for (unsigned mask = 1; mask < 256; mask = 2 * mask + 1) {
            edited_file damaged = *f;
            damaged.bytes[i] ^= (unsigned char)mask;
            vdna_experience e;
            assert_int_not_equal(open_bytes(&damaged, NULL, &e), VDNA_OK);
        }
}

static void a_damaged_number_is_a_checksum_error(void **state)
{
    edited_file f = *(const edited_file *)*state;
    f.bytes[f.size - 10] ^= 1;
    assert_refused(&f, VDNA_ERR_CHECKSUM, "copy it again");
}

static void a_length_beyond_the_file_is_refused_before_it_is_used(void **state)
{
    edited_file f = *(const edited_file *)*state;
    memset(f.bytes, 0xFF, 8);
    assert_refused(&f, VDNA_ERR_FORMAT, "the header claims 18446744073709551615 bytes");
    memset(f.bytes, 0, 8);
    assert_refused(&f, VDNA_ERR_FORMAT, "byte 8 of the file: expected '{'");
}

static void a_file_that_is_not_regular_is_refused_without_waiting(void **state)
{
    const edited_file *f = *state;
    const char *fifo = path_in(&f->directory, "fifo");
    vdna_experience e;
    vdna_error error;
    assert_int_equal(mkfifo(fifo, 0600), 0);
    assert_int_equal(vdna_experience_open(fifo, &error, &e), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "fifo: not a regular file"));
    assert_int_equal(vdna_experience_open(f->directory.path, &error, &e), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "not a regular file"));
    assert_int_equal(vdna_experience_open("/dev/zero", &error, &e), VDNA_ERR_IO);
    assert_int_equal(vdna_experience_open(path_in(&f->directory, "none"), &error, &e), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "none: cannot open: No such file"));
    assert_int_equal(vdna_experience_open(NULL, &error, &e), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_open(fifo, &error, NULL), VDNA_ERR_ARG);
}

static void a_huge_sparse_file_is_refused(void **state)
{
    const edited_file *f = *state;
    const char *path = path_in(&f->directory, "sparse");
    const int descriptor = open(path, O_WRONLY | O_CREAT, 0600);
    vdna_experience e;
    if (ftruncate(descriptor, (off_t)1 << 40) != 0)
        skip();
    close(descriptor);
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_ERR_FORMAT);
}

static void an_open_experience_outlives_its_file(void **state)
{
    const edited_file *f = *state;
    const char *path = path_in(&f->directory, "sample");
    vdna_experience e;
    assert_int_equal(vdna_experience_open(path, NULL, &e), VDNA_OK);
    vdna_experience other = sample_experience();
    strcpy(other.name, "summer");
    assert_int_equal(vdna_experience_write(&other, path, NULL), VDNA_OK);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(e.mass[0], 8);
    assert_string_equal(e.name, "winter");
    vdna_experience_close(&e);
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down_file)
    const struct CMUnitTest tests[] = {
        CASE(what_is_written_is_read_back),
        CASE(an_experience_needs_no_places_and_no_positions),
        CASE(a_precision_is_kept_and_defaults_to_fp32),
        CASE(the_longest_taps_are_kept),
        CASE(the_checksum_is_crc32c_of_all_before_it),
        CASE(every_other_spelling_of_the_header_opens),
        CASE(positions_near_the_surface_of_the_earth_are_of_gps_if_nothing_is_said),
        CASE(a_file_that_does_not_say_the_frame_is_read_as_before),
        CASE(frames_may_lack_the_truth_that_others_have_since_version_2),
        CASE(a_second_embedding_is_kept_since_version_3),
        cmocka_unit_test(the_last_layer_stands_for_the_activations_where_it_is_the_only_tap),
        CASE(embeddings_stored_as_codes_are_read_as_floats),
        CASE(a_projection_is_kept_since_version_4),
        CASE(a_projection_that_breaks_a_rule_is_refused),
        CASE(codes_that_break_a_rule_are_refused),
        CASE(thumbnails_and_a_source_are_kept_and_change_nothing_else),
        CASE(thumbnails_and_sources_that_break_a_rule_are_refused),
        CASE(numbers_too_large_to_localise_by_are_refused),
        CASE(a_newer_format_version_is_unsupported_and_says_what_to_do),
        CASE(metadata_that_breaks_a_rule_is_refused),
        CASE(a_tensor_that_breaks_a_rule_is_refused),
        CASE(a_number_that_breaks_a_rule_is_refused),
        CASE(counts_that_match_only_modulo_32_bits_are_refused),
        CASE(a_header_that_is_no_json_of_safetensors_is_refused),
        CASE(a_key_may_have_63_bytes_and_no_more),
        CASE(a_key_is_the_same_however_it_is_escaped),
        CASE(more_tensors_or_texts_than_a_header_may_have_are_refused),
        CASE(data_that_is_not_aligned_is_refused),
        CASE(a_file_cut_at_any_length_is_refused),
        CASE(a_byte_more_is_refused),
        CASE(any_damaged_byte_is_refused),
        CASE(a_damaged_number_is_a_checksum_error),
        CASE(a_length_beyond_the_file_is_refused_before_it_is_used),
        CASE(a_file_that_is_not_regular_is_refused_without_waiting),
        CASE(a_huge_sparse_file_is_refused),
        CASE(an_open_experience_outlives_its_file),
    };
    return cmocka_run_group_tests_name("map", tests, NULL, NULL);
}
