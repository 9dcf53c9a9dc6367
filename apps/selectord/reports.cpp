#include "selectord/reports.hpp"

#include <cmath>
#include <limits>

#include <vdna/version.h>

namespace vdna
{

namespace
{

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

// The generated structs have no const members, though publishing changes nothing.
char *borrow(const char *text)
{
    return const_cast<char *>(text);
}

} // namespace

RankingReport::RankingReport(const Map &map, const vdna_backbone_info &backbone)
    : experiences_(map.experiences()), names_(experiences_.size()), distances_(experiences_.size()),
      tied_(experiences_.size()), recalls_(experiences_.size(), not_known)
{
    message_.validity = VDNA_MSG_RANKING_T_VALID;
    message_.backbone = borrow(backbone.name);
    message_.comparable = borrow(experiences_.front().comparable);
    message_.count = static_cast<int32_t>(experiences_.size());
    message_.experience = names_.data();
    message_.distance_bins = distances_.data();
    message_.tied = tied_.data();
    message_.predicted_recall = recalls_.data();
}

const vdna_msg_ranking_t &RankingReport::fill(const vdna_select &select)
{
    message_.utime = select.last_utime;
    message_.window_begin_utime = select.first_utime;
    message_.window_frames = static_cast<int32_t>(select.live.frames);
    message_.margin_bins = select.margin_bins;
    for (size_t i = 0; i < experiences_.size(); i++) {
        const vdna_rank_entry &entry = select.ranking[i];
        names_[i] = borrow(experiences_[entry.candidate].name);
        distances_[i] = entry.distance_bins;
        tied_[i] = static_cast<int8_t>(entry.tied);
    }
    return message_;
}

vdna_msg_localisation_t no_position(int64_t utime, int32_t validity)
{
    vdna_msg_localisation_t message{};
    message.utime = utime;
    message.validity = validity;
    message.experience = borrow("");
    message.frame = -1;
    message.distance = not_known;
    message.predicted_recall = not_known;
    return message;
}

vdna_msg_localisation_t position_in(const vdna_experience &chosen, const vdna_knn_match &match,
                                    int64_t utime)
{
    vdna_msg_localisation_t message = no_position(utime, VDNA_MSG_LOCALISATION_T_VALID);
    message.experience = borrow(chosen.name);
    message.frame = static_cast<int32_t>(match.index);
    message.frame_utime = chosen.frame_utime[match.index];
    if (chosen.frame_place) {
        message.has_place = 1;
        message.place = chosen.frame_place[match.index];
    }
    if (chosen.frame_position) {
        message.has_position = 1;
        for (size_t axis = 0; axis < 3; axis++)
            message.position[axis] = chosen.frame_position[3 * size_t{match.index} + axis];
    }
    message.distance = std::sqrt(match.distance_sq);
    return message;
}

vdna_msg_status_t status_of(const Health &health, int64_t utime)
{
    const bool selected = health.select.state == VDNA_SELECT_SELECTED;
    vdna_msg_status_t message{};
    message.utime = utime;
    message.state = selected ? VDNA_MSG_STATUS_T_SELECTED : VDNA_MSG_STATUS_T_WARMUP;
    message.progress = vdna_select_progress(&health.select);
    message.experience = borrow(selected ? health.experiences[health.select.chosen].name : "");
    message.experiences = static_cast<int32_t>(health.experiences.size());
    message.backbone = borrow(health.backbone.name);
    message.version = borrow(vdna_version());
    message.received = static_cast<int64_t>(health.transport.received);
    message.skipped = static_cast<int64_t>(health.transport.skipped);
    message.rejected = static_cast<int64_t>(health.transport.rejected);
    message.refused = static_cast<int64_t>(health.refused);
    message.processed = static_cast<int64_t>(health.select.accepted);
    message.restarts = static_cast<int64_t>(health.select.restarts);
    message.frame_age_us = health.cost.age_us;
    message.decode_us = health.cost.decode_us;
    message.resize_us = health.cost.resize_us;
    message.inference_us = health.cost.inference_us;
    message.resident_bytes = health.resident_bytes;
    message.message = borrow(health.message);
    return message;
}

} // namespace vdna
