// The daemon's messages as text for people, and as JSON for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>
#include <vdna_msg_localisation_t.h>
#include <vdna_msg_ranking_t.h>
#include <vdna_msg_status_t.h>

namespace vdna::telemetry
{

// A table, one line per experience.
std::string text_of(const vdna_msg_ranking_t &message);
// One line, without its end.
std::string text_of(const vdna_msg_localisation_t &message);
// One to three lines.
std::string text_of(const vdna_msg_status_t &message);

// The members by their names in lcmtypes/; what is not valid is null.
nlohmann::ordered_json json_of(const vdna_msg_ranking_t &message);
nlohmann::ordered_json json_of(const vdna_msg_localisation_t &message);
nlohmann::ordered_json json_of(const vdna_msg_status_t &message);

} // namespace vdna::telemetry
