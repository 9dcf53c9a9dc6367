#include "serve/live_state.hpp"

namespace vdna::serve
{

using Lock = std::unique_lock<std::mutex>;

void LiveState::put(const std::string &kind, const std::string &data)
{
    const Lock lock(mutex_);
    Event &event = newest_[kind];
    if (event.number > 0 && event.data == data)
        return;
    event = {++changes_, data};
    changed_.notify_all();
}

void LiveState::add_point(const std::string &data)
{
    const Lock lock(mutex_);
    if (points_.size() == points_max)
        points_.pop_front();
    points_.push_back({++changes_, data});
    changed_.notify_all();
}

LiveState::News LiveState::news_after(uint64_t seen, std::chrono::milliseconds patience)
{
    Lock lock(mutex_);
    changed_.wait_for(lock, patience, [&] { return changes_ > seen || closed_; });
    std::string text;
    const auto add = [&](const std::string &kind, const Event &event) {
        if (event.number > seen)
            text += "event: " + kind + "\ndata: " + event.data + "\n\n";
    };
    for (const Event &point : points_)
        add("point", point);
    for (const auto &[kind, event] : newest_)
        add(kind, event);
    return {changes_, text};
}

void LiveState::pause(std::chrono::milliseconds time)
{
    Lock lock(mutex_);
    closing_.wait_for(lock, time, [&] { return closed_; });
}

void LiveState::set_picture(Picture picture)
{
    const Lock lock(mutex_);
    picture_ = std::move(picture);
}

LiveState::Picture LiveState::picture() const
{
    const Lock lock(mutex_);
    return picture_;
}

void LiveState::close()
{
    const Lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
    closing_.notify_all();
}

bool LiveState::is_closed() const
{
    const Lock lock(mutex_);
    return closed_;
}

} // namespace vdna::serve
