#include "selectord/service_manager.hpp"

#include <cerrno>
#include <cstddef>
#include <cstring>

#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "program/clock.hpp"

namespace vdna::selectord
{

ServiceManager::ServiceManager(const char *address)
{
    const std::string name = address ? address : "";
    if (name.empty())
        return;
    if ((name[0] != '/' && name[0] != '@') || name.size() >= sizeof address_.sun_path)
        throw Error("NOTIFY_SOCKET is \"" + name + "\", expected a path or @NAME of less than " +
                    std::to_string(sizeof address_.sun_path) +
                    " bytes; leave it unset without a service manager");
    address_.sun_family = AF_UNIX;
    std::memcpy(address_.sun_path, name.data(), name.size());
    if (name[0] == '@')
        address_.sun_path[0] = '\0'; // an abstract name
    address_size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());

    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (socket_ < 0)
        throw Error("NOTIFY_SOCKET is \"" + name +
                    "\", but there is no socket for it: " + std::strerror(errno) +
                    "; allow AF_UNIX by RestrictAddressFamilies= in the "
                    "systemd unit, or set its Type=exec");
}

ServiceManager::~ServiceManager()
{
    if (socket_ >= 0)
        close(socket_);
}

void ServiceManager::tell(const std::string &message) const
{
    if (socket_ >= 0)
        sendto(socket_, message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
               reinterpret_cast<const sockaddr *>(&address_), address_size_);
}

void ServiceManager::ready() const
{
    tell("READY=1");
}

void ServiceManager::reloading() const
{
    tell("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(program::monotonic_us()));
}

void ServiceManager::stopping() const
{
    tell("STOPPING=1");
}

void ServiceManager::alive() const
{
    tell("WATCHDOG=1");
}

} // namespace vdna::selectord
