#include "tools/plot/lzf.hpp"

namespace slamd::plot {
namespace {

class Input {
 public:
  explicit Input(std::string_view bytes) : bytes_{bytes} {}
  bool has(std::size_t count) const { return bytes_.size() - at_ >= count; }
  std::size_t next() { return static_cast<unsigned char>(bytes_[at_++]); }
  std::string_view take(std::size_t count) {
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<std::string> lzf_decompress(std::string_view packed, std::size_t size) {
  Input in(packed);
  std::string out;
  while (in.has(1)) {
    const std::size_t control = in.next();
    if (control < 32) {
      if (!in.has(control + 1) || out.size() + control + 1 > size) return std::nullopt;
      out += in.take(control + 1);
      continue;
    }
    std::size_t length = (control >> 5) + 2;
    if (!in.has(length == 9 ? 2 : 1)) return std::nullopt;
    if (length == 9) length += in.next();
    const std::size_t back = ((control & 31) << 8) + in.next() + 1;
    if (back > out.size() || out.size() + length > size) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - back]);
  }
  if (out.size() != size) return std::nullopt;
  return out;
}

}  // namespace slamd::plot
