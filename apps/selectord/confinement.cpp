#include "selectord/confinement.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <initializer_list>
#include <vector>

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace vdna::selectord
{

namespace
{

#if defined(__x86_64__)
constexpr uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr uint32_t architecture = AUDIT_ARCH_AARCH64;
#elif defined(__arm__)
constexpr uint32_t architecture = AUDIT_ARCH_ARM;
#elif defined(__riscv) && __riscv_xlen == 64
constexpr uint32_t architecture = AUDIT_ARCH_RISCV64;
#else
constexpr uint32_t architecture = 0; // forbid_system_calls() says ENOSYS
#endif

// Calls that touch nothing beyond this process. Old names are not there on every processor.
const int allowed[] = {
    // a picture: wait for it, compute, reply
    SYS_futex,
    SYS_read,
    SYS_write,
    SYS_sched_yield,
    SYS_munmap,
    SYS_madvise,
    SYS_mprotect,
    SYS_mremap,
    SYS_brk,
    SYS_readv,
    SYS_writev,
    SYS_close,
#ifdef SYS_mmap
    SYS_mmap,
#endif
#ifdef SYS_mmap2
    SYS_mmap2,
#endif
#ifdef SYS_futex_time64
    SYS_futex_time64,
#endif
    // time
    SYS_clock_gettime,
    SYS_clock_getres,
    SYS_clock_nanosleep,
    SYS_nanosleep,
    SYS_gettimeofday,
    SYS_restart_syscall,
#ifdef SYS_clock_gettime64
    SYS_clock_gettime64,
    SYS_clock_nanosleep_time64,
#endif
#ifdef SYS_time
    SYS_time,
#endif
    // threads and signals of our own
    SYS_exit,
    SYS_exit_group,
    SYS_set_robust_list,
    SYS_rt_sigreturn,
    SYS_rt_sigprocmask,
    SYS_rt_sigaction,
    SYS_sigaltstack,
    SYS_getpid,
    SYS_gettid,
    SYS_getppid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getcpu,
    SYS_sched_getaffinity,
    SYS_membarrier,
#ifdef SYS_rseq
    SYS_rseq,
#endif
    // what the machine is
    SYS_uname,
    SYS_sysinfo,
    SYS_getrusage,
    SYS_getrandom,
    // files, for reading
    SYS_lseek,
    SYS_pread64,
    SYS_fstat,
    SYS_readlinkat,
    SYS_faccessat,
    SYS_getdents64,
    SYS_getcwd,
#ifdef SYS_newfstatat
    SYS_newfstatat,
#endif
#ifdef SYS_fstat64
    SYS_fstat64,
    SYS_fstatat64,
    SYS__llseek,
#endif
#ifdef SYS_statx
    SYS_statx,
#endif
#ifdef SYS_stat
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
#endif
    // waiting
    SYS_ppoll,
#ifdef SYS_poll
    SYS_poll,
#endif
};

// A call that is allowed if an argument, masked, has a value. Its low 32 bits are looked at.
struct Condition {
    int call;
    unsigned argument;
    uint32_t mask;
    uint32_t value;
};

// A glibc that finds clone3() absent uses clone(), whose flags a filter can see.
constexpr int absent_call = 435; // clone3, on every processor

constexpr uint32_t opens_to_write = O_ACCMODE | O_CREAT | O_TRUNC;

std::vector<Condition> conditions()
{
    const auto self = static_cast<uint32_t>(getpid());
    return {
        {SYS_openat, 2, opens_to_write, O_RDONLY},
#ifdef SYS_open
        {SYS_open, 1, opens_to_write, O_RDONLY},
#endif
        {SYS_clone, 0, CLONE_THREAD, CLONE_THREAD},
        {SYS_tgkill, 0, UINT32_MAX, self}, // abort() and the like
        {SYS_prctl, 0, UINT32_MAX, PR_SET_NAME},
    };
}

// A filter: a program for the kernel's virtual machine, which sees each call's seccomp_data.
class Filter
{
  public:
    void load(size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, static_cast<uint32_t>(offset)); }
    void mask(uint32_t bits) { add(BPF_ALU | BPF_AND | BPF_K, bits); }
    void give(uint32_t verdict) { add(BPF_RET | BPF_K, verdict); }
    // Skip so many instructions if what is loaded is `value`, or is not.
    void skip_if(uint32_t value, uint8_t count) { compare(value, count, 0); }
    void skip_unless(uint32_t value, uint8_t count) { compare(value, 0, count); }
    // Beside filters that there are: a call must pass all of them.
    bool install_for_all_threads()
    {
        const sock_fprog program{static_cast<unsigned short>(program_.size()), program_.data()};
        const long given =
            syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program);
        if (given > 0) // the number of a thread that cannot follow
            errno = EBUSY;
        return given == 0;
    }

  private:
    void compare(uint32_t value, uint8_t skipped_if, uint8_t skipped_unless)
    {
        program_.push_back({BPF_JMP | BPF_JEQ | BPF_K, skipped_if, skipped_unless, value});
    }
    void add(unsigned code, uint32_t operand)
    {
        program_.push_back({static_cast<uint16_t>(code), 0, 0, operand});
    }

    std::vector<sock_filter> program_;
};

