#include "tools/slam-pgo/g2o_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_map>

#include <Eigen/Eigenvalues>

#include "tools/slam-pgo/g2o_words.hpp"

namespace slamd::pgo {
namespace {

using Words = std::vector<std::string_view>;

void split(std::string_view line, Words& words) {
  constexpr std::string_view kSpace = " \t\r\v\f";
  words.clear();
  for (std::size_t begin = line.find_first_not_of(kSpace); begin != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSpace, end);
  }
}

template <class Number>
bool parse(std::string_view word, Number& number) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc{} && rest == word.data() + word.size();
}

bool parse_id(std::string_view word, std::int64_t& id) { return parse(word, id) && id >= 0; }

bool parse_values(std::span<const std::string_view> words, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!parse(words[i], values[i]) || !std::isfinite(values[i])) return false;
  }
  return true;
}

using Fault = std::optional<std::string>;  // nullopt: none
constexpr const char* kBadId = "an id is not a whole number from 0 to 2^63 - 1";
constexpr const char* kBadNumber = "a value is not a finite number";

/// The records of one space, as they come.
template <class Group>
class Reader {
 public:
  using Format = G2oWords<Group>;
  static constexpr std::size_t kInformation = Group::kDof * (Group::kDof + 1) / 2;

  Fault vertex(const Words& words) {
    if (words.size() != 2 + Format::kValues) return expected(Format::kVertex, 1 + Format::kValues);
    std::int64_t id = 0;
    std::array<double, Format::kValues> values;
    if (!parse_id(words[1], id)) return kBadId;
    if (!parse_values(std::span{words}.subspan(2), values)) return kBadNumber;
    if (!Format::valid(values)) return "the quaternion's norm is not 1";
    const std::size_t i = index(id);
    if (given_[i]) return "pose " + std::to_string(id) + " is given twice";
    given_[i] = true;
    out_.graph.poses[i] = normalised(values);
    return std::nullopt;
  }

  Fault edge(const Words& words) {
    constexpr std::size_t kWords = 2 + Format::kValues + kInformation;
    if (words.size() != 1 + kWords) return expected(Format::kEdge, kWords);
    std::int64_t from = 0;
    std::int64_t to = 0;
    if (!parse_id(words[1], from) || !parse_id(words[2], to)) return kBadId;
    if (from == to) return "an edge from a pose to itself";
    std::array<double, Format::kValues> values;
    std::array<double, kInformation> upper;
    const std::span all{words};
    if (!parse_values(all.subspan(3), values) || !parse_values(all.subspan(3 + Format::kValues), upper)) return kBadNumber;
    if (!Format::valid(values)) return "the quaternion's norm is not 1";
    Edge<Group> edge;
    for (int i = 0, k = 0; i < Group::kDof; ++i) {
      for (int j = i; j < Group::kDof; ++j) edge.information(i, j) = edge.information(j, i) = upper[static_cast<std::size_t>(k++)];
    }
    if (!says_something(edge.information)) return "the information matrix is not positive semidefinite, or zero";
    edge.from = index(from);
    edge.to = index(to);
    edge.measured = normalised(values);
    out_.graph.edges.push_back(edge);
    return std::nullopt;
  }

  Fault fix(std::int64_t id) {
    const auto found = indices_.find(id);
    if (found == indices_.end()) return "FIX of pose " + std::to_string(id) + ", which is not there";
    out_.graph.fixed[found->second] = true;
    return std::nullopt;
  }

  bool full() const { return out_.ids.size() > kMaxPoses; }

  /// Poses in order of their ids.
  G2oGraph<Group> finish() && {
    std::vector<std::size_t> order(out_.ids.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return out_.ids[a] < out_.ids[b]; });
    G2oGraph<Group> sorted;
    std::vector<std::size_t> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      place[order[i]] = i;
      sorted.ids.push_back(out_.ids[order[i]]);
      sorted.graph.poses.push_back(out_.graph.poses[order[i]]);
      sorted.graph.fixed.push_back(out_.graph.fixed[order[i]]);
    }
    sorted.graph.edges = std::move(out_.graph.edges);
    for (Edge<Group>& edge : sorted.graph.edges) {
      edge.from = place[edge.from];
      edge.to = place[edge.to];
    }
    sorted.complete = std::find(given_.begin(), given_.end(), false) == given_.end();
    return sorted;
  }

 private:
  static std::string expected(const char* record, std::size_t values) {
    return std::string{record} + " has " + std::to_string(values) + " values";
  }

  static typename Group::Element normalised(std::span<const double> values) {
    typename Group::Element element = Format::element(values);
    if constexpr (Group::kDimension == 3) {
      if (std::abs(element.rotation.squaredNorm() - 1.0) > 1e-12) element.rotation.normalize();  // what we wrote stays
    }
    return element;
  }

  /// Nothing of some directions, as of a rotation that was not measured, is allowed; of all directions it is not.
  static bool says_something(const typename Group::Matrix& information) {
    constexpr double kRounding = 1e-9;  // of files with few digits
    const Eigen::SelfAdjointEigenSolver<typename Group::Matrix> axes{information, Eigen::EigenvaluesOnly};
    const double most = axes.eigenvalues().maxCoeff();
    return std::isfinite(most) && most > 0.0 && axes.eigenvalues().minCoeff() >= -kRounding * most;
  }

  std::size_t index(std::int64_t id) {
    const auto [found, added] = indices_.try_emplace(id, out_.ids.size());
    if (added) {
      out_.ids.push_back(id);
      out_.graph.poses.emplace_back();
      out_.graph.fixed.push_back(false);
      given_.push_back(false);
    }
    return found->second;
  }

  G2oGraph<Group> out_;
  std::vector<bool> given_;  // by a VERTEX line
  std::unordered_map<std::int64_t, std::size_t> indices_;
};

