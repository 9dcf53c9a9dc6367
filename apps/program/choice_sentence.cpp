#include "program/choice_sentence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace vdna::program
{

namespace
{

[[gnu::format(printf, 2, 3)]] void append(Sentence &sentence, const char *pattern, ...)
{
    const size_t end = std::strlen(sentence.data());
    va_list arguments;
    va_start(arguments, pattern);
    std::vsnprintf(sentence.data() + end, sentence.size() - end, pattern, arguments);
    va_end(arguments);
}

void append_recall(Sentence &sentence, const Choice &choice)
{
    append(sentence, "expects %.0f %% (%.0f to %.0f) of frames right",
           100 * choice.predicted_recall, 100 * choice.predicted_low, 100 * choice.predicted_high);
}

void append_frames(Sentence &sentence, const Choice &choice)
{
    append(sentence, " after %d ", choice.frames);
    if (choice.frames < choice.warmup_frames)
        append(sentence, "of %d ", choice.warmup_frames);
    append(sentence, std::max(choice.frames, choice.warmup_frames) == 1 ? "frame" : "frames");
}

void append_expectation(Sentence &sentence, const Choice &choice)
{
    if (choice.no_prediction[0] != '\0') {
        append(sentence, "; no prediction: %s", choice.no_prediction);
        return;
    }
    if (std::isnan(choice.predicted_recall))
        return;
    append(sentence, ": ");
    append_recall(sentence, choice);
    if (choice.skill <= 0)
        append(sentence, "; in this map distances say nothing about that (skill %.2f)",
               choice.skill);
}

void append_misfit(Sentence &sentence, const Choice &choice)
{
    if (std::strcmp(choice.verdict, "blank") == 0) {
        append(
            sentence,
            "the frames hardly differ and look like none of %d experiences: see whether the lens "
            "is covered, or the camera broken",
            choice.count);
        return;
    }
    append(sentence, "none of %d experiences ", choice.count);
    if (std::strcmp(choice.verdict, "poor") == 0) {
        append(sentence, "is good enough: the best, %s, ", choice.experience);
        append_recall(sentence, choice);
    } else {
        append(sentence, "looks like this run");
        if (!std::isnan(choice.unlike))
            append(sentence,
                   ": the nearest is %.2f times as far from it as the loneliest of them is from "
                   "the others",
                   std::exp(choice.unlike));
    }
    append(sentence, "; record one now with `vdna build`");
}

} // namespace

Sentence sentence_of(const Choice &choice)
{
    Sentence sentence{};
    if (choice.verdict[0] != '\0') {
        append_misfit(sentence, choice);
        return sentence;
    }
    append(sentence, "selected %s of %d", choice.experience, choice.count);
    if (choice.previous[0] != '\0')
        append(sentence, " in place of %s, which the newest frames suit less", choice.previous);
    else
        append_frames(sentence, choice);
    append_expectation(sentence, choice);
    return sentence;
}

Sentence sentence_of(const MarginShare &share)
{
    Sentence sentence{};
    if (share.margin_bins == 0) {
        append(sentence, "%s is as near as %s", share.winner, share.against);
        return sentence;
    }
    append(sentence, "%s is %.2f bins %s than %s: %d of %d neurons make %.0f %% of it",
           share.winner, std::fabs(share.margin_bins), share.margin_bins > 0 ? "nearer" : "farther",
           share.against, share.named, share.neurons, 100 * share.named_bins / share.margin_bins);
    return sentence;
}

} // namespace vdna::program
