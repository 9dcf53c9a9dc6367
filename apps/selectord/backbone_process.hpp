// A network in a process of its own, which may crash, hang or ask for all memory: the daemon goes
// on, says so, ends it if need be, and starts it again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

#include <vdna/cpp/backbone.hpp>

#include "selectord/backbone_mailbox.hpp"
#include "selectord/config.hpp"
#include "selectord/resident_memory.hpp"

namespace vdna::selectord
{

// Whether a network that gives this has replied, if only that it cannot use the picture or that its
// numbers are not finite: it is alive.
bool has_replied(vdna_status network);

// Whether the network is to blame for it, and not the picture.
bool is_at_fault(vdna_status network);

// Never waits for the process longer than its budget, except for open(). A picture that finds it
// busy or absent is refused at once; each picture takes the next step towards a process that works.
// SIGPIPE must be ignored. All but cancelling is for one thread, with which the process ends too.
class BackboneProcess
{
  public:
    // Start it: it opens its network, for which open() waits. Borrows from `config`; `lock` the
    // process's memory. Throws Error.
    explicit BackboneProcess(const Config &config, bool lock = false);
    ~BackboneProcess();
    BackboneProcess(const BackboneProcess &) = delete;
    BackboneProcess &operator=(const BackboneProcess &) = delete;

    // Wait until its network is open, and run that once. Call it once; the result borrows from
    // this object. Throws Error.
    Backbone open();

    // Measure a picture in it, as Glance does. Returns false if that cannot be had.
    bool look(const vdna_image &image, vdna_parked_picture &out_picture);

    // Process id; 0 = there is none at the moment.
    pid_t pid() const { return pid_; }
    // Of the process, and the most of any so far. Allocates nothing.
    Resident resident();
    // Bytes that both processes share and touch, at most.
    uint64_t shared_bytes() const;

  private:
    enum class State {
        idle,    // waits for a picture
        opening, // until deadline_us_
        late,    // has a picture that was given up, until deadline_us_
        ending,  // killed, not yet gone
        away,    // until restart_us_
        refused  // for ever
    };
    enum class Event { replied, hung_up, timed_out, cancelled };

    static const vdna_backbone_operations operations;

    vdna_status open(vdna_error &error);
    vdna_status run(const vdna_image &image, vdna_error &error, vdna_backbone_frame &out_frame);
    void cancel();

    // Its life.
    void start();
    int spawn();
    void go_on();
    void listen();
    void note_end();
    void end(const std::string &why);
    bool reap();
    void come_back_later();

    // What is said to it and heard from it.
    void post(uint64_t number);
    vdna_status ask(const vdna_image &image, bool looks, vdna_error &error);
    Event wait(int64_t deadline_us);
    vdna_status take_reply(vdna_error &error);
    vdna_status take_first_description(vdna_error &error);
    void take_description();
    void take_numbers(vdna_backbone_frame &out_frame);
    size_t number_bytes() const { return numbers_.size() * sizeof(float); }
    vdna_status find_budget(vdna_error &error);
    vdna_status refuse(vdna_error &error) const;

    const Config &config_;
    const bool lock_;
    const BackboneMailbox mailbox_;
    const int stop_; // an eventfd, which cancel() sets
    int go_ = -1, done_ = -1;
    pid_t pid_ = 0;
    int exit_status_ = 0; // of waitpid()
    int64_t resident_most_ = 0;
    State state_ = State::away;
    bool is_other_ = false; // it came back as another network
    std::string reason_;    // "it ...": why it is not there
    int64_t opening_us_;    // that opening may take
    // That a picture may take: after it the picture is refused, after twice as much the process is
    // ended.
    int64_t budget_us_;
    int64_t deadline_us_ = 0;
    int64_t restart_us_ = 0;
    int64_t pause_us_;      // before the next start
    uint64_t number_ = 0;   // of the newest request
    BackboneReply reply_{}; // copied before it is checked: the process could change it
    vdna_backbone_info info_{};
    std::vector<float> numbers_;
    std::vector<vdna_activations> taps_;
};

} // namespace vdna::selectord
