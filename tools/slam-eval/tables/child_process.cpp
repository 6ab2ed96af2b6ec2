#include "tools/slam-eval/tables/child_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tools/slam-eval/trajectory.hpp"

namespace slamd::eval {
namespace {

constexpr std::size_t kTail = 600;  // characters of a failed program's output that are told

std::string end_of(const std::string& path) {
  std::ifstream in{path};
  const std::string text{std::istreambuf_iterator<char>{in}, {}};
  return text.size() > kTail ? text.substr(text.size() - kTail) : text;
}

/// Standard output and error into one file.
class OutputTo {
 public:
  explicit OutputTo(const std::string& path) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  ~OutputTo() { posix_spawn_file_actions_destroy(&actions_); }
  OutputTo(const OutputTo&) = delete;
  OutputTo& operator=(const OutputTo&) = delete;

  const posix_spawn_file_actions_t* actions() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

int wait_for(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return status;
}

}  // namespace

void run_program(const std::vector<std::string>& arguments, const std::string& log_path) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const OutputTo output{log_path};
  pid_t pid = 0;
  if (::posix_spawn(&pid, argv[0], output.actions(), nullptr, argv.data(), environ) != 0) {
    throw InputError(arguments[0] + ": cannot be started");
  }
  const int status = wait_for(pid);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  throw InputError(arguments[0] + " failed (all it said is in " + log_path + "):\n" + end_of(log_path));
}

std::string find_sibling(const std::string& name) {
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const std::filesystem::path& place : {here / name, here / ".." / ".." / name / name}) {
    if (std::filesystem::is_regular_file(place)) return std::filesystem::weakly_canonical(place).string();
  }
  throw InputError(name + ": not found beside slam-eval; build it, or say where it is with --" + name);
}

}  // namespace slamd::eval
