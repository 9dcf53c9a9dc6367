#include "selectord/backbone_mailbox.hpp"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

namespace vdna::selectord
{

namespace
{

struct Letters {
    BackboneRequest request;
    BackboneReply reply;
};

constexpr size_t block = 4096; // what begins a part of the mailbox
constexpr size_t letters_bytes = (sizeof(Letters) + block - 1) / block * block;

[[noreturn]] void fail(const char *call)
{
    throw Error(std::string("the memory to share with the network's process cannot be made: ") +
                call + ": " + std::strerror(errno) +
                "; see to it, or set [backbone] process = false");
}

} // namespace

uint64_t numbers_of(const vdna_backbone_info &info)
{
    uint64_t numbers = uint64_t{info.identity.dim} + info.last_layer_dim;
    for (const vdna_tap &tap : taps_of(info)) {
        const uint64_t more = uint64_t{tap.neurons} * tap.samples;
        numbers = more > UINT64_MAX - numbers ? UINT64_MAX : numbers + more;
    }
    return numbers;
}

std::vector<vdna_tap> taps_of(const vdna_backbone_info &info)
{
    std::vector<vdna_tap> taps;
    const char *rest = info.identity.taps;
    for (vdna_tap tap; vdna_taps_next(&rest, &tap) == VDNA_OK;)
        taps.push_back(tap);
    return taps;
}

BackboneMailbox::BackboneMailbox(size_t picture_bytes)
    : file_(memfd_create("vdna_backbone", MFD_CLOEXEC | MFD_ALLOW_SEALING))
{
    if (file_ < 0)
        fail("memfd_create");
    const size_t size =
        letters_bytes + (picture_bytes + block - 1) / block * block + numbers_bytes_max;
    if (ftruncate(file_, static_cast<off_t>(size)) != 0 ||
        fcntl(file_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
        close(file_);
        fail("memfd");
    }
    map(size);
}

BackboneMailbox::BackboneMailbox() : file_(mailbox_fd)
{
    struct stat status;
    if (fstat(file_, &status) != 0 ||
        static_cast<size_t>(status.st_size) < letters_bytes + numbers_bytes_max)
        fail("fstat");
    map(static_cast<size_t>(status.st_size));
    close(file_);
    file_ = -1;
}

void BackboneMailbox::map(size_t size)
{
    void *const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    if (memory == MAP_FAILED) {
        close(file_);
        fail("mmap");
    }
    memory_ = static_cast<uint8_t *>(memory);
    size_ = size;
}

BackboneMailbox::~BackboneMailbox()
{
    munmap(memory_, size_);
    if (file_ >= 0)
        close(file_);
}

BackboneRequest &BackboneMailbox::request() const
{
    return reinterpret_cast<Letters *>(memory_)->request;
}

BackboneReply &BackboneMailbox::reply() const
{
    return reinterpret_cast<Letters *>(memory_)->reply;
}

uint8_t *BackboneMailbox::picture() const
{
    return memory_ + letters_bytes;
}

size_t BackboneMailbox::picture_bytes() const
{
    return size_ - letters_bytes - numbers_bytes_max;
}

float *BackboneMailbox::numbers() const
{
    return reinterpret_cast<float *>(memory_ + size_ - numbers_bytes_max);
}

} // namespace vdna::selectord
