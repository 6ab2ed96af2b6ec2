#pragma once
// What the boot ROM does for the program: its USB boot loader, and the flash chip's unique id. Nothing here writes
// flash.

#include "firmware/core/usb_descriptors.hpp"

namespace slamd::board {

/// Leaves for the ROM's USB boot loader; the LED shows its transfers.
[[noreturn]] void enter_boot_loader();

/// The flash chip's id (command 4Bh). Flash cannot be read as memory afterwards, which nobody needs: the program is in
/// RAM. All zeros or all ones when the chip does not know the command. Start-up only, about 0.1 ms.
UniqueId read_unique_id();

/// Double tap of the reset button. second_tap() once at start-up: whether the last start was less than half a second
/// before and both were by the button; forget_tap() when the half second has passed.
bool second_tap();
void forget_tap();

}  // namespace slamd::board
