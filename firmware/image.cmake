# Target firmware: slamd-imu.elf, .bin and .uf2 for the board, by its own compiler, so by its own rules. Without that
# compiler (tools/install-packages) the rest of the project builds all the same.
find_program(SLAMD_ARM_CXX arm-none-eabi-g++)
if(NOT SLAMD_ARM_CXX)
  message(STATUS "no arm-none-eabi-g++: target firmware is left out")
  return()
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter)

set(flags -mcpu=cortex-m0plus -mthumb -Os -ffreestanding -ffunction-sections -fdata-sections
  -ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${CMAKE_CURRENT_BINARY_DIR}=. -I${PROJECT_SOURCE_DIR})
set(cxx_flags -g -std=c++20 -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-asynchronous-unwind-tables
  --param=min-pagesize=0 -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-align -Werror)
set(link_flags -nostartfiles -nostdlib -Wl,--gc-sections -Wl,--no-warn-rwx-segments -Wl,--build-id=none
  -Wl,--fatal-warnings)

# No path of this machine gets into the objects: the image depends on the sources and the compiler only.
file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/main.cpp ${CMAKE_CURRENT_LIST_DIR}/core/*.cpp
  ${CMAKE_CURRENT_LIST_DIR}/board/*.cpp ${CMAKE_CURRENT_LIST_DIR}/boot/*.S)
list(SORT sources)
set(objects)
foreach(source ${sources})
  file(RELATIVE_PATH name ${CMAKE_CURRENT_LIST_DIR} ${source})
  string(REPLACE "/" "-" object ${name}.o)
  if(source MATCHES "\\.cpp$")
    set(language_flags ${cxx_flags})
  else()
    set(language_flags)
  endif()
  add_custom_command(OUTPUT ${object}
    COMMAND ${SLAMD_ARM_CXX} ${flags} ${language_flags} -MMD -MT ${object} -MF ${object}.d -c ${source} -o ${object}
    DEPENDS ${source} DEPFILE ${object}.d COMMENT "Building firmware object ${name}" VERBATIM)
  list(APPEND objects ${object})
endforeach()

add_custom_command(OUTPUT linked.elf
  COMMAND ${SLAMD_ARM_CXX} ${flags} ${link_flags} -T ${CMAKE_CURRENT_LIST_DIR}/boot/firmware.ld ${objects}
          -lc_nano -lgcc -o linked.elf
  DEPENDS ${objects} ${CMAKE_CURRENT_LIST_DIR}/boot/firmware.ld VERBATIM)
add_custom_command(OUTPUT slamd-imu.elf slamd-imu.bin slamd-imu.uf2
  COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/boot/make_image.py linked.elf
          slamd-imu.elf slamd-imu.bin slamd-imu.uf2
  DEPENDS linked.elf ${CMAKE_CURRENT_LIST_DIR}/boot/make_image.py COMMENT "Finishing slamd-imu.elf .bin .uf2" VERBATIM)
add_custom_target(firmware ALL DEPENDS slamd-imu.elf slamd-imu.bin slamd-imu.uf2)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/slamd-imu.uf2 DESTINATION share/slamd COMPONENT firmware)
