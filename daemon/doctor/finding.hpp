#pragma once
// One thing that was looked at and what came of it, in words for the operator. Not how it was found out.

#include <string>
#include <vector>

namespace slamd::doctor {

enum class Verdict {
  kRight,
  kWrong,
  kUnknown,  // the machine does not tell, or not to this user
};

struct Finding {
  Verdict verdict = Verdict::kUnknown;
  std::string subject;   // one or two words: "kernel", "clock source"
  std::string found;     // what is the case, a sentence without a full stop
  std::string remedy{};  // how to mend it; empty when right
};

using Findings = std::vector<Finding>;

}  // namespace slamd::doctor
