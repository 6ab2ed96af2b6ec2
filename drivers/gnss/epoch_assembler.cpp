#include "drivers/gnss/epoch_assembler.hpp"

#include <algorithm>

namespace slamd {
namespace {

constexpr Duration kDay = std::chrono::hours{24};
constexpr int kPauses = 4;  // silence of a quarter of the period parts two cycles
constexpr Duration kMaxPeriod = std::chrono::seconds{2};
constexpr Duration kLateLimit = std::chrono::seconds{5};  // further back is not late: the receiver's clock was set

/// The epoch's time, of the messages that begin an epoch. ZDA is left out: some receivers stamp it with the next pulse.
std::optional<Duration> epoch_time(const NmeaMessage& message) {
  if (const auto* gga = std::get_if<GgaMessage>(&message)) return gga->time_of_day;
  if (const auto* rmc = std::get_if<RmcMessage>(&message)) return rmc->time_of_day;
  if (const auto* gst = std::get_if<GstMessage>(&message)) return gst->time_of_day;
  return std::nullopt;
}

/// GGA and RMC without a time are what some receivers send as long as they know nothing: they belong to no epoch.
bool carries_time(const NmeaMessage& message) {
  return std::holds_alternative<GgaMessage>(message) || std::holds_alternative<RmcMessage>(message);
}

/// b - a on the 24-hour circle, within +-12 h.
Duration ahead(Duration a, Duration b) {
  Duration difference = b - a;
  if (difference > kDay / 2) difference -= kDay;
  if (difference < -kDay / 2) difference += kDay;
  return difference;
}

}  // namespace

EpochAssembler::Relation EpochAssembler::relation(const NmeaMessage& message, HostTime arrival) const {
  const std::optional<Duration> time = epoch_time(message);
  if (!time && carries_time(message)) return Relation::kUntimed;
  const bool after_pause = arrival - epoch_.last_arrival > period_ / kPauses;
  if (!time) return leading_ || after_pause ? Relation::kLeading : Relation::kSame;
  if (!open_) return Relation::kNew;
  const Duration difference = ahead(epoch_.time_of_day, *time);
  if (difference == Duration::zero()) return Relation::kSame;
  return difference < Duration::zero() && difference > -kLateLimit ? Relation::kLate : Relation::kNew;
}

std::optional<GnssEpoch> EpochAssembler::close_before(const NmeaMessage& message, HostTime arrival) {
  const Relation now = relation(message, arrival);
  return now == Relation::kNew || now == Relation::kLeading ? close() : std::nullopt;
}

std::optional<GnssEpoch> EpochAssembler::close() {
  if (!open_ || given_) return std::nullopt;
  return give();
}

std::optional<GnssEpoch> EpochAssembler::add(const NmeaMessage& message, HostTime arrival) {
  switch (relation(message, arrival)) {
    case Relation::kUntimed:
      return std::nullopt;
    case Relation::kLate:
      ++late_;
      return std::nullopt;
    case Relation::kLeading:
      leading_ = true;
      merge(message);
      return std::nullopt;
    case Relation::kNew:
      open(*epoch_time(message), arrival);
      break;
    case Relation::kSame:
      if (given_ && epoch_.gga && std::holds_alternative<GgaMessage>(message)) ++repeated_;
      break;
  }
  merge(message);
  epoch_.last_arrival = arrival;
  cycle_.note(type_of(message));
  if (!open_ || given_ || !cycle_.at_end()) return std::nullopt;
  return give();
}

/// Messages without a time that came since the last epoch was given belong to the new one.
void EpochAssembler::open(Duration time_of_day, HostTime arrival) {
  cycle_.end_cycle();
  if (open_ && arrival > epoch_.first_arrival) period_ = std::min(arrival - epoch_.first_arrival, kMaxPeriod);
  GnssEpoch next;
  next.time_of_day = time_of_day;
  next.first_arrival = arrival;
  if (given_ || !open_) next.vtg = epoch_.vtg;
  if (++gsa_age_ <= kKeptEpochs) next.gsa = epoch_.gsa;
  epoch_ = next;
  open_ = true;
  given_ = false;
  leading_ = false;
}

void EpochAssembler::merge(const NmeaMessage& message) {
  if (const auto* gga = std::get_if<GgaMessage>(&message)) {
    if (!epoch_.gga || gga->satellites > epoch_.gga->satellites) epoch_.gga = *gga;
  } else if (const auto* rmc = std::get_if<RmcMessage>(&message)) {
    if (!epoch_.rmc || rmc->active) epoch_.rmc = *rmc;
    if (rmc->date) epoch_.date = rmc->date;
  } else if (const auto* gst = std::get_if<GstMessage>(&message)) {
    epoch_.gst = *gst;
  } else if (const auto* gsa = std::get_if<GsaMessage>(&message)) {
    const bool same_cycle = gsa_age_ == 0 && epoch_.gsa;
    const unsigned dimension = same_cycle ? std::max(epoch_.gsa->dimension, gsa->dimension) : gsa->dimension;
    epoch_.gsa = GsaMessage{dimension, gsa->hdop};
    gsa_age_ = 0;
  } else if (const auto* vtg = std::get_if<VtgMessage>(&message)) {
    epoch_.vtg = *vtg;
  } else if (const auto* zda = std::get_if<ZdaMessage>(&message)) {
    if (zda->date && zda->time_of_day == epoch_.time_of_day) epoch_.date = zda->date;
  }
}

GnssEpoch EpochAssembler::give() {
  given_ = true;
  const GnssEpoch given = epoch_;
  epoch_.vtg.reset();
  return given;
}

}  // namespace slamd
