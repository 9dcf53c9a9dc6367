#include "selectord/backbone_process.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vdna/cpp/error.hpp>

#include "program/clock.hpp"
#include "program/exit_code.hpp"
#include "selectord/backbone_child.hpp"

namespace vdna::selectord
{

namespace
{

using program::monotonic_us;

// What opening may take: at first, a large network on a slow card; then by the first.
constexpr int64_t first_opening_us = 120 * 1000000, shortest_opening_us = 5 * 1000000;
constexpr int64_t openings_in_limit = 10;

constexpr int64_t shortest_pause_us = 10000, longest_pause_us = 5000000;
constexpr int64_t reaping_us =
    100000; // what a killed process may take; if longer, it goes on later

// A budget that nobody set: networks have been seen to take 8 times as long beside a load.
constexpr int64_t shortest_budget_us = 500000;
constexpr int64_t trials_in_budget = 10;

[[gnu::format(printf, 3, 4)]] vdna_status fail(vdna_error &error, vdna_status status,
                                               const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(error.text, sizeof error.text, format, arguments);
    va_end(arguments);
    return status;
}

// A sentence of the process, without anything that would end it, or a terminal obey.
vdna_error printable(vdna_error error)
{
    error.text[sizeof error.text - 1] = '\0';
    for (char *at = error.text; *at; at++)
        if (std::iscntrl(static_cast<unsigned char>(*at)))
            *at = '?';
    return error;
}

int make_event()
{
    const int event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (event < 0)
        throw Error(std::string("no event can be made for the network's process: ") +
                    std::strerror(errno));
    return event;
}

std::string how_it_ended(int status)
{
    if (WIFSIGNALED(status))
        return "it was ended by signal " + std::to_string(WTERMSIG(status)) + " (" +
               strsignal(WTERMSIG(status)) + ")";
    return "it ended with exit code " + std::to_string(WEXITSTATUS(status));
}

std::string milliseconds(int64_t us)
{
    return std::to_string(us / 1000) + " ms";
}

void copy_path(char (&out)[path_size], const std::string &path)
{
    std::snprintf(out, sizeof out, "%s", path.c_str());
}

// A file descriptor that is none of those that spawn() gives away.
int raise(int file)
{
    const int raised = fcntl(file, F_DUPFD_CLOEXEC, 2 * done_fd);
    close(file);
    return raised;
}

// Both ends of a pipe, raised. Gives 0 or what is wrong.
int make_pipe(int (&ends)[2])
{
    if (pipe2(ends, O_CLOEXEC) != 0)
        return errno;
    for (int &end : ends)
        end = raise(end);
    return ends[0] < 0 || ends[1] < 0 ? EMFILE : 0;
}

void close_end(int &end)
{
    if (end >= 0)
        close(end);
    end = -1;
}

// What follows fork(): nothing but system calls, because another thread may have held any lock.
[[noreturn]] void become_child(int mailbox, int go, int done)
{
    const int nothing = ::open("/dev/null", O_RDWR);
    for (int standard = 0; standard <= 2; standard++)
        dup2(nothing, standard); // NOLINT(*-unix.StdCLibraryFunctions): without it, they stay
    dup2(mailbox, mailbox_fd);
    dup2(go, go_fd);
    dup2(done, done_fd);

    // It ends when the daemon does, which may be signalled with all processes of its group.
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int number : {SIGTERM, SIGINT, SIGHUP})
        sigaddset(&blocked, number);
    sigprocmask(SIG_SETMASK, &blocked, nullptr);

    execl("/proc/self/exe", "vdna_selectord", backbone_process_option, nullptr);
    _exit(program::exit_failed);
}

// Start this program as the process of a network. Gives 0 or what is wrong. posix_spawn() would
// wait for its exec, which a signal to stop may keep from coming.
int spawn_child(int mailbox, int go, int done, pid_t &out_pid)
{
    out_pid = fork();
    if (out_pid == 0)
        become_child(mailbox, go, done);
    return out_pid < 0 ? errno : 0;
}

} // namespace

bool has_replied(vdna_status network)
{
    return !is_at_fault(network) || network == VDNA_ERR_NONFINITE;
}

bool is_at_fault(vdna_status network)
{
    return network != VDNA_OK && network != VDNA_ERR_FORMAT && network != VDNA_ERR_UNSUPPORTED;
}

