// Counts packed into the bytes of a cache entry.
#include "cmocka.hpp"
#include "eval/packing.hpp"

using vdna::eval::Unpacker;

namespace
{

void counts_of_every_size_come_back(void **)
{
    const std::vector<uint32_t> counts = {
        0, 1, 127, 128, 16383, 16384, 1 << 20, 1 << 21, (1 << 28) - 1, 1u << 28, UINT32_MAX};
    std::string bytes;
    vdna::eval::pack_counts(bytes, counts);
    Unpacker unpacker(bytes);
    std::vector<uint32_t> back;
    assert_true(unpacker.take_counts(back, counts.size()));
    assert_true(unpacker.at_end());
    assert_true(back == counts);
}

void cut_counts_are_refused(void **)
{
    std::string bytes;
    vdna::eval::pack_counts(bytes, {5, 300});
    std::vector<uint32_t> back;
    for (size_t size = 0; size < bytes.size(); size++)
        assert_false(Unpacker(bytes.substr(0, size)).take_counts(back, 2));
    assert_false(Unpacker(bytes).take_counts(back, UINT64_MAX));
}

void an_endless_count_is_refused(void **)
{
    std::vector<uint32_t> back;
    const std::string endless(6, '\x80');
    assert_false(Unpacker(endless).take_counts(back, 1));
}

} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(counts_of_every_size_come_back),
        cmocka_unit_test(cut_counts_are_refused),
        cmocka_unit_test(an_endless_count_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
