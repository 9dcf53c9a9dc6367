// The daemon's settings of the C library.
#include <cstdlib>

#include <cmocka.hpp>
#include <malloc.h>

#include "selectord/memory_statement.hpp"

using namespace vdna;
using namespace vdna::selectord;

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
// Blocks that came from the system, and go back there, one by one.
static size_t blocks_of_their_own()
{
    return mallinfo2().hblks;
}

static void a_large_block_goes_back_whatever_was_freed_before(void **)
{
    return_large_blocks();
    malloc_trim(0); // malloc looks in free memory first
    const size_t before = blocks_of_their_own();
    for (size_t size = size_t{1} << 24; size >= size_t{1} << 21; size /= 2) {
        void *volatile block = std::malloc(size); // volatile keeps the allocation
        assert_int_equal(blocks_of_their_own(), before + 1);
        std::free(block);
        assert_int_equal(blocks_of_their_own(), before);
    }
}
#else
static void a_large_block_goes_back_whatever_was_freed_before(void **)
{
    _skip(__FILE__, __LINE__); // another C library, or a sanitizer's
}
#endif

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_large_block_goes_back_whatever_was_freed_before),
    };
    return cmocka_run_group_tests_name("memory_statement", tests, nullptr, nullptr);
}
