#include "tools/slam-sim/world/world.hpp"

namespace slamd::sim {

World make_world(WorldKind kind, std::uint64_t seed) {
  switch (kind) {
    case WorldKind::kCorridor:
      return make_corridor(seed);
    case WorldKind::kParking:
      return make_parking(seed);
    case WorldKind::kOpenField:
      return make_open_field(seed);
    case WorldKind::kUrban:
      return make_urban(seed);
    case WorldKind::kHills:
      return make_hills(seed);
    case WorldKind::kGrounds:
      return make_grounds(seed);
    case WorldKind::kHouse:
      return make_house(seed);
    case WorldKind::kCampus:
      break;
  }
  return make_campus(seed);
}

}  // namespace slamd::sim
