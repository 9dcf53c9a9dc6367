#include <stdio.h>
#include <string.h>

#include <vdna/version.h>

#include "cmocka_all.h"

static void every_code_has_a_text_of_its_own(void **state)
{
    (void)state;
    for (vdna_status a = 0; a < VDNA_STATUS_COUNT; a++) {
        assert_string_not_equal(vdna_status_text(a), "unknown status");
        for (vdna_status b = 0; b < a; b++)
            assert_string_not_equal(vdna_status_text(a), vdna_status_text(b));
    }
}

static void a_value_that_is_no_code_has_a_text_too(void **state)
{
    (void)state;
    assert_string_equal(vdna_status_text(-1), "unknown status");
    assert_string_equal(vdna_status_text(VDNA_STATUS_COUNT), "unknown status");
}

static void the_library_has_the_version_of_its_header(void **state)
{
    (void)state;
    char expected[32];
    snprintf(expected, sizeof expected, "%d.%d.%d", VDNA_VERSION_MAJOR, VDNA_VERSION_MINOR,
             VDNA_VERSION_PATCH);
    assert_string_equal(vdna_version(), expected);
    assert_string_equal(vdna_version(), VDNA_PROJECT_VERSION);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_has_a_text_of_its_own),
        cmocka_unit_test(a_value_that_is_no_code_has_a_text_too),
        cmocka_unit_test(the_library_has_the_version_of_its_header),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
