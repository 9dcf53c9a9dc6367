#include "watch/screen.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "program/print.hpp"
#include "telemetry/headline.hpp"
#include "telemetry/members.hpp"
#include "telemetry/message_text.hpp"
#include "telemetry/problems.hpp"
#include "watch/display_text.hpp"

namespace vdna::watch
{

namespace
{

using Json = nlohmann::ordered_json;
using program::fixed;
using telemetry::number_of;
using telemetry::text_of;

constexpr int text_cells_max = 120; // longer lines are hard to read
constexpr int bar_cells_max = 60;

// --- parts of lines

// A line that grows to the right.
class Growing
{
  public:
    Growing &add(const std::string &text, Tone tone = Tone::plain)
    {
        line_.push_back({printable(text), tone});
        return *this;
    }
    // Go on at this cell, or where the line ends if that is further right.
    Growing &at(int cell)
    {
        const int missing = cell - width_of(line_);
        return missing > 0 ? add(std::string(static_cast<size_t>(missing), ' ')) : *this;
    }
    // So that it ends before this cell.
    Growing &add_right(const std::string &text, int end, Tone tone = Tone::plain)
    {
        return at(end - width_of(printable(text))).add(text, tone);
    }
    operator Line() const { return line_; }

  private:
    Line line_;
};

std::string repeat(const char *mark, int times)
{
    std::string text;
    for (int i = 0; i < times; i++)
        text += mark;
    return text;
}

// share: 0..1; NaN is none
std::string bar(double share, int cells)
{
    if (std::isnan(share))
        return "";
    const auto halves = static_cast<int>(std::lround(2 * cells * std::clamp(share, 0.0, 1.0)));
    return repeat("█", halves / 2) + repeat("▌", halves % 2);
}

// The same with all of its cells marked.
std::string gauge(double share, int cells)
{
    const std::string filled = bar(share, cells);
    return filled + repeat("░", cells - width_of(filled));
}

std::string percent(double share)
{
    return fixed(100 * share, 0);
}

std::string age(double seconds)
{
    if (seconds < 10)
        return fixed(seconds, 1) + " s";
    if (seconds < 120)
        return fixed(seconds, 0) + " s";
    return seconds < 7200 ? fixed(seconds / 60, 0) + " min" : fixed(seconds / 3600, 0) + " h";
}

// The line cut to the window.
Line fitted(const Line &line, int columns)
{
    if (width_of(line) <= columns)
        return line;
    Line kept;
    for (const Span &span : line) {
        const int room = columns - 1 - width_of(kept);
        kept.push_back({first(span.text, room), span.tone});
        if (width_of(span.text) > room)
            break;
    }
    kept.back().text += "…";
    return kept;
}

Line in_one_tone(Line line, Tone tone)
{
    for (Span &span : line)
        span.tone = tone;
    return line;
}

// --- the candidates, a table

// What the ranking is by, in ranking_t and for people.
std::string rule_of(const Json &ranking)
{
    return text_of(ranking, "ranked_by") == "emd" ? "distance" : "predicted recall";
}

// "94 % (88–97)", or without the interval.
std::string recall_of(const Json &entry, bool with_interval)
{
    const double recall = number_of(entry, "predicted_recall");
    const double low = number_of(entry, "predicted_low"), high = number_of(entry, "predicted_high");
    if (std::isnan(recall))
        return "–";
    return percent(recall) + " %" +
           (with_interval && low <= high ? " (" + percent(low) + "–" + percent(high) + ")" : "");
}

class Candidates
{
  public:
    // Borrows both. chosen: its name; "" = the first
    Candidates(const Json &entries, const std::string &chosen, int columns)
        : entries_(entries), chosen_(index_of(chosen)), is_wide_(columns >= 64)
    {
        int names = 4;
        for (const Json &entry : entries_) {
            farthest_ = std::max(farthest_, number_of(entry, "distance_bins"));
            names = std::max(names, width_of(printable(text_of(entry, "experience"))));
            distance_cells_ = std::max(distance_cells_, width_of(distance_of(entry)));
            is_predicted_ = is_predicted_ || !std::isnan(number_of(entry, "predicted_recall"));
        }
        name_cells_ = std::min(names, columns / 3);
        const int bar_begin = mark_cells + name_cells_ + gap;
        const int right = gap + distance_cells_ + (is_predicted_ ? gap + recall_cells() : 0);
        bar_cells_ = std::clamp(columns - bar_begin - right, 0, bar_cells_max);
        distance_end_ = bar_begin + bar_cells_ + gap + distance_cells_;
        recall_end_ = distance_end_ + gap + recall_cells();
    }

