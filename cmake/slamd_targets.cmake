# One target a folder: slamd_library(estimator/math LINKS slamd::types) makes target slamd_estimator_math with the
# alias slamd::math from every .cpp of the calling folder. Compiler settings of the whole project live here.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

set(SLAMD_ARCH "x86-64-v3" CACHE STRING "-march of everything; x86-64-v3 = AVX2 and FMA (any PC since 2013)")
set(SLAMD_SANITIZE "" CACHE STRING "e.g. address,undefined or thread")
option(SLAMD_FUZZ "build the libFuzzer targets (clang only)" OFF)

add_library(slamd_options INTERFACE)
target_include_directories(slamd_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(slamd_options INTERFACE
  # GCC 12 sees overlaps in std::string that are not there (PR 105651): no -Wrestrict.
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-align -Woverloaded-virtual -Werror
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<CONFIG:Release>:-O3> -fno-math-errno)
if(SLAMD_ARCH)
  target_compile_options(slamd_options INTERFACE -march=${SLAMD_ARCH})
endif()
if(SLAMD_SANITIZE)
  target_compile_options(slamd_options INTERFACE -fsanitize=${SLAMD_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(slamd_options INTERFACE -fsanitize=${SLAMD_SANITIZE})
  # Instrumented code hides from GCC what is initialised; the release build has the warning.
  target_compile_options(slamd_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  if(SLAMD_SANITIZE STREQUAL realtime)  # newer clang sees a deprecated function that stable_sort of libstdc++ 12 itself calls
    target_compile_options(slamd_options INTERFACE -Wno-deprecated-declarations)
  endif()
  if(SLAMD_SANITIZE MATCHES thread)  # Boost.Asio has stand-alone fences, which GCC's thread sanitizer cannot follow
    target_compile_options(slamd_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)
    target_compile_definitions(slamd_options INTERFACE BOOST_ASIO_DISABLE_FENCES)
  endif()
endif()
if(SLAMD_FUZZ)
  target_compile_options(slamd_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# slamd_library(<name> [LINKS target...]): every .cpp of the folder; header-only folders give an interface target.
function(slamd_library name)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(sources)
    add_library(slamd_${name} STATIC ${sources})
    target_link_libraries(slamd_${name} PUBLIC slamd_options ${ARG_LINKS})
  else()
    add_library(slamd_${name} INTERFACE)
    target_link_libraries(slamd_${name} INTERFACE slamd_options ${ARG_LINKS})
  endif()
  add_library(slamd::${name} ALIAS slamd_${name})
endfunction()

# slamd_test(<name> LINKS target...): one test binary from <name>.cpp, run by ctest.
function(slamd_test name)
  cmake_parse_arguments(ARG "" "" "LINKS;LABELS" ${ARGN})
  add_executable(${name} ${name}.cpp)
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE SLAMD_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data"
                             SLAMD_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SLAMD_BINARY_DIR="${PROJECT_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES TIMEOUT 900 LABELS "${ARG_LABELS}")
endfunction()

# slamd_fuzzer(<name> LINKS target...): libFuzzer binary from <name>.cpp with its corpus folder corpus/<name>.
function(slamd_fuzzer name)
  if(NOT SLAMD_FUZZ)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  add_executable(${name} ${name}.cpp)
  target_link_libraries(${name} PRIVATE ${ARG_LINKS})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
endfunction()
