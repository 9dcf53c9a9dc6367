// Counts the allocations of a program by caller (LD_PRELOAD, 64-bit glibc).
//
// Each call of malloc and its sisters is charged to one loaded object: the first one up the stack
// that is neither the C nor the C++ library nor the loader, which only allocate on behalf of
// others. So the growth of a std::string in our code is ours, and allocations by OpenCV, ONNX
// Runtime, LCM and libjpeg are theirs, even if we called them.
//
// The counts are in the file $VDNA_ALLOCATIONS.PID, for others to read while the program runs:
// see allocations.py.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <unwind.h>

#define OBJECTS_MAX 512
#define DEPTH_MAX 64
#define EXPORTED __attribute__((visibility("default")))

// glibc's own functions, under the names that it keeps for interposers.
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *block);

// Layout of the file.
typedef struct counts {
    _Atomic int64_t live_bytes; // allocated and not freed, by everyone
    struct {
        char name[120];
        _Atomic uint64_t calls;
    } objects[OBJECTS_MAX];
} counts;

// The code of a loaded object.
typedef struct code {
    uintptr_t begin, end;
    bool carrier; // allocates on behalf of others
} code;

static counts first_counts;
static counts *_Atomic current = &first_counts;
static code codes[OBJECTS_MAX];
static atomic_int known;
static atomic_flag learning = ATOMIC_FLAG_INIT;
static __thread bool inside __attribute__((tls_model("initial-exec")));

static bool is_carrier(const char *name)
{
    static const char *const carriers[] = {"libc.so", "libstdc++.so", "ld-linux", "liballocations",
                                           "libgcc_s"};
    for (size_t i = 0; i < sizeof carriers / sizeof *carriers; i++)
        if (strstr(name, carriers[i]))
            return true;
    return false;
}

static int learn(struct dl_phdr_info *info, size_t size, void *unused)
{
    (void)size;
    (void)unused;
    const char *slash = strrchr(info->dlpi_name, '/');
    const char *name = slash ? slash + 1 : *info->dlpi_name ? info->dlpi_name : "program";
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *segment = &info->dlpi_phdr[i];
        const uintptr_t begin = info->dlpi_addr + segment->p_vaddr;
        bool seen = segment->p_type != PT_LOAD || !(segment->p_flags & PF_X);
        for (int k = 0; k < known && !seen; k++)
            seen = codes[k].begin == begin;
        if (seen || known == OBJECTS_MAX)
            continue;
        codes[known] = (code){begin, begin + segment->p_memsz, is_carrier(name)};
        strncpy(current->objects[known].name, name, sizeof current->objects[known].name - 1);
        known++;
    }
    return 0;
}

static int find(uintptr_t address)
{
    for (int k = 0; k < known; k++)
        if (address >= codes[k].begin && address < codes[k].end)
            return k;
    return -1;
}

// The index of the object that holds an address; newly loaded libraries are added.
static int object_of(uintptr_t address)
{
    int k = find(address);
    if (k < 0 && !atomic_flag_test_and_set(&learning)) {
        dl_iterate_phdr(learn, NULL);
        atomic_flag_clear(&learning);
        k = find(address);
    }
    return k;
}

typedef struct search {
    int found;
    int depth;
} search;

static _Unwind_Reason_Code visit(struct _Unwind_Context *context, void *data)
{
    search *s = data;
    const int k = object_of(_Unwind_GetIP(context));
    if (++s->depth > DEPTH_MAX)
        return _URC_END_OF_STACK;
    if (k < 0 || codes[k].carrier)
        return _URC_NO_REASON;
    s->found = k;
    return _URC_END_OF_STACK;
}

static void charge(void *block, uintptr_t caller)
{
    if (!block)
        return;
    atomic_fetch_add(&current->live_bytes, (int64_t)malloc_usable_size(block));
    if (inside)
        return;
    inside = true;
    search s = {object_of(caller), 0};
    if (s.found < 0 || codes[s.found].carrier)
        _Unwind_Backtrace(visit, &s);
    if (s.found >= 0)
        atomic_fetch_add(&current->objects[s.found].calls, 1);
    inside = false;
}

static void uncharge(void *block)
{
    if (block)
        atomic_fetch_sub(&current->live_bytes, (int64_t)malloc_usable_size(block));
}

#define CALLER ((uintptr_t)__builtin_return_address(0))

EXPORTED void *malloc(size_t size)
{
    void *block = __libc_malloc(size);
    charge(block, CALLER);
    return block;
}

EXPORTED void *calloc(size_t count, size_t size)
{
    void *block = __libc_calloc(count, size);
    charge(block, CALLER);
    return block;
}

EXPORTED void *realloc(void *block, size_t size)
{
    uncharge(block);
    void *moved = __libc_realloc(block, size);
    charge(moved, CALLER);
    return moved;
}

EXPORTED void *memalign(size_t alignment, size_t size)
{
    void *block = __libc_memalign(alignment, size);
    charge(block, CALLER);
    return block;
}

EXPORTED void *aligned_alloc(size_t alignment, size_t size)
{
    void *block = __libc_memalign(alignment, size);
    charge(block, CALLER);
    return block;
}

EXPORTED int posix_memalign(void **out_block, size_t alignment, size_t size)
{
    void *block = __libc_memalign(alignment, size);
    if (!block)
        return ENOMEM;
    charge(block, CALLER);
    *out_block = block;
    return 0;
}

EXPORTED void free(void *block)
{
    uncharge(block);
    __libc_free(block);
}

__attribute__((constructor)) static void open_file(void)
{
    const char *prefix = getenv("VDNA_ALLOCATIONS");
    char path[4096];
    snprintf(path, sizeof path, "%s.%d", prefix ? prefix : "", (int)getpid());
    const int file = prefix ? open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666) : -1;
    if (file < 0 || ftruncate(file, sizeof(counts)) != 0)
        return;
    void *shared = mmap(NULL, sizeof(counts), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (shared == MAP_FAILED)
        return;
    memcpy(shared, &first_counts, sizeof first_counts);
    current = shared;
}
