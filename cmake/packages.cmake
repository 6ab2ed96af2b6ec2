# What is installed, and into which Debian package: slamd, libslamd0, slamd-dev, slamd-firmware, python3-slamd. Units, manual pages and
# the firmware's image install themselves where they are made (systemd/, docs/man/, firmware/).

find_package(nlohmann_json 3.11 REQUIRED)
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL daemon client dev python)
if(TARGET firmware)
  list(APPEND CPACK_COMPONENTS_ALL firmware)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "slamd developers <slamd@users.noreply.github.com>")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# slamd_package(<component> <package> <section> <summary> <rest of the description> [<field> <value>]...)
function(slamd_package component package section summary description)
  string(TOUPPER ${component} upper)
  set(fields ${ARGN})
  list(PREPEND fields NAME ${package} SECTION ${section})
  while(fields)
    list(POP_FRONT fields field value)
    set(CPACK_DEBIAN_${upper}_PACKAGE_${field} "${value}" PARENT_SCOPE)
  endwhile()
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
  set(folder ${PROJECT_BINARY_DIR}/packages/doc/${package})
  file(MAKE_DIRECTORY ${folder})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/debian/changelog.in ${folder}/changelog.Debian @ONLY)
  execute_process(COMMAND gzip -9 -n -f -k ${folder}/changelog.Debian)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian/copyright ${folder}/changelog.Debian.gz
          DESTINATION share/doc/${package} COMPONENT ${component})
endfunction()

set(control_files conffiles postinst prerm postrm)
slamd_package(daemon slamd science "real-time LiDAR-inertial-GNSS SLAM daemon"
  "slamd reads a Velodyne VLP-16, an IMU and a GPS receiver and serves a pose\nof 200 Hz and a growing 3D map to local programs. Any sensor may be absent;\nthe covariance says what that is worth. With slamctl, tools for recorded\ndrives and the flash tool of the IMU board."
  SHLIBDEPS ON DEPENDS "systemd (>= 252)" RECOMMENDS "udev" SUGGESTS "slamd-firmware")
list(TRANSFORM control_files PREPEND ${PROJECT_SOURCE_DIR}/cmake/debian/)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA ${control_files})
slamd_package(client libslamd0 libs "client library of slamd"
  "The shared library of programs that ask the SLAM daemon slamd for pose and\nmap: client of its socket and pose page, with a C interface that stays."
  SHLIBDEPS ON)
set(CPACK_DEBIAN_CLIENT_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/libslamd0/triggers)
slamd_package(dev slamd-dev libdevel "client library of slamd, for programs to be made"
  "Headers for C and C++, a CMake package, pkg-config and examples of the client\nof the daemon's socket and pose page."
  DEPENDS "libslamd0 (= ${PROJECT_VERSION}-1), nlohmann-json3-dev (>= 3.11)")
slamd_package(python python3-slamd python "Python client of slamd"
  "Blocking and asyncio clients of the daemon's socket, and its pose page."
  ARCHITECTURE all DEPENDS "python3 (>= 3.9)")
slamd_package(firmware slamd-firmware science "firmware of slamd's IMU board"
  "Image for the Arduino Nano RP2040 Connect, to be flashed with imu-flash."
  ARCHITECTURE all RECOMMENDS "slamd")

install(TARGETS slamd slamctl imu-flash imu-monitor slam-replay slam-eval DESTINATION bin COMPONENT daemon)
install(FILES config/slamd.yaml DESTINATION /etc/slamd COMPONENT daemon)
install(FILES tools/slamctl/slamctl.bash DESTINATION share/bash-completion/completions RENAME slamctl COMPONENT daemon)
execute_process(COMMAND gzip -9 -n -c ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${PROJECT_BINARY_DIR}/packages/changelog.gz)
install(FILES ${PROJECT_BINARY_DIR}/packages/changelog.gz DESTINATION share/doc/slamd COMPONENT daemon)

# The client library with its headers.
target_compile_features(slamd_shared INTERFACE cxx_std_20)
target_include_directories(slamd_shared INTERFACE $<INSTALL_INTERFACE:include>)
target_link_libraries(slamd_shared INTERFACE nlohmann_json::nlohmann_json)
set(library_folder lib/${CMAKE_LIBRARY_ARCHITECTURE})
install(TARGETS slamd_shared EXPORT slamdTargets LIBRARY DESTINATION ${library_folder} COMPONENT client
        NAMELINK_COMPONENT dev)
install(EXPORT slamdTargets NAMESPACE slamd:: DESTINATION ${library_folder}/cmake/slamd COMPONENT dev)
install(DIRECTORY tools/client/include/slamd DESTINATION include COMPONENT dev FILES_MATCHING PATTERN "client.h*")
install(DIRECTORY tools/client/example/ DESTINATION share/doc/slamd-dev/examples COMPONENT dev)
configure_file(cmake/slamd.pc.in packages/slamd.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/packages/slamd.pc DESTINATION ${library_folder}/pkgconfig COMPONENT dev)
include(CMakePackageConfigHelpers)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/packages/slamdConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES cmake/slamdConfig.cmake ${PROJECT_BINARY_DIR}/packages/slamdConfigVersion.cmake
        DESTINATION ${library_folder}/cmake/slamd COMPONENT dev)
install(DIRECTORY tools/client/python/slamd DESTINATION lib/python3/dist-packages COMPONENT python
        FILES_MATCHING PATTERN "*.py" PATTERN py.typed PATTERN __pycache__ EXCLUDE)

include(CPack)
