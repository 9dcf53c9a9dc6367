// What the processor can do.
#pragma once

namespace vdna
{

// Does it add up products of 8-bit numbers without saturating in between? x86 without VNNI adds
// pairs of them in 16 bits, so that an int8 network gives other numbers there than elsewhere.
bool adds_int8_products_exactly();

} // namespace vdna
