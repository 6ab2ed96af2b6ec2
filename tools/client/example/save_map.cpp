// Prints the status, the newest pose of the pose page and saves the map:
//     save_map FILE.ply [SOCKET]
#include <iostream>
#include <slamd/client.hpp>

int main(int argc, char** argv) try {
  if (argc < 2) return 2;
  slamd::client::Connection daemon{argc > 2 ? argv[2] : "/run/slamd/slamd.sock"};
  std::cout << daemon.call("get_status").result["pose"]["status"] << '\n';

  const slamd::client::PosePage page = daemon.pose_page();
  if (const auto pose = page.read()) std::cout << "x " << pose->map_position_m[0] << " m\n";

  const slamd::client::Answer map = daemon.call("get_map", {{"format", "ply"}});
  slamd::client::save_fd(map.fd.get(), argv[1]);
  std::cout << map.result["points"] << " points\n";
} catch (const slamd::client::ClientError& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
