// What a status tells of problems, in sentences for people.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace vdna::telemetry
{

// Without full stops, the newest first; none if nothing is wrong. The reason of the state is not
// among them: headline() has it.
// status: as View::json gives it, null if none has come
std::vector<std::string> problems_of(const nlohmann::ordered_json &status);

} // namespace vdna::telemetry
