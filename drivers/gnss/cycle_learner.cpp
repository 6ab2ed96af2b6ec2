#include "drivers/gnss/cycle_learner.hpp"

namespace slamd {

void CycleLearner::note(NmeaType type) {
  newest_ = type;
  if (type == NmeaType::kOther) return;
  Habit& habit = habits_[static_cast<std::size_t>(type)];
  ++habit.count;
  habit.position = ++noted_;
}

bool CycleLearner::at_end() const {
  if (last_ == NmeaType::kOther || newest_ != last_) return false;
  const Habit& habit = habits_[static_cast<std::size_t>(last_)];
  return habit.count == habit.usual_count;
}

void CycleLearner::end_cycle() {
  std::uint32_t latest = 0;
  last_ = NmeaType::kOther;
  for (std::size_t type = 0; type < kNmeaTypes; ++type) {
    Habit& habit = habits_[type];
    const bool kept = habit.count > 0 && habit.count == habit.usual_count;
    habit.cycles = first_cycle_ || habit.count == 0 ? 0 : (kept ? habit.cycles + 1 : 1);
    habit.usual_count = habit.count;
    if (habit.cycles >= kFewestCycles && habit.position > latest) {
      latest = habit.position;
      last_ = static_cast<NmeaType>(type);
    }
    habit.count = habit.position = 0;
  }
  noted_ = 0;
  newest_ = NmeaType::kOther;
  first_cycle_ = false;
}

}  // namespace slamd