    int count() const { return static_cast<int>(entries_.size()); }

    Line heading(int shown) const
    {
        Growing line;
        line.add("Candidates", Tone::faint);
        if (count() == 0)
            return line.add("  none ranked yet");
        if (shown < count())
            line.add("  " + std::to_string(shown) + " of " + std::to_string(count()));
        if (is_wide_)
            line.add("  shorter is more alike", Tone::faint);
        line.add_right("distance", distance_end_, Tone::faint);
        if (is_predicted_)
            line.add_right(is_wide_ ? "predicted recall" : "recall", recall_end_, Tone::faint);
        return line;
    }

    // The best ones, with the chosen one among them.
    std::vector<Line> rows(int shown) const
    {
        std::vector<Line> rows;
        for (int i = 0; i < shown; i++)
            rows.push_back(row(i + 1 == shown && chosen_ > i ? chosen_ : i));
        return rows;
    }

  private:
    static constexpr int mark_cells = 2, gap = 2;
    int recall_cells() const { return is_wide_ ? 16 : 6; }

    int index_of(const std::string &name) const
    {
        const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Json &entry) {
            return text_of(entry, "experience") == name;
        });
        return found == entries_.end() ? 0 : static_cast<int>(found - entries_.begin());
    }

    std::string distance_of(const Json &entry) const
    {
        const bool is_bound = telemetry::is_true(entry, "bound");
        const std::string bins =
            (is_bound ? "≥" : "") + fixed(number_of(entry, "distance_bins"), 2);
        const bool tied = telemetry::is_true(entry, "tied");
        if (is_wide_)
            return bins + (tied ? " tied" : " bins");
        return (tied ? "=" : "") + bins;
    }

    Line row(int index) const
    {
        const Json &entry = entries_[static_cast<size_t>(index)];
        const bool is_chosen = index == chosen_;
        const Tone tone = is_chosen ? Tone::strong : Tone::plain;
        const double share = farthest_ > 0 ? number_of(entry, "distance_bins") / farthest_ : 0;
        Growing line;
        line.add(is_chosen ? "> " : "  ", tone)
            .add(cut(printable(text_of(entry, "experience")), name_cells_), tone)
            .at(mark_cells + name_cells_ + gap)
            .add(bar(share, bar_cells_), is_chosen ? Tone::good : Tone::plain)
            .add_right(distance_of(entry), distance_end_, tone);
        if (is_predicted_)
            line.add_right(recall_of(entry, is_wide_), recall_end_, tone);
        return line;
    }

    const Json &entries_;
    const int chosen_;
    const bool is_wide_;
    bool is_predicted_ = false;
    double farthest_ = 0;
    int distance_cells_ = width_of(std::string("distance"));
    int name_cells_, bar_cells_, distance_end_, recall_end_;
};

// --- the rows of a screen, and which of them stay

// What matters most comes first.
enum class Rank {
    state,
    place,
    camera,
    problem,
    margin,
    more_headline,
    latency,
    heading,
    position,
    more_problems,
    note,
    memory,
    footer,
    blank
};

struct Row {
    Rank rank;
    Line line;
    bool continues; // the text of the row before it
};

class Screen
{
  public:
    Screen(const telemetry::Newest &newest, const std::string &url, int64_t now_us, Size size)
        : status_(newest.status()), ranking_(newest.ranking()), answer_(newest.localisation()),
          rejected_(newest.rejected()), silent_s_(newest.silent_s(now_us)),
          camera_hz_(newest.camera_hz()), size_(size),
          headline_(telemetry::headline(status_, ranking_, silent_s_, url)),
          candidates_(ranking_.contains("ranking") ? ranking_["ranking"] : nothing(),
                      text_of(status_, "experience"), size.columns)
    {
        add_state(url);
        if (status_.is_object()) {
            add_choice();
            add_place();
            add_health();
        }
        add_problems();
        add_footer();
    }

    std::vector<Line> lines()
    {
        const int least = std::min(candidates_.count(), std::max(3, size_.rows / 5));
        while (height() + least > size_.rows && !rows_.empty())
            drop(least_important());
        const int shown = std::clamp(size_.rows - height(), 0, candidates_.count());
        const std::vector<Line> candidates = candidates_.rows(shown);
        std::vector<Line> lines;
        for (size_t i = 0; i < rows_.size(); i++) {
            const Row &row = rows_[i];
            if (row.rank == Rank::footer) // at the bottom
                lines.resize(static_cast<size_t>(size_.rows - 1));
            const Line line = row.rank == Rank::heading ? candidates_.heading(shown) : row.line;
            lines.push_back(is_of_the_past(row) ? in_one_tone(line, Tone::faint) : line);
            if (static_cast<std::ptrdiff_t>(i) == candidates_after_)
                for (const Line &candidate : candidates)
                    lines.push_back(is_silent() ? in_one_tone(candidate, Tone::faint) : candidate);
        }
        for (Line &line : lines)
            line = fitted(line, size_.columns);
        return lines;
    }

