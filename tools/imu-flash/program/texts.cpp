#include "tools/imu-flash/program/texts.hpp"

namespace slamd::flash {

const char* const kHelpFooter = R"(
Without options imu-flash checks FILE, finds the board (running our firmware, or already in its boot loader), sends it to
the boot loader, erases, writes, reads everything back, starts the firmware, and waits for the stream; then it prints the
firmware's version and the measured rate.

An interrupted flash leaves the board in its boot loader, also after unplugging: the page that the chip starts from is
erased first and written last. Run the same command again.

exit codes: 0 all went well; 1 the board or the transfer failed; 2 FILE or the command line is wrong (no board touched)
permission: systemd/60-slamd.rules

examples:
  imu-flash --list
  imu-flash firmware.uf2
  imu-flash --serial E6616407E3554C29 firmware.uf2
  imu-flash --verify firmware.uf2
  imu-flash --info firmware.uf2)";

const char* const kRescueText = R"(How to bring an Arduino Nano RP2040 Connect into its boot loader

The boot loader is in the chip's ROM: no firmware can destroy it. In it the board is USB device 2e8a:0003 and shows a drive
named RPI-RP2. There is no BOOTSEL button; in this order:

1. Our firmware runs (imu-flash --list shows "slamd IMU"): imu-flash does it by itself.

2. Any firmware that has a serial port, also Arduino's: open the port at 1200 baud and close it again:
     stty -F /dev/ttyACM0 1200

3. The firmware hangs or has no USB: press the reset button twice within half a second.
   Our firmware and Arduino's both look for the double tap when they start.

4. Nothing helps: connect the pin marked REC to GND, press reset, take the wire away. The ROM then finds no flash to start
   from and stays in its boot loader.

5. An interrupted flash: the board is in its boot loader already. Plug it in again if it is not listed.

Then:  imu-flash firmware.uf2
Or, without imu-flash:  copy firmware.uf2 to the drive RPI-RP2.

Not listed at all? Many USB cables only charge: try another. No permission? See systemd/60-slamd.rules.
)";

}  // namespace slamd::flash
