#pragma once
// Topics that carry a device's own bytes, as its reads: VelodyneScan, nmea_msgs/Sentence. The drivers' parsers come behind it
// (tools/slam-replay/drive/wire_streams.hpp).

#include <memory>

#include "tools/slam-replay/bag/topic.hpp"
#include "tools/slam-replay/drive/read_source.hpp"

namespace slamd::replay {

/// Each packet of each scan, at its own stamp.
std::unique_ptr<ReadSource> velodyne_reads(TopicSource topic);
/// Each sentence with the line's end that messages leave out.
std::unique_ptr<ReadSource> sentence_reads(TopicSource topic);

}  // namespace slamd::replay
