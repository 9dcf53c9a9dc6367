// The camera's frames as they come: whether they can be used, from how many programs, their stamps.
#pragma once

#include "doctor/hearing.hpp"

namespace vdna::doctor
{

Verdict check_frames(const Settings &settings, const Heard &heard);
Verdict check_sender(const Settings &settings, const Heard &heard);
Verdict check_stamps(const Heard &heard);

} // namespace vdna::doctor