  private:
    static const Json &nothing()
    {
        static const Json none = Json::array();
        return none;
    }

    int height() const { return static_cast<int>(rows_.size()); }
    bool is_silent() const { return silent_s_ > telemetry::silence_max_s; }
    // What a daemon said that has fallen silent.
    bool is_of_the_past(const Row &row) const
    {
        return is_silent() && row.rank != Rank::state && row.rank != Rank::more_headline;
    }
    bool warms_up() const
    {
        return text_of(status_, "experience").empty() && text_of(status_, "state") != "STANDBY";
    }
    int label_cells() const { return size_.columns < 60 ? 10 : 12; }
    // Of text beside a label.
    int text_cells() const { return std::min(size_.columns, text_cells_max) - label_cells(); }
    int gauge_cells() const { return std::clamp(size_.columns / 4, 6, 20); }

    std::vector<Row>::iterator least_important()
    {
        const auto worse = [](const Row &a, const Row &b) { return a.rank <= b.rank; };
        return std::max_element(rows_.begin(), rows_.end(), worse); // the last of equals
    }

    void drop(std::vector<Row>::iterator row)
    {
        if (row->continues)
            std::prev(row)->line.push_back({" …", Tone::plain});
        if (row - rows_.begin() <= candidates_after_)
            candidates_after_--;
        rows_.erase(row);
    }

    void add(Rank rank, const Line &line, bool continues = false)
    {
        rows_.push_back({rank, line, continues});
    }
    void add_blank() { add(Rank::blank, {}); }
    Growing labelled(const std::string &label) const
    {
        return Growing().add(label, Tone::faint).at(label_cells());
    }

    Tone tone() const
    {
        const std::string tone = headline_.tone;
        return tone == "good"    ? Tone::good
               : tone == "wait"  ? Tone::wait
               : tone == "doubt" ? Tone::doubt
                                 : Tone::bad;
    }

    void add_state(const std::string &url)
    {
        const std::string state = !status_.is_object() ? "WAITING"
                                  : is_silent()        ? "SILENT"
                                                       : text_of(status_, "state");
        const std::string host = text_of(status_, "host");
        const std::string where = (host.empty() ? "" : host + " · ") + url;
        const int room = size_.columns - width_of(printable(state)) - 2;
        add(Rank::state, Growing()
                             .add(state, tone())
                             .add_right(cut(printable(where), room), size_.columns, Tone::faint));
        const std::vector<std::string> sentence =
            wrapped(printable(headline_.text), std::min(size_.columns, text_cells_max));
        for (size_t i = 0; i < sentence.size(); i++)
            add(i < 2 ? Rank::state : Rank::more_headline, Growing().add(sentence[i]), i > 0);
        add_blank();
    }

    // The ranking; its rows come once their number is known.
    void add_choice()
    {
        add(Rank::heading, {});
        candidates_after_ = height() - 1;
        if (candidates_.count() > 0)
            add_margin();
        add_blank();
    }

    void add_margin()
    {
        std::string text = fixed(number_of(ranking_, "margin_bins"), 2) + " bins, after " +
                           fixed(number_of(ranking_, "window_frames"), 0) + " frames, by " +
                           rule_of(ranking_);
        if (const std::string previous = text_of(ranking_, "previous"); !previous.empty())
            text += ", in place of " + previous;
        text += warms_up() ? "; of the last warmup" : "";
        add_wrapped({Rank::margin, Rank::note}, "Margin", text, 2);
        if (const std::string why = text_of(ranking_, "no_prediction"); !why.empty())
            add_wrapped({Rank::note, Rank::note}, "", "Recall is not predicted: " + why, 2);
    }

    struct Ranks {
        Rank first, others; // of the lines of a text
    };
    // A text beside a label, in as many lines as it takes and may have.
    void add_wrapped(Ranks ranks, const std::string &label, const std::string &text,
                     size_t lines_max)
    {
        std::vector<std::string> lines = wrapped(printable(text), text_cells());
        if (lines.size() > lines_max) {
            lines.resize(lines_max);
            lines.back() = cut(lines.back() + " …", text_cells());
        }
        for (size_t i = 0; i < lines.size(); i++)
            add(i == 0 ? ranks.first : ranks.others, labelled(i == 0 ? label : "").add(lines[i]),
                i > 0);
    }

