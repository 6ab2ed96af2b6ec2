#include "daemon/threads/change_log.hpp"

namespace slamd {
namespace {

bool same(const Condition& a, const Condition& b) {
  return a.level == b.level && a.state == b.state;
}

}  // namespace

void ChangeLog::look(const std::string& name, const Condition& now, HostTime at) {
  Subject& subject = subjects_[name];
  if (subject.told && !same(now, subject.seen)) ++subject.changes;
  subject.seen = now;
  const bool quiet_long_enough = !subject.told || at - subject.told_at >= repeat_period_;
  const bool news = !subject.told || !same(now, subject.last_line) || subject.changes > 1;
  if (!news || !quiet_long_enough) return;

  std::string line = name + " " + now.state + now.details;
  if (subject.changes > 1) line += " changes=" + std::to_string(subject.changes);
  sink_(now.level, line);
  subject = {true, now, now, at, 0};
}

}  // namespace slamd