const vdna_backbone_operations BackboneProcess::operations = {
    sizeof(vdna_backbone_operations),
    VDNA_BACKBONE_OPERATIONS,
    [](const vdna_backbone_config *config, vdna_error *error, void **out_state) {
        // open_with() hands the manifest over as it is: it is this object, for want of a context.
        auto *const process =
            reinterpret_cast<BackboneProcess *>(const_cast<char *>(config->manifest));
        *out_state = process;
        return process->open(*error);
    },
    [](void *state) { static_cast<BackboneProcess *>(state)->end("it was closed"); },
    [](const void *state, vdna_backbone_info *out_info) {
        *out_info = static_cast<const BackboneProcess *>(state)->info_;
    },
    [](void *state, const vdna_image *image, vdna_error *error, vdna_backbone_frame *out_frame) {
        return static_cast<BackboneProcess *>(state)->run(*image, *error, *out_frame);
    },
    [](void *state) { static_cast<BackboneProcess *>(state)->cancel(); },
};

BackboneProcess::BackboneProcess(const Config &config, bool lock)
    : config_(config), lock_(lock), mailbox_(config.max_image_bytes), stop_(make_event()),
      opening_us_(first_opening_us), budget_us_(first_opening_us), pause_us_(shortest_pause_us)
{
    start();
}

BackboneProcess::~BackboneProcess()
{
    end("it was closed");
    close(stop_);
}

Backbone BackboneProcess::open()
{
    return Backbone(operations, reinterpret_cast<const char *>(this));
}

Resident BackboneProcess::resident()
{
    Resident resident;
    if (pid_ > 0)
        resident = ResidentMemory(pid_).read();
    resident_most_ = std::max(resident_most_, resident.most);
    resident.most = resident_most_;
    return resident;
}

uint64_t BackboneProcess::shared_bytes() const
{
    const size_t letters = sizeof(BackboneRequest) + sizeof(BackboneReply);
    return letters + mailbox_.picture_bytes() + number_bytes();
}

vdna_status BackboneProcess::open(vdna_error &error)
{
    if (state_ == State::opening && wait(deadline_us_) != Event::replied)
        note_end();
    if (state_ != State::opening)
        return fail(error, VDNA_ERR_RUNTIME,
                    "%s: the network cannot be opened in a process of its own: %s; see whether "
                    "[backbone] process = false tells more",
                    config_.manifest.c_str(), reason_.c_str());
    const vdna_status status = take_first_description(error);
    if (status != VDNA_OK)
        return status;
    // From its start, so it may count what the daemon did meanwhile.
    const int64_t took_us = monotonic_us() - (deadline_us_ - first_opening_us);
    opening_us_ = std::clamp(openings_in_limit * took_us, shortest_opening_us, first_opening_us);
    return find_budget(error);
}

vdna_status BackboneProcess::run(const vdna_image &image, vdna_error &error,
                                 vdna_backbone_frame &out_frame)
{
    const vdna_status status = ask(image, false, error);
    if (status == VDNA_OK)
        take_numbers(out_frame);
    return status;
}

bool BackboneProcess::look(const vdna_image &image, vdna_parked_picture &out_picture)
{
    vdna_error error;
    if (ask(image, true, error) != VDNA_OK)
        return false;
    out_picture = reply_.looked;
    return true;
}

// Have it run a picture, or look at it, and take the reply.
vdna_status BackboneProcess::ask(const vdna_image &image, bool looks, vdna_error &error)
{
    go_on();
    if (state_ != State::idle)
        return refuse(error);
    if (image.size > mailbox_.picture_bytes())
        return fail(error, VDNA_ERR_UNSUPPORTED,
                    "the picture has %zu bytes, expected at most %zu ([lcm] max_image_bytes)",
                    image.size, mailbox_.picture_bytes());

    const int64_t begin_us = monotonic_us();
    mailbox_.request().image = image;
    mailbox_.request().looks = looks;
    std::copy_n(image.data, image.size, mailbox_.picture());
    post(number_ + 1);
    switch (wait(begin_us + budget_us_)) {
    case Event::replied:
        return take_reply(error);
    case Event::hung_up:
        note_end();
        return refuse(error);
    case Event::timed_out:
        state_ = State::late;
        deadline_us_ = begin_us + 2 * budget_us_;
        return refuse(error);
    case Event::cancelled:
        break;
    }
    return fail(error, VDNA_ERR_RUNTIME, "the backbone was cancelled");
}

// Another thread's; run() sees it, and no other run follows.
void BackboneProcess::cancel()
{
    eventfd_write(stop_, 1);
}

