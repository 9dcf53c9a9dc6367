// An open LCM connection for the programs; closes itself.
#pragma once

#include <memory>

#include <vdna/transport.h>

#include "error.hpp"

namespace vdna
{

struct CloseTransport {
    void operator()(vdna_transport *transport) const { vdna_transport_close(transport); }
};
using Connection = std::unique_ptr<vdna_transport, CloseTransport>;

// Throws Error.
inline Connection connect(const vdna_transport_config &config)
{
    vdna_transport *transport = nullptr;
    vdna_error error{};
    require(vdna_transport_open(&config, &error, &transport), error);
    return Connection(transport);
}

} // namespace vdna