    void add_place()
    {
        if (warms_up()) {
            const double progress = number_of(status_, "progress");
            add(Rank::place, labelled("Warmup")
                                 .add(gauge(progress, gauge_cells()), Tone::wait)
                                 .add(" " + percent(progress) + " %"));
        } else if (answer_.is_object()) {
            add_answer();
        }
    }

    void add_answer()
    {
        const std::string experience = text_of(answer_, "experience");
        Growing line = labelled("Place");
        if (experience.empty()) {
            const std::string reason = text_of(answer_, "reason");
            add(Rank::place, line.add("none, " + text_of(answer_, "validity") +
                                      (reason.empty() ? "" : ": " + reason)));
            return;
        }
        if (const double confidence = number_of(answer_, "confidence"); !std::isnan(confidence))
            line.add(gauge(confidence, gauge_cells()), tone())
                .add(" " + fixed(confidence, 2) + (size_.columns < 60 ? " " : " confident, "));
        const bool is_moving = telemetry::is_true(answer_, "moving");
        const bool is_parked = telemetry::text_of(answer_, "basis") == "PARKED";
        add(Rank::place,
            line.add("frame " + fixed(number_of(answer_, "frame"), 0) + " of " + experience +
                     (is_parked   ? ", parked"
                      : is_moving ? ""
                                  : ", standing")));
        if (const std::string position = telemetry::position_of(answer_); !position.empty())
            add(Rank::position, labelled("Position").add(position));
    }

    void add_health()
    {
        const auto number = [this](const char *name) { return number_of(status_, name); };
        const auto mb = [&](const char *name) { return fixed(number(name) / 1e6, 0) + " MB"; };
        add_blank();
        add(Rank::camera, labelled("Camera").add(camera()));
        if (number("processed") > 0 && status_.contains("total")) {
            const auto ms = [this](const char *name) {
                return fixed(number_of(status_["total"], name) / 1000, 1) + " ms";
            };
            add(Rank::latency,
                labelled("Latency").add("p50 " + ms("p50_us") + ", p99 " + ms("p99_us")));
        }
        add(Rank::memory,
            labelled("Memory").add(mb("resident_bytes") + ", at most " + mb("resident_bytes_max")));
    }

    // Frames that were answered with what they or the last one showed.
    double used() const
    {
        double sum = 0;
        for (const char *name : {"processed", "parked", "carried"})
            sum += status_.contains(name) ? number_of(status_, name) : 0;
        return sum;
    }

    std::string camera() const
    {
        const double received = number_of(status_, "received");
        const double frame_us = number_of(status_, "frame_age_us");
        if (received == 0)
            return "no frame yet";
        return (std::isnan(camera_hz_) ? "" : fixed(camera_hz_, 1) + " frames/s, ") +
               (frame_us < 0 ? "" : "newest " + age(frame_us / 1e6 + silent_s_) + " ago, ") +
               fixed(used(), 0) + " of " + fixed(received, 0) + " used";
    }

    void add_problems()
    {
        std::vector<std::string> problems = telemetry::problems_of(status_);
        if (!rejected_.empty())
            problems.push_back("A message was left out: " + rejected_);
        if (problems.empty())
            return;
        add_blank();
        const size_t lines_max = static_cast<size_t>(std::max(2, size_.rows / 4));
        const size_t before = rows_.size();
        for (size_t i = 0; i < problems.size() && rows_.size() - before < lines_max; i++)
            add_wrapped({i == 0 ? Rank::problem : Rank::more_problems, Rank::more_problems},
                        i == 0 ? "Problems" : "", problems[i], lines_max);
    }

    void add_footer()
    {
        std::string facts;
        if (status_.is_object())
            facts = "vdna_selectord " + text_of(status_, "version") + " · " +
                    text_of(status_, "backbone") + " · map of " +
                    fixed(number_of(status_, "experiences"), 0);
        add(Rank::footer,
            Growing().add("q ends", Tone::faint).add_right(facts, size_.columns, Tone::faint));
    }

    const Json &status_, &ranking_, &answer_;
    const std::string &rejected_;
    const double silent_s_, camera_hz_;
    const Size size_;
    const telemetry::Headline headline_;
    const Candidates candidates_;
    std::vector<Row> rows_;
    std::ptrdiff_t candidates_after_ = -1; // index of the row before them
};

} // namespace

int width_of(const Line &line)
{
    int width = 0;
    for (const Span &span : line)
        width += width_of(span.text);
    return width;
}

std::vector<Line> screen(const telemetry::Newest &newest, const std::string &url, int64_t now_us,
                         Size size)
{
    return Screen(newest, url, now_us, size).lines();
}

} // namespace vdna::watch
