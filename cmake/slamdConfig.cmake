# find_package(slamd) gives the target slamd::client, the client library of the daemon's socket and pose page (C, C++).
include(CMakeFindDependencyMacro)
find_dependency(nlohmann_json 3.11)
include(${CMAKE_CURRENT_LIST_DIR}/slamdTargets.cmake)
