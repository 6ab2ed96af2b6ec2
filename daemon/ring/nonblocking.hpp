#pragma once
// Marks what real-time threads run, and pauses the check of it: for the build under clang's real-time sanitizer (preset rtsan), nothing
// to any other. Not a promise of the compiler's: what a marked function calls is checked while it runs.

#if defined(__clang__)
#if __has_feature(realtime_sanitizer)
#include <sanitizer/rtsan_interface.h>
#define SLAMD_RTSAN 1
#endif
#endif

/// Behind the parameters of a function that after warm-up neither allocates, locks nor waits.
#if defined(__clang__) && __has_cpp_attribute(clang::nonblocking)
#define SLAMD_NONBLOCKING [[clang::nonblocking]]
#else
#define SLAMD_NONBLOCKING
#endif

namespace slamd {

/// As long as it lives, the thread may call what the sanitizer takes for blocking; a comment says why it does not block there.
class NonblockingByKnowledge {
 public:
#ifdef SLAMD_RTSAN
  NonblockingByKnowledge() { __rtsan_disable(); }
  ~NonblockingByKnowledge() { __rtsan_enable(); }
#else
  NonblockingByKnowledge() {}
  ~NonblockingByKnowledge() {}
#endif
  NonblockingByKnowledge(const NonblockingByKnowledge&) = delete;
  NonblockingByKnowledge& operator=(const NonblockingByKnowledge&) = delete;
};

}  // namespace slamd
