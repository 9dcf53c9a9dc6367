#include "selectord/lost_pages.hpp"

#include <atomic>

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

namespace vdna::selectord
{

namespace
{

std::atomic<uint32_t> lost{0};
static_assert(std::atomic<uint32_t>::is_always_lock_free); // as a signal handler needs it
uintptr_t page_bytes = 0;

// Put a page of zeros where one is gone. Not executable: code that is gone still ends the process,
// as does what cannot be put right, when it is run again.
void replace_page(int signal_number, siginfo_t *info, void *)
{
    const uintptr_t address = reinterpret_cast<uintptr_t>(info->si_addr);
    void *const page = reinterpret_cast<void *>(address - address % page_bytes);
    if (info->si_code != BUS_ADRERR ||
        mmap(page, page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != page) {
        signal(signal_number, SIG_DFL);
        return;
    }
    lost++;
}

} // namespace

void survive_lost_pages()
{
    page_bytes = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
    struct sigaction action{};
    action.sa_sigaction = replace_page;
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGBUS, &action, nullptr);
}

uint32_t lost_pages()
{
    return lost;
}

} // namespace vdna::selectord
