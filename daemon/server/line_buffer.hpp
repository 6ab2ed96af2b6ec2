#pragma once
// Bytes from a socket, cut into lines of bounded length. Looks at each byte once.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace slamd {

class LineBuffer {
 public:
  explicit LineBuffer(std::size_t max_line) : max_line_{max_line} {}

  /// Room for the next bytes of the socket; then say how many came.
  std::span<char> prepare() {
    constexpr std::size_t kChunk = 4096;
    bytes_.erase(0, begin_);
    scanned_ -= begin_;
    begin_ = 0;
    filled_ = bytes_.size();
    bytes_.resize(filled_ + kChunk);
    return {bytes_.data() + filled_, kChunk};
  }
  void commit(std::size_t count) { bytes_.resize(filled_ + count); }

  /// The next whole line without its line feed.
  std::optional<std::string> next() {
    const std::size_t end = bytes_.find('\n', scanned_);
    if (end == std::string::npos) {
      scanned_ = bytes_.size();
      return std::nullopt;
    }
    std::string line = bytes_.substr(begin_, end - begin_);
    begin_ = scanned_ = end + 1;
    return line;
  }

  /// After next() gave nothing: what waits is longer than a line may be.
  bool too_long() const { return bytes_.size() - begin_ > max_line_; }

  void clear() {
    bytes_.clear();
    begin_ = scanned_ = 0;
  }

 private:
  std::size_t max_line_;
  std::string bytes_;
  std::size_t begin_ = 0;    // of the first line not yet given
  std::size_t scanned_ = 0;  // no line feed in [begin_, scanned_)
  std::size_t filled_ = 0;   // while bytes are being received
};

}  // namespace slamd
