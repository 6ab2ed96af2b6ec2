#include "tools/plot/pcd_file.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <vector>

#include "tools/plot/canvas.hpp"
#include "tools/plot/lzf.hpp"

namespace slamd::plot {
namespace {

constexpr std::size_t kMaxPoints = 500'000'000;
constexpr std::size_t kMaxPointBytes = 4096;
constexpr std::array<const char*, 4> kWanted{"x", "y", "z", "intensity"};

struct Field {
  std::string name;
  std::size_t size = 0;
  char type = 'F';  // F, I, U
  std::size_t count = 1;
  std::size_t offset = 0;  // bytes in a point
  std::size_t column = 0;  // number in a line of an ascii file
};

struct Header {
  std::vector<Field> fields;
  std::size_t points = 0;
  std::size_t point_bytes = 0;
  std::string data;  // ascii, binary, binary_compressed
};

[[noreturn]] void fail(const std::string& path, const std::string& reason) { throw PlotError(path + ": " + reason); }

template <class Assign>
void for_each_field(Header& header, std::istringstream& words, Assign assign) {
  for (Field& field : header.fields) assign(field, words);
}

// One line of the header; false after the DATA line.
bool take_header_line(Header& header, const std::string& line) {
  std::istringstream words(line);
  std::string key;
  words >> key;
  if (key == "FIELDS" || key == "COLUMNS") {
    std::string name;
    while (words >> name) header.fields.push_back({.name = name});
  } else if (key == "SIZE") {
    for_each_field(header, words, [](Field& f, auto& in) { in >> f.size; });
  } else if (key == "TYPE") {
    for_each_field(header, words, [](Field& f, auto& in) { in >> f.type; });
  } else if (key == "COUNT") {
    for_each_field(header, words, [](Field& f, auto& in) { in >> f.count; });
  } else if (key == "POINTS") {
    words >> header.points;
  } else if (key == "DATA") {
    words >> header.data;
    return false;
  }
  return true;
}

Header read_header(std::istream& in, const std::string& path) {
  Header header;
  std::string line;
  bool more = true;
  for (int count = 0; more && count < 100 && std::getline(in, line); ++count) more = take_header_line(header, line);
  if (more) fail(path, "is no PCD file (no DATA line in its header)");
  std::size_t column = 0;
  for (Field& field : header.fields) {
    const bool known = field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
    if (!known || field.count > kMaxPointBytes) fail(path, "field " + field.name + " has an unknown size");
    field.offset = header.point_bytes;
    field.column = column;
    header.point_bytes += field.size * field.count;
    column += field.count;
  }
  if (header.point_bytes == 0 || header.point_bytes > kMaxPointBytes || header.points > kMaxPoints) {
    fail(path, "its header asks for sizes beyond any map");
  }
  return header;
}

template <class T>
float as_float(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<float>(value);
}

float number(const char* bytes, const Field& field) {
  switch (field.size) {
    case 1: return field.type == 'I' ? as_float<std::int8_t>(bytes) : as_float<std::uint8_t>(bytes);
    case 2: return field.type == 'I' ? as_float<std::int16_t>(bytes) : as_float<std::uint16_t>(bytes);
    case 4:
      if (field.type == 'F') return as_float<float>(bytes);
      return field.type == 'I' ? as_float<std::int32_t>(bytes) : as_float<std::uint32_t>(bytes);
    default:
      if (field.type == 'F') return as_float<double>(bytes);
      return field.type == 'I' ? as_float<std::int64_t>(bytes) : as_float<std::uint64_t>(bytes);
  }
}

// Which field holds x, y, z and intensity.
std::array<const Field*, 4> wanted_fields(const Header& header, const std::string& path) {
  std::array<const Field*, 4> wanted{};
  for (const Field& field : header.fields) {
    for (std::size_t i = 0; i < kWanted.size(); ++i) {
      if (field.name == kWanted[i] && field.count > 0) wanted[i] = &field;
    }
  }
  if (wanted[0] == nullptr || wanted[1] == nullptr || wanted[2] == nullptr) fail(path, "has no fields x, y, z");
  return wanted;
}

void keep_finite(const std::array<float, 4>& v, PointCloud& points) {
  if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2])) return;
  points.push_back({v[0], v[1], v[2], std::isfinite(v[3]) ? v[3] : 0.0F});
}

PointCloud take_ascii(std::istream& in, const Header& header, const std::string& path) {
  const auto wanted = wanted_fields(header, path);
  PointCloud points;
  std::string line;
  for (std::size_t i = 0; i < header.points && std::getline(in, line); ++i) {
    std::istringstream words(line);
    const std::vector<std::string> columns{std::istream_iterator<std::string>(words), {}};
    std::array<float, 4> v{};
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k] == nullptr) continue;
      if (wanted[k]->column >= columns.size()) fail(path, "point " + std::to_string(i) + " has too few columns");
      v[k] = std::strtof(columns[wanted[k]->column].c_str(), nullptr);
    }
    keep_finite(v, points);
  }
  return points;
}

// by_field: all values of a field follow each other (as in a compressed file), not all fields of a point.
PointCloud take_binary(const std::string& bytes, const Header& header, bool by_field, const std::string& path) {
  if (bytes.size() < header.points * header.point_bytes) fail(path, "ends before its last point");
  const auto wanted = wanted_fields(header, path);
  PointCloud points;
  points.reserve(header.points);
  for (std::size_t i = 0; i < header.points; ++i) {
    std::array<float, 4> v{};
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const Field* f = wanted[k];
      if (f == nullptr) continue;
      const std::size_t at = by_field ? f->offset * header.points + i * f->size * f->count : i * header.point_bytes + f->offset;
      v[k] = number(bytes.data() + at, *f);
    }
    keep_finite(v, points);
  }
  return points;
}

std::string decompressed(const std::string& bytes, const Header& header, const std::string& path) {
  std::array<std::uint32_t, 2> sizes{};  // compressed, uncompressed
  if (bytes.size() < sizeof(sizes)) fail(path, "ends before its first point");
  std::memcpy(sizes.data(), bytes.data(), sizeof(sizes));
  if (sizes[1] != header.points * header.point_bytes) fail(path, "its header and its data differ in size");
  const auto plain = lzf_decompress(std::string_view(bytes).substr(sizeof(sizes), sizes[0]), sizes[1]);
  if (!plain) fail(path, "its compressed data are damaged");
  return *plain;
}

}  // namespace

PointCloud read_pcd(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path, "cannot be opened for reading");
  const Header header = read_header(in, path);
  PointCloud points;
  if (header.data == "ascii") {
    points = take_ascii(in, header, path);
  } else {
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const bool compressed = header.data == "binary_compressed";
    if (!compressed && header.data != "binary") fail(path, "has data of unknown kind '" + header.data + "'");
    points = take_binary(compressed ? decompressed(bytes, header, path) : bytes, header, compressed, path);
  }
  if (points.empty()) fail(path, "holds no point");
  return points;
}

}  // namespace slamd::plot
