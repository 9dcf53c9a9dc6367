#include "record/addition.hpp"

#include <algorithm>
#include <cstring>

#include "program/exit_code.hpp"
#include "program/notice.hpp"
#include "record/experiences.hpp"
#include "record/map_trust.hpp"

namespace vdna::record
{

namespace fs = std::filesystem;

namespace
{

void require_compares(const Experience &there, const vdna_experience &probe)
{
    vdna_error error{};
    if (vdna_experience_compare(there.get(), &probe, &error) != VDNA_OK)
        throw Error(there.path().string() +
                    ": does not compare with what is to be built: " + error.text +
                    "; use the map's backbone, bins and ranges, or rebuild all of its "
                    "experiences with --force");
}

} // namespace

void require_name(const std::string &name, const std::string &where)
{
    if (vdna_name_check(name.c_str(), nullptr) != VDNA_OK || name[0] == '.')
        throw program::UsageError(where + ": cannot be the experience '" + name +
                                  "', expected 1 to " + std::to_string(VDNA_NAME_SIZE - 1) +
                                  " " VDNA_NAME_ALPHABET " and no '.' first; set --name");
}

fs::path file_of(const fs::path &map, const Draft &draft)
{
    return map / (draft.name + VDNA_MAP_EXTENSION);
}

Remaining remaining_in(const fs::path &map, const std::vector<Draft> &drafts)
{
    Remaining remaining;
    for (const fs::path &file : experience_files(map)) {
        const auto replaced = [&](const Draft &draft) { return file_of(map, draft) == file; };
        if (std::none_of(drafts.begin(), drafts.end(), replaced))
            remaining.members.push_back({file, header_of(file)});
    }
    if (!remaining.members.empty())
        remaining.first.emplace(remaining.members.front().path);
    return remaining;
}

std::string backbone_of(const std::string &asked, const Remaining &remaining)
{
    if (!asked.empty())
        return asked;
    return remaining.first ? (*remaining.first)->identity.backbone : VDNA_BACKBONE_DEFAULT;
}

uint32_t bins_of(uint32_t asked, const Remaining &remaining)
{
    if (asked != 0)
        return asked;
    return remaining.first ? (*remaining.first)->identity.bins : VDNA_HIST_BINS_DEFAULT;
}

void find_ranges(const std::string &file, const Remaining &remaining, const Backbone &backbone,
                 Maker &maker)
{
    if (!file.empty()) {
        Ranges ranges = read_ranges(file);
        require_backbone(ranges, backbone.info());
        maker.use(std::move(ranges));
    } else if (remaining.first) {
        maker.use(ranges_of(*remaining.first));
    }
}

void find_projection(const std::string &file, const Remaining &remaining, const Backbone &backbone,
                     Maker &maker)
{
    if (remaining.first)
        return maker.keep_as(*remaining.first->get());
    if (fs::path(file).extension() != VDNA_MAP_EXTENSION)
        return;
    const Experience there(file);
    if (there->identity.projection &&
        vdna_identity_compare(&there->identity, &backbone.info().identity, nullptr) == VDNA_OK)
        maker.keep_as(*there.get());
}

void require_comparable(const Remaining &remaining, const std::vector<Draft> &drafts,
                        const Maker &maker)
{
    if (remaining.members.empty())
        return;
    const vdna_experience probe = maker.blank();
    char comparable[VDNA_SHA256_SIZE] = "";
    require(vdna_identity_hash(&probe.identity, comparable), "the experiences to be built");
    for (const Member &there : remaining.members) {
        if (std::strcmp(there.header.comparable, comparable) != 0)
            require_compares(Experience(there.path), probe);
        for (const Draft &draft : drafts)
            if (draft.name == there.header.name)
                throw Error(there.path.string() + ": is already called " + draft.name +
                            "; choose another --name");
    }
}

void require_one_frame(const Remaining &remaining, const std::vector<Draft> &drafts)
{
    std::string frame, where;
    const auto require_same = [&](const std::string &other, const std::string &path) {
        if (frame.empty()) {
            frame = other;
            where = path;
        }
        if (!other.empty() && other != frame)
            throw Error(path + ": not labelled alike: its positions are in frame " + other +
                        ", those of " + where + " in " + frame +
                        "; give both lat,lon or both x,y, name their frame with --frame, or leave "
                        "the positions out");
    };
    for (const Member &there : remaining.members)
        require_same(there.header.position_frame, there.path.string());
    for (const Draft &draft : drafts)
        require_same(draft.recording.position_frame, draft.source);
}

void let_map_know_itself(const std::string &map)
{
    try {
        renew_map_trust(map);
    } catch (const Error &error) {
        program::tell_once(std::string(error.what()) + "; the map is complete, but will not " +
                           "predict recall before `vdna calibrate --trust " + map + "`");
    }
}

} // namespace vdna::record
