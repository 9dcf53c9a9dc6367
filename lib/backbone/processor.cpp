#include "processor.hpp"

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

namespace vdna
{

bool adds_int8_products_exactly()
{
#if defined(__x86_64__) || defined(__i386__)
    constexpr unsigned avx512_vnni = 1u << 11; // leaf 7, sub-leaf 0, ECX
    constexpr unsigned avx_vnni = 1u << 4;     // leaf 7, sub-leaf 1, EAX
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    if (!__get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx))
        return false;
    if (ecx & avx512_vnni)
        return true;
    return eax >= 1 && __get_cpuid_count(7, 1, &eax, &ebx, &ecx, &edx) && (eax & avx_vnni);
#else
    return true;
#endif
}

} // namespace vdna
