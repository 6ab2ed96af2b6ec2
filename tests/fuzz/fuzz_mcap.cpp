// Any bytes as an MCAP file. It ends, its messages lie within what a file of that size can hold, two readings are the same, and what comes out comes
// out of a file that is written anew from it.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "drivers/mcap/mcap_reader.hpp"
#include "drivers/mcap/mcap_writer.hpp"

namespace {

using namespace slamd;

using Heard = std::vector<std::tuple<std::string, std::uint64_t, Bytes>>;  // topic, time, bytes

constexpr std::size_t kMostBytes = 64U << 20U;  // of messages that are compared

void require(bool holds) {
  if (!holds) std::abort();
}

Heard hear(std::span<const std::uint8_t> file) {
  Heard heard;
  std::size_t bytes = 0;
  McapReader reader{file};
  while (const McapMessage* message = reader.next()) {
    bytes += message->bytes.size();
    if (bytes > kMostBytes) return heard;
    const McapChannel& channel = reader.channels().at(message->channel_id);
    heard.emplace_back(channel.topic, message->log_time_ns, Bytes{message->bytes.begin(), message->bytes.end()});
  }
  require(reader.position() <= file.size());
  require(reader.damage().unreadable_bytes <= file.size());
  require((reader.damage().first_reason == nullptr) == (reader.damage().chunks + reader.damage().orphans + reader.damage().unreadable_bytes == 0));
  return heard;
}

Bytes written_anew(const Heard& heard, const std::string& path) {
  std::filesystem::remove(path);
  {
    McapWriter writer = McapWriter::open(path, "", "fuzz").value();
    const std::uint16_t schema = writer.add_schema("a", "b", "c");
    std::map<std::string, std::uint16_t> channels;
    for (const auto& [topic, time_ns, bytes] : heard) {
      if (!channels.contains(topic) && channels.size() < 1000) channels[topic] = writer.add_channel(schema, topic, "x");
    }
    for (const auto& [topic, time_ns, bytes] : heard) {
      if (channels.contains(topic)) writer.write(channels.at(topic), time_ns, bytes);
    }
    require(static_cast<bool>(writer.finish()));
  }
  std::ifstream in{path, std::ios::binary};
  const std::vector<char> text{std::istreambuf_iterator<char>{in}, {}};
  return {text.begin(), text.end()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const std::string path = std::filesystem::temp_directory_path() / ("fuzz_mcap." + std::to_string(::getpid()));
  const std::span file{bytes, size};
  static_cast<void>(find_attachment(file, "slamd.yaml"));
  static_cast<void>(find_metadata(file, "slamd"));
  if (!McapReader::is_mcap(file)) return 0;
  const McapContents contents = read_contents(file);
  require(contents.channels.size() <= 65'536);
  const Heard heard = hear(file);
  require(heard == hear(file));
  if (heard.empty() || heard.size() > 1000) return 0;
  require(hear(written_anew(heard, path)) == heard);
  std::filesystem::remove(path);
  return 0;
}
