// The system calls on a camera's device, so that a test can play a camera.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vdna::frames
{

// Calls the system; results and errno are the system's.
class DeviceCalls
{
  public:
    virtual ~DeviceCalls() = default;
    virtual int open(const char *path);
    virtual int ioctl(int fd, unsigned long request, void *argument);
    // Shared, to be read.
    virtual void *mmap(int fd, size_t size, int64_t offset);
    virtual int munmap(void *data, size_t size);
    // Wait until a frame can be taken: 1; 0 if there is none in time.
    virtual int poll(int fd, int timeout_ms);
    virtual int close(int fd);
    virtual int64_t monotonic_us();
    virtual int64_t wall_us();
};

} // namespace vdna::frames
