/* What the header of an experience file says, read without the rest of the file. */
#define _POSIX_C_SOURCE 200809L
#include "cmocka_all.h"
#include "edited_file.h"

static const char *path_of(const edited_file *f)
{
    return path_in(&f->directory, "one.vdna");
}

static void write_experience(edited_file *f, vdna_experience e)
{
    assert_int_equal(vdna_experience_write(&e, path_of(f), NULL), VDNA_OK);
    f->size = load_file(path_of(f), f->bytes, sizeof f->bytes);
}

/* All but the texts and the sizes taken away. */
static vdna_experience without_tensors(const vdna_experience *e)
{
    vdna_experience bare = {.frames = e->frames,
                            .last_layer_dim = e->last_layer_dim,
                            .thumbnail_bytes = e->thumbnail_bytes,
                            .identity = e->identity};
    bare.identity.range = bare.identity.projection = NULL;
    memcpy(bare.name, e->name, sizeof bare.name);
    memcpy(bare.comparable, e->comparable, sizeof bare.comparable);
    memcpy(bare.position_frame, e->position_frame, sizeof bare.position_frame);
    memcpy(bare.order, e->order, sizeof bare.order);
    memcpy(bare.source, e->source, sizeof bare.source);
    return bare;
}

static void a_header_says_what_opening_the_file_says(void **state)
{
    edited_file *f = *state;
    vdna_experience nowhere = sample_experience();
    nowhere.frame_position = NULL;
    const vdna_experience written[] = {sample_experience(), coded_experience(),
                                       projected_experience(), pictured_experience(), nowhere};
    for (size_t i = 0; i < sizeof written / sizeof *written; i++) {
        vdna_experience header, open;
        vdna_error error = {""};
        write_experience(f, written[i]);
        if (vdna_experience_read_header(path_of(f), &error, &header) != VDNA_OK)
            fail_msg("refused: %s", error.text);
        assert_int_equal(vdna_experience_open(path_of(f), NULL, &open), VDNA_OK);
        const vdna_experience expected = without_tensors(&open);
        assert_string_equal(header.name, expected.name);
        assert_string_equal(header.comparable, expected.comparable);
        assert_string_equal(header.position_frame, expected.position_frame);
        assert_memory_equal(&header, &expected, sizeof header);
        vdna_experience_close(&open);
        vdna_experience_close(&header);
    }
}

static void the_tensors_are_not_read(void **state)
{
    edited_file *f = *state;
    vdna_experience header;
    write_experience(f, sample_experience());
    memset(f->bytes + 8 + header_length(f), 0xFF, f->size - 8 - header_length(f));
    assert_int_equal(vdna_experience_read_header(save_edited(f), NULL, &header), VDNA_OK);
    assert_int_equal(header.checksum, 0);
    assert_int_equal(vdna_experience_open(save_edited(f), NULL, &header), VDNA_ERR_CHECKSUM);
}

static void a_frame_that_is_not_stated_is_not_known(void **state)
{
    edited_file *f = *state;
    vdna_experience header;
    write_experience(f, sample_experience());
    edit_header(f, "\"position_frame\":\"local\",", "");
    assert_int_equal(vdna_experience_read_header(save_edited(f), NULL, &header), VDNA_OK);
    assert_string_equal(header.position_frame, "");
}

static void a_frame_of_no_positions_does_not_matter(void **state)
{
    edited_file *f = *state;
    vdna_experience header, e = sample_experience();
    e.frame_position = NULL;
    write_experience(f, e);
    edit_header(f, "\"order\":", "\"position_frame\":\"local\",\"order\":");
    assert_int_equal(vdna_experience_read_header(save_edited(f), NULL, &header), VDNA_OK);
    assert_string_equal(header.position_frame, "");
}

static void assert_refused(const edited_file *f, vdna_status expected, const char *reason)
{
    const vdna_error error = refusal_by(vdna_experience_read_header, f, expected, reason);
    if (!strstr(error.text, "; "))
        fail_msg("expected a remedy in: %s", error.text);
}

static void a_header_that_breaks_a_rule_is_refused(void **state)
{
    static const struct {
        const char *from, *to, *reason;
    } edits[] = {
        {"vdna-experience", "vdna-experiences", "format is not vdna-experience"},
        {"\"comparable\":", "\"same\":", "comparable in __metadata__ is missing"},
        {"\"counts\":", "\"count\":", "tensor counts is missing"},
        {"\"shape\":[4,3]", "\"shape\":[4]", "tensor counts has a shape"},
        {"winter", "../winter", "name has a character"},
        {"mid:2:4,top:1:1", "mid:2:4", "do not have the 3 neurons"},
        {"\"utime\"", "\"u time\"", "order has a character"},
        {"\"order\":", "\"source\":\"\\u0007\",\"order\":", "source is not 0 to 127 printable"},
        {"\"local\"", "\"my site\"", "position_frame has a character"},
    };
    edited_file *f = *state;
    write_experience(f, sample_experience());
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        edited_file edited = *f;
        edit_header(&edited, edits[i].from, edits[i].to);
        assert_refused(&edited, VDNA_ERR_FORMAT, edits[i].reason);
    }
    edit_header(f, "\"format_version\":\"1\"", "\"format_version\":\"5\"");
    assert_refused(f, VDNA_ERR_UNSUPPORTED, "update this program");
}

static void a_file_cut_at_any_length_is_refused(void **state)
{
    edited_file *f = *state;
    write_experience(f, sample_experience());
    while (f->size-- > 0)
        assert_refused(f, VDNA_ERR_FORMAT, "rebuild it with `vdna build`");
}

static void what_is_missing_is_refused(void **state)
{
    const edited_file *f = *state;
    vdna_error error = {""};
    vdna_experience header;
    assert_int_equal(vdna_experience_read_header(NULL, &error, &header), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_read_header(path_of(f), &error, NULL), VDNA_ERR_ARG);
    assert_int_equal(vdna_experience_read_header(path_of(f), &error, &header), VDNA_ERR_IO);
    assert_non_null(strstr(error.text, "one.vdna: cannot open: No such file"));
}

int main(void)
{
#define CASE(test) cmocka_unit_test_setup_teardown(test, set_up_file, tear_down_file)
    const struct CMUnitTest tests[] = {
        CASE(a_header_says_what_opening_the_file_says),
        CASE(the_tensors_are_not_read),
        CASE(a_frame_that_is_not_stated_is_not_known),
        CASE(a_frame_of_no_positions_does_not_matter),
        CASE(a_header_that_breaks_a_rule_is_refused),
        CASE(a_file_cut_at_any_length_is_refused),
        CASE(what_is_missing_is_refused),
    };
    return cmocka_run_group_tests_name("map_header", tests, NULL, NULL);
}
