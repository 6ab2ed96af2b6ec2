#pragma once
// Who is at the other end of a connection, as the kernel says, and whether that gives the right to control. No list of
// users and no password: groups of the system decide.

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "estimator/types/result.hpp"

namespace slamd {

/// The client's identity at the moment of its connect().
struct Peer {
  uid_t user = 0;
  std::vector<gid_t> groups;  // its effective group and the supplementary ones
};

/// Of a connected Unix socket; nullopt when the kernel does not tell.
std::optional<Peer> peer_of(int socket);

/// The group's number; an error when the system has no such group. May read files: not on a real-time thread.
Result<gid_t> group_named(const std::string& name);

/// Members of the group may control, and so may root and the user that the daemon runs as. An unknown peer may not.
bool may_control(const std::optional<Peer>& peer, gid_t group, uid_t daemon_user);

}  // namespace slamd
