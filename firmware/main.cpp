// Starts the board and runs its loop.

#include "firmware/board/i2c_bus.hpp"
#include "firmware/board/interrupts.hpp"
#include "firmware/board/registers.hpp"
#include "firmware/board/rom.hpp"
#include "firmware/board/start_up.hpp"
#include "firmware/board/usb_controller.hpp"
#include "firmware/board/watchdog.hpp"
#include "firmware/core/device.hpp"

namespace slamd {
namespace {

constexpr Micros kTapWindow = 500'000;

class Program {
 public:
  explicit Program(const BoardFacts& facts) : control_{facts.id}, usb_{control_}, device_{bus_, facts} {}

  [[noreturn]] void run() {
    usb_.start();
    board::start_interrupts();
    board::start_watchdog();
    for (;;) {
      const Micros now = board::now();
      pass(now);
      const Micros took = board::now() - now;
      if (took > longest_pass_) longest_pass_ = took;
      board::wait_for_interrupt();
    }
  }

 private:
  void pass(Micros now) {
    usb_.service(now);
    const bool open = control_.open() && !usb_.suspended();
    if (was_open_ && !open) usb_.blank_pending();
    was_open_ = open;
    device_.set_open(open);
    device_.step(now, board::data_ready());
    device_.set_counters({usb_.resets(), usb_.suspends(), longest_pass_});
    device_.receive(usb_.receive(), now);
    if (usb_.can_send() && device_.has_packet()) usb_.send(device_.next_packet().span());
    start_anew(now);
    board::set_led(led_on(device_.led(usb_.suspended()), now));
    if (device_.alive(now)) board::feed_watchdog();
    if (now > kTapWindow) board::forget_tap();
  }

  void start_anew(Micros now) {
    device_.request_start(control_.take_start_request(), now);
    const StartRequest start = device_.due_start(now);
    if (start == StartRequest::kReset) board::reset_board();
    if (start == StartRequest::kBootLoader) board::enter_boot_loader();
  }

  UsbControl control_;
  board::UsbController usb_;
  board::I2cBus bus_;
  Device device_;
  Micros longest_pass_ = 0;
  bool was_open_ = false;
};

BoardFacts facts() {
  BoardFacts facts;
  facts.id = board::read_unique_id();
  board::release_from_reset(board::resets::kSysInfo);
  facts.chip_revision = static_cast<std::uint8_t>(board::reg(board::sysinfo::kChipId) >> 28U);
  facts.reset_cause = board::reset_cause();
  return facts;
}

}  // namespace
}  // namespace slamd

int main() {
  if (slamd::board::second_tap()) slamd::board::enter_boot_loader();
  const slamd::BoardFacts facts = slamd::facts();
  slamd::board::start_clocks();
  slamd::board::start_pins();
  static slamd::Program program{facts};
  program.run();
}
