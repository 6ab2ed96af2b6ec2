#pragma once
// Asks the IMU board who it is, how it fared and whether its sensor is sound, over the stream's own port. It changes
// nothing on the board but for the pause of the self-test.

#include <optional>
#include <string>

#include "drivers/io/byte_source.hpp"
#include "firmware/protocol/command.hpp"
#include "firmware/protocol/reply.hpp"

namespace slamd::monitor {

/// Sends the command once the source is open and waits for the packet that carries its tag; nothing when none comes
/// within the time, or the board refuses the command.
std::optional<OpenedPacket> ask(ByteSource& board, CommandCode code, Duration patience);

/// Lines for people.
std::string identity_text(const Identity& identity);
std::string statistics_text(const Statistics& statistics);
std::string self_test_text(const SelfTestReport& report);

}  // namespace slamd::monitor
