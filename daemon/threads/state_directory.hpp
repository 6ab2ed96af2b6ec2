#pragma once
// The folder that the service manager has made for what outlives the process. It makes none itself.

#include <cstdlib>
#include <string>
#include <string_view>

namespace slamd {

/// The first of STATE_DIRECTORY (systemd.exec: absolute, several apart by colons); empty when there is none.
inline std::string state_directory() {
  const char* given = std::getenv("STATE_DIRECTORY");
  const std::string_view folders{given != nullptr ? given : ""};
  return std::string{folders.substr(0, folders.find(':'))};
}

}  // namespace slamd
