#include "tools/slam-replay/bag/ros1_bag.hpp"

#include <algorithm>
#include <utility>

#include "drivers/io/byte_reader.hpp"
#include "tools/slam-replay/bag/mapped_file.hpp"
#include "tools/slam-replay/bag/ros1_reader.hpp"

namespace slamd::replay {
namespace {

struct File {
  std::string path;
  MappedFile mapped;
};

using Connections = std::map<std::uint32_t, Ros1Connection>;
using Counts = std::map<std::uint32_t, std::uint64_t>;  // messages by connection

class Ros1Cursor : public BagCursor {
 public:
  Ros1Cursor(std::shared_ptr<const File> file, const Topic& topic)
      : file_{std::move(file)},
        reader_{file_->mapped.bytes(), file_->path,
                [name = topic.name, type = topic.type](const Ros1Connection& c) { return c.topic == name && c.type == type; }} {}

  const BagMessage* next() override { return reader_.next(); }
  BagDamage damage() const override { return reader_.damage(); }
  double progress() const override {
    return static_cast<double>(reader_.position()) / static_cast<double>(file_->mapped.bytes().size());
  }

 private:
  std::shared_ptr<const File> file_;
  Ros1Reader reader_;
};

/// What the index at the bag's end says; false when there is none or it is not whole.
bool read_index(std::span<const std::uint8_t> file, Connections& connections, Counts& counts) {
  const bool is_whole = visit_ros1_index(file, [&](const Ros1Record& record) {
    if (record.op == Ros1Op::kConnection) {
      connections[record.connection] = {std::string{record.topic}, std::string{ros1_field(record.body, "type").value_or("")}};
    }
    if (record.op != Ros1Op::kChunkInfo) return;
    for (ByteReader from{record.body}; from.remaining() >= 8;) {
      const std::uint32_t connection = from.u32_le();
      counts[connection] += from.u32_le();
    }
  });
  return is_whole && !connections.empty();
}

void read_all(const File& file, Connections& connections, Counts& counts) {
  connections.clear();
  counts.clear();
  Ros1Reader reader{file.mapped.bytes(), file.path, [](const Ros1Connection&) { return true; }};
  while (reader.next() != nullptr) ++counts[reader.connection()];
  connections = reader.connections();
}

class Ros1Bag : public Bag {
 public:
  explicit Ros1Bag(std::shared_ptr<const File> file) : file_{std::move(file)} {
    Connections connections;
    Counts counts;
    if (!read_index(file_->mapped.bytes(), connections, counts)) read_all(*file_, connections, counts);
    for (const auto& [id, connection] : connections) add(connection, counts[id]);
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  const char* form() const override { return "ROS 1 bag"; }
  std::unique_ptr<BagCursor> read(std::size_t topic) const override {
    return std::make_unique<Ros1Cursor>(file_, topics_[topic]);
  }

 private:
  /// Several publishers of one topic have a connection each.
  void add(const Ros1Connection& connection, std::uint64_t messages) {
    const auto same = std::find_if(topics_.begin(), topics_.end(),
                                   [&](const Topic& t) { return t.name == connection.topic && t.type == connection.type; });
    if (same != topics_.end()) {
      same->messages += messages;
      return;
    }
    topics_.push_back({connection.topic, connection.type, RosEncoding::kRos1, messages});
  }

  std::shared_ptr<const File> file_;
  std::vector<Topic> topics_;
};

}  // namespace

OpenedBag open_ros1_bag(const std::string& path) {
  std::optional<MappedFile> mapped = MappedFile::open(path);
  if (!mapped) return path + ": cannot be read";
  const auto bytes = mapped->bytes();
  if (bytes.size() < kRos1Magic.size() || !std::equal(kRos1Magic.begin(), kRos1Magic.end(), bytes.begin())) {
    return fault_at(path, 0, "is no ROS 1 bag of format 2.0 (`rosbag migrate` makes one of older ones)");
  }
  return std::make_unique<Ros1Bag>(std::make_shared<const File>(File{path, *std::move(mapped)}));
}

}  // namespace slamd::replay
