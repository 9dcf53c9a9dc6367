#include "selectord/processor.hpp"

#include <cctype>
#include <cerrno>
#include <cstring>
#include <string>

#include <sched.h>
#include <sys/resource.h>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"

namespace vdna::selectord
{

namespace
{

[[noreturn]] void refuse_list(const std::string &list)
{
    throw program::UsageError("[cpu] affinity is \"" + list +
                              "\", expected processor numbers such as \"0,1\" or "
                              "\"0-3\", each below " +
                              std::to_string(CPU_SETSIZE) +
                              "; correct it, or remove it to use all");
}

// Parse the number at `at`, and move `at` past it.
size_t number_at(const std::string &list, size_t &at)
{
    const size_t begin = at;
    size_t number = 0;
    for (; at < list.size() && std::isdigit(static_cast<unsigned char>(list[at])); at++) {
        number = 10 * number + static_cast<size_t>(list[at] - '0');
        if (number >= CPU_SETSIZE)
            refuse_list(list);
    }
    if (at == begin)
        refuse_list(list);
    return number;
}

cpu_set_t parse_list(const std::string &list)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    for (size_t at = 0;; at++) {
        const size_t first = number_at(list, at);
        size_t last = first;
        if (at < list.size() && list[at] == '-')
            last = number_at(list, ++at);
        for (size_t cpu = first; cpu <= last; cpu++)
            CPU_SET(cpu, &set);
        if (last < first || (at < list.size() && list[at] != ','))
            refuse_list(list);
        if (at == list.size())
            return set;
    }
}

void pin(const std::string &list)
{
    const cpu_set_t wanted = parse_list(list);
    cpu_set_t given;
    // The system silently ignores processors it does not have.
    if (sched_setaffinity(0, sizeof wanted, &wanted) != 0 ||
        sched_getaffinity(0, sizeof given, &given) != 0 || !CPU_EQUAL(&wanted, &given))
        throw Error("[cpu] affinity is \"" + list +
                    "\", but not all of these processors exist and may be used here; see `nproc` "
                    "and `taskset -p $$`; in a systemd unit, set CPUAffinity= instead");
}

void prioritise(int32_t nice)
{
    errno = 0;
    const int given = getpriority(PRIO_PROCESS, 0);
    if (errno != 0 || setpriority(PRIO_PROCESS, 0, given + nice) != 0)
        throw Error("[cpu] nice is " + std::to_string(nice) +
                    ", which the system refuses: " + std::strerror(errno) +
                    "; a negative one needs CAP_SYS_NICE; in a systemd unit, set Nice= instead");
}

} // namespace

void take_processors(const Config &config)
{
    if (!config.affinity.empty())
        pin(config.affinity);
    if (config.nice != 0)
        prioritise(config.nice);
}

} // namespace vdna::selectord
