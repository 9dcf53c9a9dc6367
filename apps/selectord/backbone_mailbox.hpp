// The memory that the daemon shares with the process of its network: one request, one reply.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <vdna/backbone.h>
#include <vdna/parked.h>

namespace vdna::selectord
{

// File descriptors of the network's process.
constexpr int mailbox_fd = 3; // the mailbox
constexpr int go_fd = 4;      // a byte for each request; its end is the daemon's
constexpr int done_fd = 5;    // a byte for each reply

constexpr size_t taps_max = VDNA_TAPS_SIZE / 6 + 1;    // "a:1:1,"
constexpr size_t numbers_bytes_max = size_t{64} << 20; // of a frame
constexpr size_t path_size = 4096;                     // PATH_MAX

// Written by the daemon. Number 0 opens the network, every other one runs a picture or, with
// `looks`, only measures it.
struct BackboneRequest {
    uint64_t number;
    int32_t parent; // process id of the daemon
    uint32_t threads;
    uint32_t max_pixels;
    uint32_t lock_memory;
    uint32_t looks; // of number 0: there will be some
    char manifest[path_size];
    char runtime[path_size]; // "" = found automatically
    vdna_image image;        // its data is picture()
};

// Written by the network's process. The daemon trusts nothing of it; pointers mean nothing to it.
struct BackboneReply {
    uint64_t number; // of the request
    vdna_status status;
    vdna_error error;
    vdna_backbone_info info;    // of number 0
    vdna_backbone_frame frame;  // of a picture that was run
    vdna_parked_picture looked; // of one that was measured
    uint32_t layouts[taps_max]; // VDNA_LAYOUT_... of each tap
};

// How many numbers a frame has: of all taps, the embedding and the last layer, one after the other.
uint64_t numbers_of(const vdna_backbone_info &info);

// The taps that a description lists.
std::vector<vdna_tap> taps_of(const vdna_backbone_info &info);

// Anonymous memory: requests, reply, picture, numbers of a frame. Its size is sealed, so that
// neither side can take pages away from the other.
class BackboneMailbox
{
  public:
    // Make one for pictures of so many bytes. Throws Error.
    explicit BackboneMailbox(size_t picture_bytes);
    // Map the one of mailbox_fd, which is closed then. Throws Error.
    BackboneMailbox();
    ~BackboneMailbox();
    BackboneMailbox(const BackboneMailbox &) = delete;
    BackboneMailbox &operator=(const BackboneMailbox &) = delete;

    int file() const { return file_; }
    BackboneRequest &request() const;
    BackboneReply &reply() const;
    uint8_t *picture() const;
    size_t picture_bytes() const;
    float *numbers() const;

  private:
    void map(size_t size);

    int file_ = -1;
    uint8_t *memory_ = nullptr;
    size_t size_ = 0;
};

} // namespace vdna::selectord
