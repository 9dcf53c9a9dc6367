// The page over HTTP: its files, the events of a LiveState, the camera's picture, and commands.
//
// Whoever reaches the address may look. Only who has the token may send commands, and no other page
// in the same browser: requests must name us as host by address, so that no foreign name can
// stand for us, and those that tell their origin must come from our own page.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "serve/live_state.hpp"
#include "serve/map_pictures.hpp"
#include "telemetry/commands.hpp"

namespace httplib
{
class Server;
struct Request;
struct Response;
} // namespace httplib

namespace vdna::serve
{

struct ServerSettings {
    std::string address; // to listen on
    int port;            // 0 = any
    std::string token;
    // Called by any thread, one at a time. Throws Error.
    std::function<void(const telemetry::Command &, const std::string &argument)> send;
    MapPictures *map_pictures = nullptr; // borrowed; null = the page shows no frames of a map
};

class PageServer
{
  public:
    // Listen, and serve in threads of its own until destruction, which closes `state`, a borrowed
    // one. Throws Error if the address cannot be had.
    PageServer(ServerSettings settings, LiveState &state);
    ~PageServer();

    int port() const { return port_; }
    size_t viewers() const { return viewers_; }
    // The system took the port away; nothing is served any more.
    bool has_ended() const { return ended_; }

    static constexpr size_t viewers_max = 16; // each has a thread; others are told to come back

  private:
    void serve_page();
    void serve_events(httplib::Response &response);
    void serve_picture(httplib::Response &response);
    void serve_map_picture(const httplib::Request &request, httplib::Response &response);
    void take_command(const httplib::Request &request, httplib::Response &response);

    const ServerSettings settings_;
    LiveState &state_;
    std::unique_ptr<httplib::Server> server_;
    int port_ = 0;
    std::atomic<size_t> viewers_{0};
    std::atomic<bool> ended_{false};
    std::mutex sending_;
    std::thread thread_;
};

} // namespace vdna::serve
