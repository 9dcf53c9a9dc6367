// Known numbers of a network for the one test picture: a wrong file, wrong preprocessing and a
// broken kernel give others.
#pragma once

#include <string>

#include <vdna/backbone.h>

#include "manifest.hpp"

namespace vdna::backbone
{

// The section [golden] of a manifest, from what the network gave for the test picture.
std::string golden_text(const vdna_backbone_frame &frame);

// Throws Failure (VDNA_ERR_MISMATCH) if `frame`, which the network gave for the test picture, is
// not what the manifest's golden numbers say. Nothing is compared if it has none.
void require_golden(const Manifest &manifest, const vdna_backbone_frame &frame);

} // namespace vdna::backbone
