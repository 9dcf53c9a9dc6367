// Counts every allocation through new. To be included by one source of a program.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

static size_t allocations;

void *operator new(size_t size)
{
    allocations++;
    if (void *const block = std::malloc(size ? size : 1))
        return block;
    throw std::bad_alloc();
}

void operator delete(void *block) noexcept
{
    std::free(block);
}

void operator delete(void *block, size_t) noexcept
{
    std::free(block);
}
