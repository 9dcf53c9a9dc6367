#include "eval/live_run.hpp"

#include "eval/packing.hpp"
#include "program/interrupt.hpp"
#include "record/warmup.hpp"

namespace vdna::eval
{

namespace
{

// The key includes the times of the frames, because they decide the window.
std::string key_of(const Frames &frames, const Binning &binning, const LiveTask &task)
{
    const record::Recording &live = frames.traversals()[task.traversal].recording;
    const std::string how = "live 2 " + task.length + " " + std::to_string(task.frames_min) + " " +
                            std::to_string(task.bins) + " " +
                            sha256_of(task.range.data(), task.range.size() * sizeof(float)) + " " +
                            sha256_of(live.utime.data(), live.utime.size() * sizeof(int64_t));
    return binning.key_of(how, task.traversal, live.frames) + ".live";
}

std::optional<LiveRun> find(const Cache &cache, const std::string &key, uint32_t neurons,
                            uint32_t bins)
{
    const std::optional<std::string> bytes = cache.find(key);
    if (!bytes)
        return {};
    Unpacker unpacker(*bytes);
    LiveRun run;
    uint32_t places[3];
    if (!unpacker.take(places, 3) || !unpacker.take_counts(run.dna, neurons, bins) ||
        !unpacker.at_end())
        return {};
    run.begin = places[0];
    run.frames = places[1];
    run.next = places[2];
    return run;
}

void store(const Cache &cache, const std::string &key, const LiveRun &run)
{
    std::string bytes;
    const uint32_t places[] = {run.begin, run.frames, run.next};
    pack(bytes, places, 3);
    pack_counts(bytes, run.dna);
    cache.store(key, bytes);
}

LiveRun feed(Frames &frames, Binning &binning, const LiveTask &task)
{
    const Traversal &live = frames.traversals()[task.traversal];
    const uint32_t dim = frames.backbone().identity.dim;
    Selector selector(task.candidates, dim, record::warmup_of(task.length, task.frames_min),
                      live.name, {VDNA_TIME_LATE_US_DEFAULT, VDNA_TIME_UNIT_US});
    LiveRun run;
    for (bool chosen = false; !chosen && run.next < live.recording.frames;) {
        program::require_not_interrupted();
        const std::vector<vdna_activations> &taps =
            binning.activations_of(task.traversal, run.next);
        const vdna_select_frame frame = {live.recording.utime[run.next], taps.data(), taps.size(),
                                         &live.recording.embeddings[size_t{dim} * run.next]};
        vdna_select_answer answer;
        require(vdna_select_feed(selector.get(), &frame, &answer), live.files[run.next].string());
        if (answer.restarted)
            run.begin = run.next;
        chosen = answer.newly_ranked != 0;
        // A localised frame is no longer in the window.
        run.next += answer.localised ? 0 : 1;
    }
    run.frames = vdna_select_window_frames(selector.get());
    vdna_hist_view dna;
    vdna_select_live(selector.get(), &dna);
    run.dna = counts_of(dna);
    return run;
}

} // namespace

LiveRun run_live(Frames &frames, Binning &binning, const LiveTask &task)
{
    const std::string key = key_of(frames, binning, task);
    if (std::optional<LiveRun> found = find(frames.cache(), key, binning.neurons(), task.bins))
        return std::move(*found);
    LiveRun run = feed(frames, binning, task);
    if (run.dna.is_worth_keeping())
        store(frames.cache(), key, run);
    return run;
}

} // namespace vdna::eval
