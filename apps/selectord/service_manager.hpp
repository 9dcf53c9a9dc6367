// What the service manager (systemd) hears of the daemon, as sd_notify(3) describes it.
#pragma once

#include <string>

#include <sys/socket.h>
#include <sys/un.h>

namespace vdna::selectord
{

// Never waits: a message for which its receiver has no room is lost.
class ServiceManager
{
  public:
    // `address` is that of $NOTIFY_SOCKET: a path, or @ and an abstract name; nullptr or "" = there
    // is no service manager, and all calls do nothing. Throws Error.
    explicit ServiceManager(const char *address);
    ~ServiceManager();
    ServiceManager(const ServiceManager &) = delete;
    ServiceManager &operator=(const ServiceManager &) = delete;

    void ready() const;     // at the end of the start, and of each reload
    void reloading() const; // at its begin
    void stopping() const;
    void alive() const; // feeds the watchdog

  private:
    void tell(const std::string &message) const;

    int socket_ = -1;
    sockaddr_un address_{};
    socklen_t address_size_ = 0;
};

} // namespace vdna::selectord
