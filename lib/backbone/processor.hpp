// What the processor can do.
#pragma once

namespace vdna::backbone
{

// What it lacks to add up products of 8-bit numbers in 32 bits; nullptr if nothing. Without that
// ONNX Runtime adds pairs of them in 16 bits, where they saturate (x86) or wrap (ARM), so that an
// int8 network may give other numbers there than elsewhere.
const char *lacks_for_int8_products();

} // namespace vdna::backbone
