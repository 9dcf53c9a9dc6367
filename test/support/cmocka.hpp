// CMocka for tests in C++: its header needs others before it, and declares no linkage.
#pragma once

#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <ios> // has a member fail(), of which CMocka makes a macro

extern "C" {
#include <cmocka.h>
}

#undef skip // CMocka makes a macro of it too, and readers of frames have a member skip()
