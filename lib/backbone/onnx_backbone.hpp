// The table of operations that runs ONNX files through ONNX Runtime.
#pragma once

#include <vdna/backbone.h>

namespace vdna::backbone
{

extern const vdna_backbone_operations onnx_operations;

} // namespace vdna::backbone