void BackboneProcess::start()
{
    BackboneRequest &request = mailbox_.request(); // the last process may have changed it
    request.parent = getpid();
    request.threads = config_.threads;
    request.max_pixels = config_.max_image_pixels;
    request.lock_memory = lock_;
    request.looks = config_.parked > 0;
    copy_path(request.manifest, config_.manifest);
    copy_path(request.runtime, config_.runtime);

    const int status = spawn();
    if (status != 0) {
        reason_ = std::string("it could not be started: ") + std::strerror(status);
        return come_back_later();
    }
    state_ = State::opening;
    deadline_us_ = monotonic_us() + opening_us_;
    post(0);
}

int BackboneProcess::spawn()
{
    int go[2] = {-1, -1}, done[2] = {-1, -1};
    int mailbox = fcntl(mailbox_.file(), F_DUPFD_CLOEXEC, 2 * done_fd);
    int status = mailbox < 0 ? errno : 0;
    if (status == 0)
        status = make_pipe(go);
    if (status == 0)
        status = make_pipe(done);
    if (status == 0)
        status = spawn_child(mailbox, go[0], done[1], pid_);
    go_ = go[1];
    done_ = done[0];
    for (int *const theirs : {&mailbox, &go[0], &done[1]})
        close_end(*theirs);
    if (status != 0) {
        pid_ = 0;
        close_end(go_);
        close_end(done_);
    }
    return status;
}

// Take the next steps towards an idle process, without waiting for any.
void BackboneProcess::go_on()
{
    if (state_ == State::idle || state_ == State::opening || state_ == State::late)
        listen();
    if (state_ == State::ending && reap())
        come_back_later();
    if (state_ == State::away && monotonic_us() >= restart_us_)
        start();
}

void BackboneProcess::listen()
{
    switch (wait(0)) {
    case Event::replied:
        if (state_ == State::idle)
            end("it replied without being asked");
        else if (state_ == State::late)
            state_ = State::idle; // and nobody wants to know
        else
            take_description();
        break;
    case Event::hung_up:
        note_end();
        break;
    case Event::timed_out:
        if (state_ != State::idle && monotonic_us() >= deadline_us_)
            note_end();
        break;
    case Event::cancelled:
        break;
    }
}

// It has ended, or is to be: it missed its deadline.
void BackboneProcess::note_end()
{
    if (state_ == State::late)
        return end("it gave no answer within " + milliseconds(2 * budget_us_) +
                   ", twice its budget ([backbone] budget_ms)");
    if (state_ == State::opening && monotonic_us() >= deadline_us_)
        return end("it was not open within " + milliseconds(opening_us_));
    end("it ended");
    if (pid_ == 0)
        reason_ = how_it_ended(exit_status_);
}

void BackboneProcess::end(const std::string &why)
{
    if (pid_ == 0)
        return;
    reason_ = why;
    state_ = State::ending;
    kill(pid_, SIGKILL);
    for (const int64_t until_us = monotonic_us() + reaping_us; monotonic_us() < until_us;) {
        if (reap())
            return come_back_later();
        usleep(1000);
    }
}

bool BackboneProcess::reap()
{
    if (waitpid(pid_, &exit_status_, WNOHANG) == 0)
        return false;
    pid_ = 0;
    close_end(go_);
    close_end(done_);
    return true;
}

void BackboneProcess::come_back_later()
{
    state_ = is_other_ ? State::refused : State::away;
    restart_us_ = monotonic_us() + pause_us_;
    pause_us_ = std::min(2 * pause_us_, longest_pause_us);
}

void BackboneProcess::post(uint64_t number)
{
    number_ = number;
    mailbox_.request().number = number;
    const char byte = 0;
    // Where nobody reads it, wait() says so.
    [[maybe_unused]] const ssize_t written = write(go_, &byte, 1);
}

BackboneProcess::Event BackboneProcess::wait(int64_t deadline_us)
{
    for (;;) {
        const int64_t left_us = std::max<int64_t>(deadline_us - monotonic_us(), 0);
        pollfd files[] = {{done_, POLLIN, 0}, {stop_, POLLIN, 0}};
        poll(files, 2, static_cast<int>((left_us + 999) / 1000));
        char byte;
        if (files[1].revents)
            return Event::cancelled;
        if (files[0].revents)
            return read(done_, &byte, 1) == 1 ? Event::replied : Event::hung_up;
        if (left_us == 0)
            return Event::timed_out;
    }
}

