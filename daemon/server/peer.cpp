#include "daemon/server/peer.hpp"

#include <grp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

namespace slamd {
namespace {

constexpr std::size_t kMostGroups = 65'536;  // the kernel's own limit

}  // namespace

std::optional<Peer> peer_of(int socket) {
  ucred credentials{};
  socklen_t bytes = sizeof credentials;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &credentials, &bytes) != 0) return std::nullopt;
  Peer peer{credentials.uid, {}};
  bytes = 0;
  ::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, nullptr, &bytes);  // fails, and says how much room it wants
  peer.groups.resize(std::min(bytes / sizeof(gid_t), kMostGroups));
  const bool some = !peer.groups.empty();
  if (some && ::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, peer.groups.data(), &bytes) != 0) return std::nullopt;
  peer.groups.push_back(credentials.gid);
  return peer;
}

Result<gid_t> group_named(const std::string& name) {
  std::array<char, 65'536> room;
  group entry{};
  group* found = nullptr;
  if (::getgrnam_r(name.c_str(), &entry, room.data(), room.size(), &found) != 0 || found == nullptr) {
    return Error{"server.control_group: the system has no such group"};
  }
  return entry.gr_gid;
}

bool may_control(const std::optional<Peer>& peer, gid_t group, uid_t daemon_user) {
  if (!peer) return false;
  if (peer->user == 0 || peer->user == daemon_user) return true;
  return std::find(peer->groups.begin(), peer->groups.end(), group) != peer->groups.end();
}

}  // namespace slamd
