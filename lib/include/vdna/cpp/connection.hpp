/** @file vdna/cpp/connection.hpp
 *  @brief An open LCM connection; it closes itself.
 */
#ifndef VDNA_CPP_CONNECTION_HPP
#define VDNA_CPP_CONNECTION_HPP

#include <memory>

#include <vdna/cpp/error.hpp>
#include <vdna/transport.h>

namespace vdna
{

struct CloseTransport {
    void operator()(vdna_transport *transport) const { vdna_transport_close(transport); }
};

using Connection = std::unique_ptr<vdna_transport, CloseTransport>;

/** Connect and subscribe; throws Error. */
inline Connection connect(const vdna_transport_config &config)
{
    vdna_transport *transport = nullptr;
    vdna_error error{};
    require(vdna_transport_open(&config, &error, &transport), error);
    return Connection(transport);
}

} // namespace vdna

#endif
