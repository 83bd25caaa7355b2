#pragma once
// Counts what a thread allocates and releases while it is `armed`. A test program that includes this gets
// allocation_guard.cpp's operator new and delete instead of the library's.

namespace allocation_guard {

/// This thread's allocations and releases are counted.
extern thread_local bool armed;
/// Of all armed threads since the last reset by hand.
extern long allocations;

}  // namespace allocation_guard

using allocation_guard::allocations;
using allocation_guard::armed;
