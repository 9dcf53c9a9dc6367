// What is heard on the LCM network, made into what the page shows.
#pragma once

#include <deque>
#include <string>

#include <vdna/cpp/connection.hpp>
#include <vdna/cpp/listener.hpp>

#include "serve/camera_jpeg.hpp"
#include "serve/live_state.hpp"
#include "telemetry/message_text.hpp"
#include "telemetry/newest.hpp"

namespace vdna::serve
{

struct Channels {
    std::string url;                // "" = LCM's default
    std::string camera;             //
    std::vector<std::string> views; // of each of telemetry::views()
};

class Reception
{
  public:
    // Connect; `state` is borrowed. Throws Error.
    Reception(const Channels &channels, LiveState &state);

    // Take what has come, for some 50 ms. Throws Error if the network is gone.
    // viewers: who see the page; without any no picture is made
    void run_once(size_t viewers);

  private:
    using Json = nlohmann::ordered_json;

    void take(const vdna_listener_message &message);
    void take(const vdna_transport_frame &frame);
    void put(const char *kind, const Json &json);
    void put_headline();
    void each_second(size_t viewers);
    double camera_hz() const;

    LiveState &state_;
    Connection camera_;
    Listener listener_;
    CameraJpeg jpeg_;

    const std::string url_; // of the network
    telemetry::Newest newest_;
    Json answer_;            // newest localisation of this second; null = none
    int64_t frame_us_ = 0;   // when the newest came, monotonic; 0 = none
    int64_t picture_us_ = 0; // when the newest picture was made
    int64_t second_us_ = 0;  // when each_second() ran
    struct Count {
        int64_t us;
        uint64_t frames;
    };
    std::deque<Count> counts_; // of camera frames, one a second
};

} // namespace vdna::serve
