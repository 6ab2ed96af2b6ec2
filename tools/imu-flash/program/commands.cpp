#include "tools/imu-flash/program/commands.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "tools/imu-flash/board.hpp"
#include "tools/imu-flash/flasher.hpp"
#include "tools/imu-flash/program/progress_bar.hpp"
#include "tools/imu-flash/stream_check.hpp"
#include "tools/imu-flash/uf2.hpp"

namespace slamd::flash {
namespace {

constexpr std::uint32_t kRebootDelayMs = 100;  // so that the acknowledgement still gets out
constexpr Duration kStartTime = std::chrono::seconds{10};
constexpr Duration kMeasuredTime = std::chrono::seconds{1};
constexpr std::size_t kMaxFileBytes = 64U << 20U;

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // the signal handler writes it

void on_interrupt(int) {
  interrupted = true;
}

int fail(int code, const std::string& text) {
  std::fprintf(stderr, "imu-flash: %s\n", text.c_str());
  return code;
}

LoadedImage load(const Options& options) {
  std::ifstream file{options.file, std::ios::binary};
  if (!file) return {{}, "cannot be opened"};
  std::vector<char> bytes(kMaxFileBytes + 1);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.bad()) return {{}, "cannot be read"};
  const auto size = static_cast<std::size_t>(file.gcount());
  if (size > kMaxFileBytes) return {{}, "larger than 64 MiB"};
  const std::vector<std::uint8_t> content{bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
  return options.binary ? image_of_binary(content) : parse_uf2(content);
}

LoadedImage load_or_complain(const Options& options) {
  LoadedImage loaded = load(options);
  if (!loaded) {
    fail(kRefused, options.file + ": " + loaded.refusal);
  } else if (!loaded.image.is_bootable()) {
    std::fprintf(stderr, "imu-flash: warning: %s has no valid second stage: the board will not start it\n",
                 options.file.c_str());
  }
  return loaded;
}

/// A board in its boot loader, claimed; nothing when that failed, which is then said.
std::optional<UsbListing> open_boot_loader(const Options& options, UsbPicoboot& picoboot) {
  ChosenBoard chosen = choose_board(find_boards(), options.serial);
  if (chosen && !is_in_boot_loader(chosen.board)) {
    std::printf("%s: going to its boot loader\n", describe(chosen.board).c_str());
    std::fflush(stdout);
    chosen = enter_boot_loader(chosen.board);
  }
  if (chosen) chosen.refusal = picoboot.open(chosen.board);
  if (chosen) return chosen.board;
  fail(kFailed, chosen.refusal);
  return std::nullopt;
}

FlashProgress progress(ProgressBar& bar) {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  return [&bar](Step step, std::size_t done, std::size_t total) {
    bar.show(name(step), done, total);
    return !interrupted.load();
  };
}

int start_and_check(PicobootClient& client, const std::string& port) {
  const PicobootOutcome rebooted = client.reboot(kRebootDelayMs);
  // A board that leaves before its acknowledgement has rebooted as well.
  if (!rebooted && rebooted.fault != UsbFault::kGone)
    return fail(kFailed, "written and verified, but: " + rebooted.text);
  const std::optional<UsbListing> board = wait_for_firmware(port, kStartTime);
  if (!board) {
    return fail(kFailed,
                "written and verified, but the board did not come back as slamd IMU (1209:0001) within 10 s.\n"
                "Is it our firmware? imu-flash --list shows the board if it is in its boot loader.");
  }
  if (board->fault != UsbFault::kNone)
    return fail(kFailed, "written and verified, but " + opening_refusal(*board, board->fault));
  const StreamReport stream = check_stream(*board, kMeasuredTime, kStartTime);
  if (!stream.text.empty()) std::printf("%s\n", stream.text.c_str());
  return stream ? kDone : fail(kFailed, "written and verified, but " + stream.failure);
}

}  // namespace

int list_boards() {
  const std::vector<UsbListing> boards = find_boards();
  for (const UsbListing& board : boards) std::printf("%s\n", describe(board).c_str());
  if (boards.empty()) std::printf("no board found\n");
  return kDone;
}

int print_image(const Options& options) {
  const LoadedImage loaded = load(options);
  if (!loaded) return fail(kRefused, options.file + ": " + loaded.refusal);
  const std::vector<Page>& pages = loaded.image.pages;
  std::printf("%s: %s\n", options.file.c_str(), options.binary ? "binary" : "UF2, family 0xe48bff56 (RP2040)");
  std::printf("pages         %zu of 256 bytes (%zu bytes)\n", pages.size(), pages.size() * kPageBytes);
  std::printf("addresses     0x%08x .. 0x%08x\n", pages.front().address, pages.back().address + kPageBytes - 1);
  std::printf("sectors       %zu of 4096 bytes to erase\n", loaded.image.sectors().size());
  std::printf("second stage  %s\n", loaded.image.is_bootable() ? "valid: the chip starts it"
                                    : loaded.image.has_second_stage()
                                        ? "wrong checksum: the chip does not start it"
                                        : "none: the image does not begin at the flash's start");
  return kDone;
}

int flash_board(const Options& options) {
  const LoadedImage loaded = load_or_complain(options);
  if (!loaded) return kRefused;
  UsbPicoboot picoboot;
  const std::optional<UsbListing> board = open_boot_loader(options, picoboot);
  if (!board) return kFailed;
  PicobootClient client{picoboot};
  FlashOutcome outcome;
  {
    ProgressBar bar;
    outcome = Flasher{client, loaded.image, progress(bar)}.write();
  }
  if (!outcome) {
    return fail(kFailed,
                outcome.failure +
                    "\nThe board was not started. It stays in its boot loader, also when it is unplugged and plugged "
                    "in again:\nrun the same command once more, or see imu-flash --rescue.");
  }
  return start_and_check(client, board->port);
}

int verify_board(const Options& options) {
  const LoadedImage loaded = load_or_complain(options);
  if (!loaded) return kRefused;
  UsbPicoboot picoboot;
  if (!open_boot_loader(options, picoboot)) return kFailed;
  PicobootClient client{picoboot};
  FlashOutcome outcome;
  {
    ProgressBar bar;
    outcome = Flasher{client, loaded.image, progress(bar)}.verify();
  }
  const PicobootOutcome rebooted = client.reboot(kRebootDelayMs);
  if (!outcome) return fail(kFailed, outcome.failure);
  if (!rebooted && rebooted.fault != UsbFault::kGone) return fail(kFailed, "verified, but: " + rebooted.text);
  std::printf("the flash holds %s\n", options.file.c_str());
  return kDone;
}

}  // namespace slamd::flash
