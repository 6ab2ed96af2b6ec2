#include "daemon/config/yaml_fields.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

namespace slamd {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1 << 20;

/// One reading of one YAML document into one table.
class FieldReader {
 public:
  FieldReader(const std::string& name, const std::vector<Field>& fields) : name_{name}, fields_{fields} {}

  ConfigFaults read(const YAML::Node& root) {
    if (root.IsMap()) {
      read_section(root, "");
    } else if (!root.IsNull()) {
      fault(root, "(top)", "must be a list of 'key: value' lines");
    }
    return std::move(faults_);
  }

  ConfigFaults read_one(const std::string& key, const YAML::Node& value) {
    if (const Field* field = find(key)) {
      read_value(value, *field, value);
    } else {
      fault(value, key, "unknown key");
    }
    return std::move(faults_);
  }

 private:
  void read_section(const YAML::Node& section, const std::string& prefix) {
    for (const auto& entry : section) {
      if (!entry.first.IsScalar()) {
        fault(entry.first, prefix + "?", "a key must be a word");
        continue;
      }
      const std::string key = prefix + entry.first.Scalar();
      if (!seen_.insert(key).second) {
        fault(entry.first, key, "given twice");
      } else if (const Field* field = find(key)) {
        read_value(entry.second, *field, entry.first);
      } else if (!is_section(key)) {
        fault(entry.first, key, "unknown key");
      } else if (entry.second.IsMap()) {
        read_section(entry.second, key + ".");
      } else if (!entry.second.IsNull()) {
        fault(entry.second, key, "is a section, not a value");
      }
    }
  }

  /// `key_node` says where the fault is when there is no value.
  void read_value(const YAML::Node& node, const Field& field, const YAML::Node& key_node) {
    const std::size_t wanted = scalar_count(field);
    std::vector<std::string> scalars;
    if (wanted == 1 && node.IsScalar()) {
      scalars.push_back(node.Scalar());
    } else if (wanted > 1 && node.IsSequence() && node.size() == wanted) {
      for (const auto& item : node) scalars.push_back(item.IsScalar() ? item.Scalar() : "(list)");
    } else {
      fault(node.IsNull() ? key_node : node, field.key,
            wanted == 1 ? "must be one value" : "must be a list of " + std::to_string(wanted) + " numbers");
      return;
    }
    if (const std::string reason = assign(field, scalars); !reason.empty()) fault(node, field.key, reason);
  }

  const Field* find(const std::string& key) const {
    const auto found = std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) { return f.key == key; });
    return found == fields_.end() ? nullptr : &*found;
  }

  bool is_section(const std::string& key) const {
    const std::string prefix = key + ".";
    return std::any_of(fields_.begin(), fields_.end(), [&](const Field& f) { return f.key.starts_with(prefix); });
  }

  void fault(const YAML::Node& node, const std::string& key, const std::string& reason) {
    faults_.push_back(name_ + ":" + std::to_string(node.Mark().line + 1) + ": " + key + ": " + reason);
  }

  const std::string& name_;
  const std::vector<Field>& fields_;
  std::set<std::string> seen_;
  ConfigFaults faults_;
};

std::vector<std::string_view> split(std::string_view key) {
  std::vector<std::string_view> parts;
  for (std::size_t dot = key.find('.'); dot != std::string_view::npos; dot = key.find('.')) {
    parts.push_back(key.substr(0, dot));
    key.remove_prefix(dot + 1);
  }
  parts.push_back(key);
  return parts;
}

/// "# sentence [unit; min .. max; reload]"
std::string comment(const Field& field) {
  std::string notes;
  const auto note = [&notes](std::string_view text) {
    if (text.empty()) return;
    notes += notes.empty() ? " [" : "; ";
    notes += text;
  };
  note(field.unit);
  note(range_text(field));
  if (field.live) note("reload");
  return "# " + std::string{field.doc} + notes + (notes.empty() ? "" : "]");
}

}  // namespace

ConfigFaults read_yaml_text(const std::string& name, const std::string& text, const std::vector<Field>& fields) {
  try {
    return FieldReader{name, fields}.read(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    return {name + ":" + std::to_string(error.mark.line + 1) + ": (syntax): " + error.msg};
  }
}

ConfigFaults read_yaml_file(const std::string& path, const std::vector<Field>& fields) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  if (error) return {path + ":0: (file): " + error.message()};
  if (bytes > kMaxFileBytes) return {path + ":0: (file): larger than 1 MiB"};
  std::ifstream file{path, std::ios::binary};
  if (!file) return {path + ":0: (file): " + std::strerror(errno)};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  return read_yaml_text(path, text, fields);
}

ConfigFaults read_override(const std::string& assignment, const std::vector<Field>& fields) {
  const std::string name = "--set " + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return {name + ":1: (syntax): must be key=value"};
  const std::string value = assignment.substr(equals + 1);
  try {
    const YAML::Node node = value.empty() ? YAML::Node{""} : YAML::Load(value);
    return FieldReader{name, fields}.read_one(assignment.substr(0, equals), node);
  } catch (const YAML::Exception& error) {
    return {name + ":1: (syntax): " + error.msg};
  }
}

std::string print_yaml(const std::vector<Field>& fields) {
  std::string text;
  std::vector<std::string_view> open;  // sections of the line above
  for (const Field& field : fields) {
    const std::vector<std::string_view> parts = split(field.key);
    const auto common = static_cast<std::size_t>(
        std::mismatch(open.begin(), open.end(), parts.begin(), parts.end() - 1).first - open.begin());
    open.assign(parts.begin(), parts.end() - 1);
    for (std::size_t level = common; level < open.size(); ++level) {
      if (level == 0 && !text.empty()) text += '\n';
      text += std::string(2 * level, ' ') + std::string{open[level]} + ":\n";
    }
    const std::string indent(2 * open.size(), ' ');
    text += indent + comment(field) + "\n" + indent + std::string{parts.back()} + ": " + value_text(field) + "\n";
  }
  return text;
}

}  // namespace slamd