constexpr size_t low_half_of(unsigned argument)
{
    return offsetof(seccomp_data, args) + argument * sizeof(uint64_t); // little-endian
}

Filter make_filter()
{
    Filter filter;
    // Other architectures, and other numbers of ours, would be other calls.
    filter.load(offsetof(seccomp_data, arch));
    filter.skip_if(architecture, 1);
    filter.give(SECCOMP_RET_KILL_PROCESS);
    filter.load(offsetof(seccomp_data, nr));
    for (const int call : allowed) {
        filter.skip_unless(static_cast<uint32_t>(call), 1);
        filter.give(SECCOMP_RET_ALLOW);
    }
    for (const Condition &condition : conditions()) {
        filter.skip_unless(static_cast<uint32_t>(condition.call), 5);
        filter.load(low_half_of(condition.argument));
        filter.mask(condition.mask);
        filter.skip_unless(condition.value, 1);
        filter.give(SECCOMP_RET_ALLOW);
        filter.give(SECCOMP_RET_ERRNO | EPERM);
    }
    filter.skip_unless(absent_call, 1);
    filter.give(SECCOMP_RET_ERRNO | ENOSYS);
    filter.give(SECCOMP_RET_ERRNO | EPERM);
    return filter;
}

void limit(int resource, rlim_t most)
{
    rlimit limit{};
    if (getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0)
        return;
    limit.rlim_max = std::min(limit.rlim_max, most);
    limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
    setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

// Bytes of address space in use; 0 if the system does not tell.
uint64_t address_space()
{
    std::FILE *const file = std::fopen("/proc/self/statm", "re");
    unsigned long pages = 0;
    // NOLINTNEXTLINE(*-string-to-number-conversion,cert-err34-c): the kernel writes what fits
    if (file && std::fscanf(file, "%lu", &pages) != 1)
        pages = 0;
    if (file)
        std::fclose(file);
    return uint64_t{pages} * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

} // namespace

void end_with(pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) // it ended before that call
        _exit(0);
}

void forbid_file_growth()
{
    signal(SIGXFSZ, SIG_IGN);
    limit(RLIMIT_FSIZE, 0);
    limit(RLIMIT_CORE, 0);
}

void limit_growth(uint64_t bytes)
{
    limit(RLIMIT_AS, address_space() + bytes);
}

bool forbid_system_calls()
{
    if (architecture == 0) {
        errno = ENOSYS;
        return false;
    }
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && make_filter().install_for_all_threads();
}

} // namespace vdna::selectord