vdna_status BackboneProcess::take_reply(vdna_error &error)
{
    reply_ = mailbox_.reply();
    if (reply_.number != number_) {
        end("its reply was to another picture");
        return refuse(error);
    }
    if (number_ > 0)
        pause_us_ = shortest_pause_us;
    reply_.info.identity.bins = 0;
    reply_.info.identity.range = nullptr; // it means nothing here
    if (reply_.status != VDNA_OK) {
        error = printable(reply_.error);
    }
    return reply_.status;
}

vdna_status BackboneProcess::take_first_description(vdna_error &error)
{
    vdna_status status = take_reply(error);
    if (status == VDNA_OK)
        status = vdna_identity_check(&reply_.info.identity, &error);
    if (status != VDNA_OK)
        return status;
    const uint64_t numbers = numbers_of(reply_.info);
    if (numbers > numbers_bytes_max / sizeof(float))
        return fail(error, VDNA_ERR_FORMAT, "%s: describes itself wrongly",
                    config_.manifest.c_str());
    info_ = reply_.info;
    numbers_.resize(numbers);
    const float *at = numbers_.data();
    for (const vdna_tap &tap : taps_of(info_)) {
        taps_.push_back({at, tap.neurons, tap.samples, 0});
        at += size_t{tap.neurons} * tap.samples;
    }
    state_ = State::idle;
    return VDNA_OK;
}

// Of a process that was started again. Maps and memory fit the first description only.
void BackboneProcess::take_description()
{
    vdna_error error{};
    const vdna_status status = take_reply(error);
    if (state_ != State::opening)
        return;
    if (status != VDNA_OK)
        return end(std::string("it could not be opened again: ") + error.text);
    const vdna_backbone_info &now = reply_.info;
    if (vdna_identity_check(&now.identity, &error) == VDNA_OK &&
        vdna_identity_compare(&info_.identity, &now.identity, &error) == VDNA_OK &&
        info_.last_layer_dim == now.last_layer_dim && info_.embedding_int8 == now.embedding_int8 &&
        info_.embedding_dims == now.embedding_dims) {
        state_ = State::idle;
        return;
    }
    is_other_ = true;
    end(std::string("it came back as another network: ") + error.text);
}

void BackboneProcess::take_numbers(vdna_backbone_frame &out_frame)
{
    // Copied before it is checked, because the process could change it.
    std::memcpy(numbers_.data(), mailbox_.numbers(), number_bytes());
    for (size_t t = 0; t < taps_.size(); t++)
        taps_[t].layout = reply_.layouts[t];

    out_frame = reply_.frame; // its pointers mean nothing here, so each one is replaced
    out_frame.taps = taps_.data();
    out_frame.tap_count = taps_.size();
    out_frame.embedding =
        numbers_.data() + numbers_.size() - info_.last_layer_dim - info_.identity.dim;
    out_frame.dim = info_.identity.dim;
    out_frame.input = nullptr;
    out_frame.last_layer = info_.last_layer_dim > 0
                               ? numbers_.data() + numbers_.size() - info_.last_layer_dim
                               : nullptr;
    out_frame.last_layer_dim = info_.last_layer_dim;
}

// By a black picture, which also has the network of a plug-in run before the first frame comes.
vdna_status BackboneProcess::find_budget(vdna_error &error)
{
    static const uint8_t black[16 * 16] = {};
    const vdna_image image{black, sizeof black, 16, 16, 0, VDNA_PIXEL_GREY};
    const int64_t begin_us = monotonic_us();
    vdna_error why{};
    vdna_backbone_frame frame{};
    const vdna_status status = run(image, why, frame);
    const int64_t trial_us = monotonic_us() - begin_us;
    budget_us_ = config_.budget_ms > 0 ? int64_t{config_.budget_ms} * 1000
                                       : std::max(trials_in_budget * trial_us, shortest_budget_us);
    if (has_replied(status))
        return VDNA_OK;
    return fail(error, status,
                "%s: the network cannot run in a process of its own: %s; where it needs devices or "
                "writes files, set [backbone] process = false",
                config_.manifest.c_str(), why.text);
}

vdna_status BackboneProcess::refuse(vdna_error &error) const
{
    if (state_ == State::late)
        return fail(error, VDNA_ERR_RUNTIME,
                    "the network takes longer than %s for a picture ([backbone] budget_ms), and is "
                    "ended after twice as much",
                    milliseconds(budget_us_).c_str());
    if (state_ == State::refused)
        return fail(error, VDNA_ERR_RUNTIME,
                    "the network is gone for good: %s; start vdna_selectord again",
                    reason_.c_str());
    return fail(error, VDNA_ERR_RUNTIME, "the network is being started again after %s",
                reason_.c_str());
}

} // namespace vdna::selectord
