// New experiences of a map: what they share with those that are in it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <vdna/cpp/experience.hpp>

#include "record/maker.hpp"

namespace vdna::record
{

// Throws UsageError if this cannot be the name of an experience. where: for the complaint.
void require_name(const std::string &name, const std::string &where);

// The file that a draft becomes.
std::filesystem::path file_of(const std::filesystem::path &map, const Draft &draft);

// An experience of a map, of which the header alone was read.
struct Member {
    std::filesystem::path path;
    vdna_experience header; // of vdna_experience_read_header()
};

// The experiences of a map that will remain once drafts are written. All compare, so the first one
// speaks for them: no other is opened.
struct Remaining {
    std::vector<Member> members;
    std::optional<Experience> first; // none = there are no members
};

// Throws Error, also for a member without a readable header.
Remaining remaining_in(const std::filesystem::path &map, const std::vector<Draft> &drafts);

// What was asked for, else that of the map, else the default. asked: "" or 0 = nothing.
std::string backbone_of(const std::string &asked, const Remaining &remaining);
uint32_t bins_of(uint32_t asked, const Remaining &remaining);

// Use the ranges of a file, "" = none, or those of the map, if any.
void find_ranges(const std::string &file, const Remaining &remaining, const Backbone &backbone,
                 Maker &maker);

// Keep of embeddings what the map's experiences keep, or the one whose ranges are used if that has
// a projection of the same embeddings.
void find_projection(const std::string &file, const Remaining &remaining, const Backbone &backbone,
                     Maker &maker);

// New experiences must compare with the existing ones; check this before the work. Throws Error.
void require_comparable(const Remaining &remaining, const std::vector<Draft> &drafts,
                        const Maker &maker);

// Positions compare only within a frame, so one map has one. A member whose header states none, as
// before version 2 of the format, is passed over. Throws Error.
void require_one_frame(const Remaining &remaining, const std::vector<Draft> &drafts);

// Renew the map's own file. The map is complete without it, so what prevents it is only said.
void let_map_know_itself(const std::string &map);

} // namespace vdna::record
