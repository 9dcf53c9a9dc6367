#include "frames/device_calls.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "program/clock.hpp"

namespace vdna::frames
{

int DeviceCalls::open(const char *path)
{
    return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

int DeviceCalls::ioctl(int fd, unsigned long request, void *argument)
{
    return ::ioctl(fd, request, argument);
}

void *DeviceCalls::mmap(int fd, size_t size, int64_t offset)
{
    return ::mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, offset);
}

int DeviceCalls::munmap(void *data, size_t size)
{
    return ::munmap(data, size);
}

int DeviceCalls::poll(int fd, int timeout_ms)
{
    pollfd wait{fd, POLLIN, 0};
    return ::poll(&wait, 1, timeout_ms);
}

int DeviceCalls::close(int fd)
{
    return ::close(fd);
}

int64_t DeviceCalls::monotonic_us()
{
    return program::monotonic_us();
}

int64_t DeviceCalls::wall_us()
{
    return program::wall_us();
}

} // namespace vdna::frames
