// Percentiles of durations against those of the sorted list.
#include <algorithm>
#include <random>
#include <vector>

#include "cmocka.hpp"
#include "selectord/durations.hpp"

namespace
{

using vdna::selectord::Durations;

int64_t nearest_rank(std::vector<int64_t> values, uint32_t percent)
{
    std::sort(values.begin(), values.end());
    return values[(values.size() * percent + 99) / 100 - 1];
}

void without_a_duration_everything_is_zero(void **)
{
    const Durations none;
    assert_int_equal(none.count(), 0);
    assert_int_equal(none.newest_us(), 0);
    assert_int_equal(none.max_us(), 0);
    assert_int_equal(none.percentile_us(50), 0);
}

void one_duration_is_all_percentiles(void **)
{
    for (const int64_t us : {int64_t{0}, int64_t{1}, int64_t{63}}) {
        Durations one;
        one.add(us);
        assert_int_equal(one.percentile_us(50), us);
        assert_int_equal(one.percentile_us(99), us);
        assert_int_equal(one.max_us(), us);
    }
}

void short_durations_are_exact(void **)
{
    Durations durations;
    for (int64_t us = 0; us < 64; us++)
        durations.add(us);
    for (uint32_t percent = 1; percent <= 100; percent++)
        assert_int_equal(durations.percentile_us(percent), (64 * percent + 99) / 100 - 1);
}

void percentiles_are_within_a_64th_at_every_scale(void **)
{
    std::mt19937 random(1);
    for (int64_t scale = 10; scale < int64_t{1} << 32; scale *= 7) {
        Durations durations;
        std::vector<int64_t> all;
        for (int i = 0; i < 997; i++) {
            all.push_back(static_cast<int64_t>(random() % static_cast<uint64_t>(scale)));
            durations.add(all.back());
        }
        for (const uint32_t percent : {1u, 50u, 90u, 99u, 100u}) {
            const int64_t exact = nearest_rank(all, percent);
            const int64_t found = durations.percentile_us(percent);
            assert_true(64 * std::abs(found - exact) <= exact);
        }
        assert_int_equal(durations.max_us(), *std::max_element(all.begin(), all.end()));
        assert_int_equal(durations.newest_us(), all.back());
    }
}

void of_a_hundred_durations_the_99th_percentile_leaves_one_out(void **)
{
    Durations durations;
    durations.add(60);
    for (int i = 0; i < 99; i++)
        durations.add(5);
    assert_int_equal(durations.percentile_us(99), 5);
    assert_int_equal(durations.percentile_us(100), 60);
    durations.add(60);
    assert_int_equal(durations.percentile_us(99), 60); // 99.99 of 101, rounded up
}

void what_cannot_be_is_clamped(void **)
{
    Durations durations;
    durations.add(-5);
    assert_int_equal(durations.max_us(), 0);
    durations.add(INT64_MAX);
    assert_int_equal(durations.max_us(), UINT32_MAX);
    assert_int_equal(durations.percentile_us(50), 0);
    assert_true(durations.percentile_us(100) > UINT32_MAX / 64 * 63);
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(without_a_duration_everything_is_zero),
        cmocka_unit_test(one_duration_is_all_percentiles),
        cmocka_unit_test(short_durations_are_exact),
        cmocka_unit_test(percentiles_are_within_a_64th_at_every_scale),
        cmocka_unit_test(of_a_hundred_durations_the_99th_percentile_leaves_one_out),
        cmocka_unit_test(what_cannot_be_is_clamped),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
