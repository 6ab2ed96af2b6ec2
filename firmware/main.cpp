// Starts the board and runs its loop.

#include "firmware/board/interrupts.hpp"
#include "firmware/board/registers.hpp"
#include "firmware/board/rom.hpp"
#include "firmware/board/start_up.hpp"
#include "firmware/board/usb_controller.hpp"
#include "firmware/board/watchdog.hpp"

using namespace slamd;

int main() {
  if (board::second_tap()) board::enter_boot_loader();
  const UniqueId id = board::read_unique_id();
  board::start_clocks();
  board::start_pins();
  UsbControl control{id};
  board::UsbController usb{control};
  usb.start();
  board::start_interrupts();
  board::start_watchdog();
  for (;;) {
    const Micros now = board::now();
    usb.service(now);
    board::feed_watchdog();
    board::set_led(now % 1'000'000 < 50'000);
    if (now > 500'000) board::forget_tap();
    board::wait_for_interrupt();
  }
}
