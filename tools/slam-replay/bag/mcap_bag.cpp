#include "tools/slam-replay/bag/mcap_bag.hpp"

#include <algorithm>

#include "drivers/io/host_ns.hpp"
#include "drivers/mcap/mcap_reader.hpp"

namespace slamd::replay {
namespace {

std::optional<RosEncoding> encoding_of(const std::string& name) {
  if (name == "cdr") return RosEncoding::kCdr;
  if (name == "ros1") return RosEncoding::kRos1;
  return std::nullopt;
}

struct File {
  std::string path;
  MappedFile mapped;
};

class McapCursor : public BagCursor {
 public:
  McapCursor(std::shared_ptr<const File> file, std::string topic, std::string type_text)
      : file_{std::move(file)},
        reader_{file_->mapped.bytes(),
                [name = std::move(topic), encoding = std::move(type_text)](const McapChannel& channel) {
                  return channel.topic == name && channel.encoding == encoding;
                }} {}

  const BagMessage* next() override {
    while (const McapMessage* found = reader_.next()) {
      const auto recorded_ns = static_cast<std::int64_t>(found->log_time_ns);
      if (!is_host_ns(recorded_ns)) {
        ++bad_times_;
        continue;
      }
      message_ = {from_ns<HostTime>(recorded_ns), found->bytes};
      return &message_;
    }
    return nullptr;
  }

  BagDamage damage() const override {
    const McapDamage& found = reader_.damage();
    BagDamage damage{found.chunks + found.orphans + bad_times_ + (found.unreadable_bytes > 0 ? 1 : 0), found.unreadable_bytes, {}};
    if (found.first_reason != nullptr) damage.first = fault_at(file_->path, found.first_at, found.first_reason);
    return damage;
  }

  double progress() const override {
    if (reader_.is_closed()) return 1.0;  // what is behind is the summary
    return static_cast<double>(reader_.position()) / static_cast<double>(std::max<std::size_t>(1, file_->mapped.bytes().size()));
  }

 private:
  std::shared_ptr<const File> file_;
  McapReader reader_;
  BagMessage message_;
  std::uint64_t bad_times_ = 0;
};

class McapBag : public Bag {
 public:
  explicit McapBag(std::shared_ptr<const File> file) : file_{std::move(file)} {
    const McapContents contents = read_contents(file_->mapped.bytes());
    for (const auto& [id, channel] : contents.channels) {
      const auto schema = contents.schemas.find(channel.schema_id);
      const auto count = contents.messages.find(id);
      const std::string type = schema == contents.schemas.end() ? "" : plain_type(schema->second.name);
      add({channel.topic, type, encoding_of(channel.encoding), count == contents.messages.end() ? 0 : count->second}, channel.encoding);
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  const char* form() const override { return "MCAP"; }
  std::unique_ptr<BagCursor> read(std::size_t topic) const override {
    return std::make_unique<McapCursor>(file_, topics_[topic].name, encodings_[topic]);
  }

 private:
  /// Several publishers of one topic have a channel each.
  void add(Topic topic, const std::string& encoding) {
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name != topic.name || topics_[i].type != topic.type || encodings_[i] != encoding) continue;
      topics_[i].messages += topic.messages;
      return;
    }
    topics_.push_back(std::move(topic));
    encodings_.push_back(encoding);
  }

  std::shared_ptr<const File> file_;
  std::vector<Topic> topics_;
  std::vector<std::string> encodings_;  // of each topic, as the file has it
};

}  // namespace

OpenedBag open_mcap(const std::string& path) {
  std::optional<MappedFile> mapped = MappedFile::open(path);
  if (!mapped) return path + ": cannot be read";
  if (!McapReader::is_mcap(mapped->bytes())) return fault_at(path, 0, "is no MCAP file");
  return std::make_unique<McapBag>(std::make_shared<const File>(File{path, *std::move(mapped)}));
}

}  // namespace slamd::replay