class FileReader {
 public:
  Fault line(std::string_view text, std::size_t number) {
    split(text, words_);
    if (words_.empty() || words_[0].starts_with('#') || words_[0].starts_with("PARAMS_")) return std::nullopt;
    if (words_[0] == "FIX") return fix(number);
    if (const std::optional<Fault> taken = record<GroupSe2>()) return *taken;
    if (const std::optional<Fault> taken = record<GroupSe3>()) return *taken;
    return "unknown record " + std::string{words_[0].substr(0, 40)};
  }

  std::variant<AnyGraph, G2oFault> finish() && {
    if (std::holds_alternative<std::monostate>(reader_)) return G2oFault{0, "no pose and no edge in the file"};
    if (Reader<GroupSe2>* planar = std::get_if<Reader<GroupSe2>>(&reader_)) return finish(std::move(*planar));
    return finish(std::move(std::get<Reader<GroupSe3>>(reader_)));
  }

 private:
  /// Nothing when the record is not of this space.
  template <class Group>
  std::optional<Fault> record() {
    const bool vertex = words_[0] == G2oWords<Group>::kVertex;
    if (!vertex && words_[0] != G2oWords<Group>::kEdge) return std::nullopt;
    if (std::holds_alternative<std::monostate>(reader_)) reader_.template emplace<Reader<Group>>();
    Reader<Group>* const reader = std::get_if<Reader<Group>>(&reader_);
    if (reader == nullptr) return Fault{"2D and 3D records in one file"};
    Fault fault = vertex ? reader->vertex(words_) : reader->edge(words_);
    if (!fault && reader->full()) fault = "more than " + std::to_string(kMaxPoses) + " poses";
    return fault;
  }

  Fault fix(std::size_t number) {
    if (words_.size() < 2) return "FIX without an id";
    for (std::size_t i = 1; i < words_.size(); ++i) {
      std::int64_t id = 0;
      if (!parse_id(words_[i], id)) return kBadId;
      fixes_.try_emplace(id, number);
    }
    return std::nullopt;
  }

  template <class Group>
  std::variant<AnyGraph, G2oFault> finish(Reader<Group>&& reader) {
    for (const auto& [id, number] : fixes_) {
      if (Fault fault = reader.fix(id)) return G2oFault{number, *fault};
    }
    return AnyGraph{std::move(reader).finish()};
  }

  Words words_;
  std::variant<std::monostate, Reader<GroupSe2>, Reader<GroupSe3>> reader_;
  std::map<std::int64_t, std::size_t> fixes_;  // id to line; poses may come later than their FIX
};

void write_numbers(std::ostream& out, std::span<const double> numbers) {
  std::array<char, 32> text;
  for (const double number : numbers) {
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
    out << ' ' << std::string_view{text.data(), static_cast<std::size_t>(end - text.data())};
  }
}

template <class Group>
void write(std::ostream& out, const G2oGraph<Group>& g2o) {
  std::array<double, G2oWords<Group>::kValues> values;
  const PoseGraph<Group>& graph = g2o.graph;
  for (std::size_t i = 0; i < graph.poses.size(); ++i) {
    G2oWords<Group>::values(graph.poses[i], values);
    out << G2oWords<Group>::kVertex << ' ' << g2o.ids[i];
    write_numbers(out, values);
    out << '\n';
    if (graph.fixed[i]) out << "FIX " << g2o.ids[i] << '\n';
  }
  for (const Edge<Group>& edge : graph.edges) {
    G2oWords<Group>::values(edge.measured, values);
    out << G2oWords<Group>::kEdge << ' ' << g2o.ids[edge.from] << ' ' << g2o.ids[edge.to];
    write_numbers(out, values);
    for (int i = 0; i < Group::kDof; ++i) {
      for (int j = i; j < Group::kDof; ++j) write_numbers(out, std::span{&edge.information(i, j), 1});
    }
    out << '\n';
  }
}

}  // namespace

std::variant<AnyGraph, G2oFault> read_g2o(std::istream& in) {
  FileReader reader;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (const Fault fault = reader.line(line, number)) return G2oFault{number, *fault};
  }
  return std::move(reader).finish();
}

void write_g2o(std::ostream& out, const AnyGraph& any) {
  std::visit([&out](const auto& g2o) { write(out, g2o); }, any);
}

}  // namespace slamd::pgo
