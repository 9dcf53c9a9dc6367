// Means of feature maps over grids, by hand and against another way of counting.
#include <numeric>

#include <cmocka.hpp>

#include "grid_means.hpp"

using namespace vdna::backbone;

static std::vector<float> means_of(int64_t channels, int64_t height, int64_t width, Grid grid,
                                   const std::vector<float> &map)
{
    const GridMeans means({{channels, height, width}, nullptr, map.size()}, grid, "m: output 'o'");
    std::vector<float> found(means.size());
    means.run(map.data(), found.data());
    return found;
}

static std::vector<float> counting_up(size_t size)
{
    std::vector<float> numbers(size);
    std::iota(numbers.begin(), numbers.end(), 0.0f);
    return numbers;
}

// The example of the definition: rows 0, 3, 5 of 5 and columns 0, 2, 4 of 4.
static void cells_are_ordered_by_channel_row_and_column(void **)
{
    const std::vector<float> expected = {4.5f, 6.5f, 14.5f, 16.5f, 24.5f, 26.5f, 34.5f, 36.5f};
    assert_true(means_of(2, 5, 4, {2, 2}, counting_up(40)) == expected);
}

// A cell's place is told by counting the pixels of each cell: 5, 4 and 5 of 14, and 1 of 3 of 3.
static void edges_are_rounded_to_the_nearest_pixel(void **)
{
    std::vector<float> rows;
    for (int y = 0; y < 14; y++)
        rows.insert(rows.end(), 2, static_cast<float>(y));
    assert_true(means_of(1, 14, 2, {3, 1}, rows) == std::vector<float>({2, 6.5f, 11}));
    assert_true(means_of(1, 3, 1, {3, 1}, {7, 8, 9}) == std::vector<float>({7, 8, 9}));
    assert_true(means_of(1, 1, 7, {1, 2}, counting_up(7)) == std::vector<float>({1.5f, 5}));
}

static void one_cell_is_the_mean_of_the_map(void **)
{
    assert_true(means_of(1, 2, 3, {1, 1}, counting_up(6)) == std::vector<float>({2.5f}));
}

// In single precision 1 would vanish beside 2^25.
static void sums_are_taken_in_double_precision(void **)
{
    assert_true(means_of(1, 1, 4, {1, 1}, {33554432, 1, -33554432, 1}) ==
                std::vector<float>({0.5f}));
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_ordered_by_channel_row_and_column),
        cmocka_unit_test(edges_are_rounded_to_the_nearest_pixel),
        cmocka_unit_test(one_cell_is_the_mean_of_the_map),
        cmocka_unit_test(sums_are_taken_in_double_precision),
    };
    return cmocka_run_group_tests_name("grid means", tests, nullptr, nullptr);
}
