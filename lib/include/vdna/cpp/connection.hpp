/** @file vdna/cpp/connection.hpp
 *  @brief An open LCM connection; it closes itself.
 */
#ifndef VDNA_CPP_CONNECTION_HPP
#define VDNA_CPP_CONNECTION_HPP

#include <memory>
#include <string>

#include <vdna/cpp/error.hpp>
#include <vdna/transport.h>

namespace vdna
{

struct CloseTransport {
    void operator()(vdna_transport *transport) const { vdna_transport_close(transport); }
};

using Connection = std::unique_ptr<vdna_transport, CloseTransport>;

/** A URL as the C interface takes it, which borrows it: NULL, for LCM's default, in place of "". */
inline const char *url_or_default(const std::string &url)
{
    return url.empty() ? nullptr : url.c_str();
}

/** Connect and subscribe; throws Error. */
inline Connection connect(const vdna_transport_config &config)
{
    vdna_transport *transport = nullptr;
    vdna_error error{};
    require(vdna_transport_open(&config, &error, &transport), error);
    return Connection(transport);
}

/** Connect to send alone; throws Error. url: "" = LCM's default. */
inline Connection connect_to_send(const std::string &url)
{
    vdna_transport_config config;
    vdna_transport_config_init(&config);
    config.url = url_or_default(url);
    return connect(config);
}

} // namespace vdna

#endif
