/** @file vdna/cpp/listener.hpp
 *  @brief A listener to LCM messages; it closes itself.
 */
#ifndef VDNA_CPP_LISTENER_HPP
#define VDNA_CPP_LISTENER_HPP

#include <memory>

#include <vdna/cpp/error.hpp>
#include <vdna/listener.h>

namespace vdna
{

struct CloseListener {
    void operator()(vdna_listener *listener) const { vdna_listener_close(listener); }
};

using Listener = std::unique_ptr<vdna_listener, CloseListener>;

/** Connect and listen; throws Error. */
inline Listener open_listener(const vdna_listener_config &config)
{
    vdna_listener *listener = nullptr;
    vdna_error error{};
    require(vdna_listener_open(&config, &error, &listener), error);
    return Listener(listener);
}

} // namespace vdna

#endif
