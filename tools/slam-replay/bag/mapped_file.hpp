#pragma once
// A file as bytes in memory, without reading it in: mapped; the file is never changed. The file must not be made shorter while it is open.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace slamd::replay {

class MappedFile {
 public:
  /// Nothing when it is no file that can be read. An empty file has no bytes.
  static std::optional<MappedFile> open(const std::string& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  std::span<const std::uint8_t> bytes() const { return bytes_; }
  /// Changes stay in this process's memory.
  std::span<std::uint8_t> bytes() { return bytes_; }

 private:
  explicit MappedFile(std::span<std::uint8_t> bytes) : bytes_{bytes} {}
  std::span<std::uint8_t> bytes_;
};

}  // namespace slamd::replay
