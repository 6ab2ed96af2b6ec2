#include "firmware/core/outbox.hpp"

namespace slamd {

void Outbox::push(const ImuFrame& frame) {
  if (!open_ || !frames_.push(frame)) ++dropped_;
  if (frames_.size() > most_frames_) most_frames_ = frames_.size();
}

void Outbox::set_open(bool open) {
  if (open_ && !open) {
    dropped_ += static_cast<std::uint32_t>(frames_.size());
    frames_.clear();
  }
  open_ = open;
}

WirePacket Outbox::next() {
  if (!replies_.empty()) {
    const WirePacket reply = replies_.front();
    replies_.pop();
    return reply;
  }
  ImuFrame frame = frames_.front();
  frames_.pop();
  frame.dropped = static_cast<std::uint16_t>(dropped_);
  if (!first_sent_) frame.status |= static_cast<std::uint8_t>(ImuStatus::kFirstFrame);
  first_sent_ = true;
  const auto bytes = encode(frame);
  WirePacket packet;
  for (std::size_t i = 0; i < bytes.size(); ++i) packet.bytes[i] = bytes[i];
  packet.size = static_cast<std::uint8_t>(bytes.size());
  return packet;
}

}  // namespace slamd
