// Times of ISO 8601.
#include <cstdlib>
#include <ctime>

#include "cmocka.hpp"
#include "frames/iso_time.hpp"

using vdna::frames::date_of;
using vdna::frames::iso_of;
using vdna::frames::utime_of_iso;

namespace
{

void assert_utime(const char *text, int64_t utime)
{
    const std::optional<int64_t> found = utime_of_iso(text);
    if (!found)
        fail_msg("'%s' is refused", text);
    if (*found != utime)
        fail_msg("'%s' is %lld, expected %lld", text, static_cast<long long>(*found),
                 static_cast<long long>(utime));
}

// The values are those of `date -u -d TEXT +%s`.
void dates_are_those_of_the_calendar(void **)
{
    assert_utime("1970-01-01T00:00:00Z", 0);
    assert_utime("2024-05-01T12:00:00Z", 1714564800000000);
    assert_utime("2024-02-29T23:59:59Z", 1709251199000000);
    assert_utime("2024-03-01T00:00:00Z", 1709251200000000);
    assert_utime("2000-02-29T00:00:00Z", 951782400000000);
    assert_utime("1999-12-31T23:59:59Z", 946684799000000);
    assert_utime("1969-12-31T23:59:59Z", -1000000);
}

void every_day_of_four_centuries_is_that_of_the_c_library(void **)
{
    for (int64_t day = -100000; day < 50000; day++) {
        const time_t seconds = day * 86400;
        tm calendar{};
        gmtime_r(&seconds, &calendar);
        char text[64];
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &calendar);
        assert_utime(text, day * 86400 * 1000000);
    }
}

void a_stamp_is_a_date_if_it_counts_from_1970(void **)
{
    assert_string_equal(date_of(1714564800000000).c_str(), "2024-05-01T12:00:00.000Z");
    assert_string_equal(date_of(100000000000000).c_str(), "1973-03-03T09:46:40.000Z");
    for (const int64_t utime : {INT64_MIN, int64_t{-1}, int64_t{0}, int64_t{99999999999999},
                                int64_t{100000000000000000}, INT64_MAX})
        assert_string_equal(date_of(utime).c_str(), "");
}

void fractions_are_read_to_the_microsecond(void **)
{
    assert_utime("1970-01-01T00:00:01.5Z", 1500000);
    assert_utime("1970-01-01T00:00:01,000001Z", 1000001);
    assert_utime("1970-01-01T00:00:01.123456789Z", 1123456);
    assert_utime("1970-01-01T00:00:01.00000000000000000000000000001Z", 1000000);
}

void zones_are_subtracted(void **)
{
    assert_utime("1970-01-01T02:00:00+02:00", 0);
    assert_utime("1970-01-01T02:30:00+0230", 0);
    assert_utime("1969-12-31T19:00:00-05", 0);
    assert_utime("1970-01-01T05:45:00.25+05:45", 250000);
    assert_utime("1970-01-01T00:00:00", 0);
    assert_utime("1970-01-01 00:00:00", 0);
}

void a_leap_second_is_the_next_minute(void **)
{
    assert_utime("2016-12-31T23:59:60Z", 1483228800000000);
}

void other_texts_are_refused(void **)
{
    for (const char *text : {"",
                             "now",
                             "2024-05-01",
                             "2024-05-01T12:00Z",
                             "2023-02-29T00:00:00Z",
                             "1900-02-29T00:00:00Z",
                             "2024-13-01T00:00:00Z",
                             "2024-00-01T00:00:00Z",
                             "2024-04-31T00:00:00Z",
                             "2024-05-00T00:00:00Z",
                             "2024-05-01T24:00:00Z",
                             "2024-05-01T12:60:00Z",
                             "2024-05-01T12:00:61Z",
                             "2024-05-01T12:00:00.Z",
                             "2024-05-01T12:00:00ZZ",
                             "2024-05-01T12:00:00 UTC",
                             "2024-05-01T12:00:00+2",
                             "2024-05-01T12:00:00+24:00",
                             "2024-05-01T12:00:00+02:",
                             "24-05-01T12:00:00Z",
                             "0000-05-01T12:00:00Z",
                             " 2024-05-01T12:00:00Z",
                             "2024-5-1T12:00:00Z",
                             "+2024-05-01T12:00:00Z",
                             "2024-05-01T12:00:00.5+02:00 "})
        if (utime_of_iso(text))
            fail_msg("'%s' is accepted", text);
}

void times_are_written_in_utc(void **)
{
    assert_string_equal(iso_of(1714564800500000).c_str(), "2024-05-01T12:00:00.500Z");
    assert_string_equal(iso_of(0).c_str(), "1970-01-01T00:00:00.000Z");
    assert_string_equal(iso_of(-1).c_str(), "1969-12-31T23:59:59.999Z");
}

} // namespace

int main()
{
    setenv("TZ", "Asia/Kathmandu", 1); // no local time may slip in
    const CMUnitTest tests[] = {
        cmocka_unit_test(dates_are_those_of_the_calendar),
        cmocka_unit_test(every_day_of_four_centuries_is_that_of_the_c_library),
        cmocka_unit_test(a_stamp_is_a_date_if_it_counts_from_1970),
        cmocka_unit_test(fractions_are_read_to_the_microsecond),
        cmocka_unit_test(zones_are_subtracted),
        cmocka_unit_test(a_leap_second_is_the_next_minute),
        cmocka_unit_test(other_texts_are_refused),
        cmocka_unit_test(times_are_written_in_utc),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
