#include "selectord/backbone_child.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>

#include <sys/prctl.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "program/exit_code.hpp"
#include "selectord/backbone_mailbox.hpp"
#include "selectord/confinement.hpp"
#include "selectord/glance.hpp"
#include "selectord/memory_statement.hpp"

namespace vdna::selectord
{

namespace
{

// Address space that opening a network may take: no network of ours comes near it, and a request
// for all memory of the machine fails.
constexpr uint64_t opening_bytes = uint64_t{4} << 30;

// Address space for pictures beyond that of an open network: glibc reserves 64 MiB for each thread
// that allocates.
constexpr uint64_t running_bytes = uint64_t{256} << 20;

vdna_status fail(vdna_error &error, vdna_status status, const char *sentence, const char *why = "")
{
    std::snprintf(error.text, sizeof error.text, sentence, why);
    return status;
}

class Child
{
  public:
    ~Child() { vdna_backbone_close(backbone_); }

    // Reply to requests until there are no more. Gives the exit code.
    int serve();

  private:
    vdna_status open(BackboneReply &reply);
    vdna_status run(BackboneReply &reply);
    vdna_status look(BackboneReply &reply);
    void put_numbers(const vdna_backbone_frame &frame, BackboneReply &reply);
    vdna_status confine(vdna_error &error);
    vdna_image picture() const;

    const BackboneMailbox mailbox_;
    vdna_backbone *backbone_ = nullptr;
    std::optional<Glance> glance_;
};

bool await_request()
{
    char byte;
    return read(go_fd, &byte, 1) == 1;
}

int Child::serve()
{
    end_with(mailbox_.request().parent);
    while (await_request()) {
        BackboneReply &reply = mailbox_.reply();
        const uint64_t number = mailbox_.request().number;
        reply.error = {};
        reply.status = number == 0                ? open(reply)
                       : mailbox_.request().looks ? look(reply)
                                                  : run(reply);
        reply.number = number;
        const char byte = 0;
        if (write(done_fd, &byte, 1) != 1 || !backbone_)
            return program::exit_failed;
    }
    return program::exit_ok;
}

vdna_status Child::open(BackboneReply &reply)
{
    const BackboneRequest &request = mailbox_.request();
    vdna_backbone_config config;
    vdna_backbone_config_init(&config);
    config.threads = request.threads;
    config.max_pixels = request.max_pixels;
    config.manifest = request.manifest;
    config.runtime = request.runtime[0] ? request.runtime : nullptr;
    vdna_backbone *opened = nullptr;
    vdna_status status = vdna_backbone_open(&config, &reply.error, &opened);
    if (status != VDNA_OK)
        return status;
    vdna_backbone_describe(opened, &reply.info);
    // The daemon has no use for what the network is given.
    reply.info.input_width = reply.info.input_height = 0;
    if (numbers_of(reply.info) > numbers_bytes_max / sizeof(float))
        status = fail(reply.error, VDNA_ERR_UNSUPPORTED,
                      "the network gives more numbers for a frame than a process of its own can "
                      "pass on; tap less, or set [backbone] process = false");
    else
        status = confine(reply.error);
    if (status == VDNA_OK)
        backbone_ = opened;
    else
        vdna_backbone_close(opened);
    return status;
}

// The one-way door: from here on the network can do no more than compute.
vdna_status Child::confine(vdna_error &error)
{
    try {
        if (mailbox_.request().lock_memory)
            lock_memory();
        if (mailbox_.request().looks)
            glance_.emplace(mailbox_.request().max_pixels);
    } catch (const Error &refusal) {
        return fail(error, VDNA_ERR_RUNTIME, "%s", refusal.what());
    }
    limit_growth(running_bytes + mailbox_.reply().info.decode_bytes);
    if (!forbid_system_calls())
        return fail(error, VDNA_ERR_RUNTIME,
                    "the network's process cannot be confined (seccomp): %s; permit that, or set "
                    "[backbone] process = false",
                    std::strerror(errno));
    return VDNA_OK;
}

vdna_status Child::run(BackboneReply &reply)
{
    const vdna_image image = picture();
    vdna_backbone_frame frame;
    const vdna_status status = vdna_backbone_run(backbone_, &image, &reply.error, &frame);
    if (status == VDNA_OK)
        put_numbers(frame, reply);
    return status;
}

vdna_status Child::look(BackboneReply &reply)
{
    return glance_ && glance_->look(picture(), reply.looked) ? VDNA_OK : VDNA_ERR_FORMAT;
}

vdna_image Child::picture() const
{
    vdna_image image = mailbox_.request().image;
    image.data = mailbox_.picture();
    return image;
}

void Child::put_numbers(const vdna_backbone_frame &frame, BackboneReply &reply)
{
    float *at = mailbox_.numbers();
    const auto put = [&at](const float *numbers, size_t count) {
        std::memcpy(at, numbers, count * sizeof *at);
        at += count;
    };
    for (size_t t = 0; t < frame.tap_count; t++) {
        const vdna_activations &tap = frame.taps[t];
        reply.layouts[t] = tap.layout;
        put(tap.values, size_t{tap.neurons} * tap.samples);
    }
    put(frame.embedding, frame.dim);
    if (frame.last_layer)
        put(frame.last_layer, frame.last_layer_dim);
    reply.frame = frame;
}

} // namespace

bool is_backbone_child(int argc, const char *const *argv)
{
    return argc == 2 && std::strcmp(argv[1], backbone_process_option) == 0;
}

int run_backbone_child()
{
    closefrom(done_fd + 1); // the daemon's connection, among others
    prctl(PR_SET_NAME, "vdna_backbone");
    forbid_file_growth();
    limit_growth(opening_bytes);
    return_large_blocks();
    Child child;
    return child.serve();
}

} // namespace vdna::selectord
