#include "processor.hpp"

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#elif defined(__aarch64__)
#include <sys/auxv.h>
#endif

namespace vdna::backbone
{

const char *lacks_for_int8_products()
{
#if defined(__x86_64__) || defined(__i386__)
    const char *const lacks = "AVX-512 VNNI and AVX-VNNI";
    constexpr unsigned avx512_vnni = 1u << 11; // leaf 7, sub-leaf 0, ECX
    constexpr unsigned avx_vnni = 1u << 4;     // leaf 7, sub-leaf 1, EAX
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    if (!__get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx))
        return lacks;
    if (ecx & avx512_vnni)
        return nullptr;
    if (eax >= 1 && __get_cpuid_count(7, 1, &eax, &ebx, &ecx, &edx) && (eax & avx_vnni))
        return nullptr;
    return lacks;
#elif defined(__aarch64__)
    return getauxval(AT_HWCAP) & HWCAP_ASIMDDP ? nullptr : "asimddp (the dot product of Armv8.2)";
#else
    return nullptr;
#endif
}

} // namespace vdna::backbone
