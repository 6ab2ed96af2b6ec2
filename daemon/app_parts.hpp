#pragma once
// What App makes of its configuration and of an earlier run before any thread starts. Values and parts alone, no wiring.

#include <memory>

#include "daemon/config/config.hpp"
#include "daemon/threads/front_end.hpp"
#include "daemon/threads/streams.hpp"
#include "estimator/types/stored_map.hpp"

namespace slamd {

/// What an earlier run had learnt of the sensors, as the configuration of this one: so it is in a recording as well, and replays.
Config with_what_was_learnt(Config config, const Result<StoredMap>& left);

/// A motion whose time is of another clock says nothing: the host has been started anew since, or its UTC was set.
Result<StoredMap> by_this_clock(Result<StoredMap> left);

/// Of the configuration's mode. streams must outlive it.
std::unique_ptr<FrontEnd> make_front_end(const Config& config, Streams& streams);

}  // namespace slamd
