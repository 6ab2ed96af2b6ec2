#include "firmware/board/rom.hpp"

#include "firmware/board/pins.hpp"
#include "firmware/board/registers.hpp"

namespace slamd::board {
namespace {

// Data sheet 2.8.3: table of functions and the function that searches it, both as 16-bit pointers.
constexpr Address kFunctionTable = 0x14, kSearch = 0x18;
constexpr Address kTapMark = 0x2003FC00;  // RAM that start.S does not clear: firmware.ld
constexpr std::uint32_t kTapped = 0x74617021;

constexpr std::uint32_t code(char first, char second) {
  return static_cast<std::uint32_t>(second) << 8U | static_cast<std::uint32_t>(first);
}

Address half_word(Address at) {
  return *reinterpret_cast<const volatile std::uint16_t*>(at);
}

template <class Function>
Function* rom_function(std::uint32_t name) {
  using Search = void*(Address table, std::uint32_t name);
  const auto search = reinterpret_cast<Search*>(half_word(kSearch));
  return reinterpret_cast<Function*>(search(half_word(kFunctionTable), name));
}

void select_flash(bool selected) {
  const std::uint32_t rest = reg(io_qspi::kChipSelectControl) & ~io_qspi::kOutputMask;
  reg(io_qspi::kChipSelectControl) = rest | (selected ? io_qspi::kOutputLow : io_qspi::kOutputHigh);
}

std::uint8_t exchange(std::uint8_t byte) {
  while ((reg(ssi::kStatus) & ssi::kTransmitNotFull) == 0) {
  }
  reg(ssi::kData) = byte;
  while ((reg(ssi::kStatus) & ssi::kReceiveNotEmpty) == 0) {
  }
  return static_cast<std::uint8_t>(reg(ssi::kData));
}

}  // namespace

void enter_boot_loader() {
  reg(watchdog::kControl) = 0;
  reg(watchdog::kScratch0) = 0;
  using ResetToUsbBoot = void(std::uint32_t led_mask, std::uint32_t disabled_interfaces);
  rom_function<ResetToUsbBoot>(code('U', 'B'))(bit(kLedPin), 0);
  for (;;) {
  }
}

UniqueId read_unique_id() {
  rom_function<void()>(code('I', 'F'))();  // connects the flash pins and sets the interface to plain bytes
  rom_function<void()>(code('E', 'X'))();  // ends the flash's own read modes
  constexpr std::uint8_t kReadUniqueId = 0x4B;
  constexpr int kDummyBytes = 4;
  select_flash(true);
  exchange(kReadUniqueId);
  for (int i = 0; i < kDummyBytes; ++i) exchange(0);
  UniqueId id{};
  for (std::uint8_t& byte : id) byte = exchange(0);
  select_flash(false);
  return id;
}

bool second_tap() {
  const bool by_button = (reg(chip_reset::kCause) & chip_reset::kHadRun) != 0 && reg(watchdog::kReason) == 0;
  const bool second = by_button && reg(kTapMark) == kTapped;
  reg(kTapMark) = by_button && !second ? kTapped : 0;
  return second;
}

void forget_tap() {
  reg(kTapMark) = 0;
}

}  // namespace slamd::board
