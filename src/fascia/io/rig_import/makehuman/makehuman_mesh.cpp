#include <fascia/io/rig_import/makehuman/makehuman_mesh.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <unordered_map>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/io/file/file.h>

namespace fascia {
namespace {

constexpr double kLargestNumber = 1e6;

class ObjParser {
 public:
  explicit ObjParser(const std::string& file) : file_(file) {}

  ObjMesh parse(std::string_view text) {
    while (!text.empty()) {
      ++line_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      left_ = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      readLine();
    }
    return std::move(mesh_);
  }

 private:
  void readLine() {
    const std::string_view keyword = word();
    if (keyword == "v") {
      const double x = number(), y = number();
      mesh_.positions.emplace_back(x, y, number());
    } else if (keyword == "vt") {
      const double u = number();
      mesh_.uvs.emplace_back(u, number());
    } else if (keyword == "g" || keyword == "o") {
      openGroup(std::string(word()));
    } else if (keyword == "f") {
      readFace();
    }
  }

  void openGroup(const std::string& name) {
    const auto [found, isNew] = byName_.try_emplace(name, mesh_.groups.size());
    if (isNew) mesh_.groups.push_back({name, {}, {}});
    group_ = found->second;
  }

  void readFace() {
    if (mesh_.groups.empty()) openGroup("");
    ObjMesh::Group& group = mesh_.groups[group_];
    std::uint32_t count = 0;
    for (std::string_view corner = word(); !corner.empty(); corner = word(), ++count) {
      const std::size_t slash = std::min(corner.find('/'), corner.size());
      ObjMesh::Corner out;
      out.position = index(corner.substr(0, slash), mesh_.positions.size());
      corner.remove_prefix(std::min(slash + 1, corner.size()));
      const std::string_view uv = corner.substr(0, corner.find('/'));
      if (!uv.empty()) out.uv = static_cast<std::int32_t>(index(uv, mesh_.uvs.size()));
      group.corners.push_back(out);
    }
    if (count < 3)
      fail("found a face of " + std::to_string(count) + " corners, expected 3 or more");
    group.faceCorners.push_back(count);
  }

  std::string_view word() {
    const std::size_t first = std::min(left_.find_first_not_of(" \t\r"), left_.size());
    left_.remove_prefix(first);
    const std::string_view found = left_.substr(0, left_.find_first_of(" \t\r"));
    left_.remove_prefix(found.size());
    return found;
  }

  double number() {
    const std::string_view text = word();
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() ||
        !(std::abs(value) <= kLargestNumber))
      fail(std::string("found ") + quotedName(text) + ", expected a number");
    return value;
  }

  // Counted from 1, or back from the end if negative.
  std::uint32_t index(std::string_view text, std::size_t count) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::int64_t size = static_cast<std::int64_t>(count);
    if (value < 0 && value >= -size) value += size + 1;
    if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > size) {
      fail(std::string("found ") + quotedName(text) + ", expected an index from 1 to " +
           std::to_string(count));
    }
    return static_cast<std::uint32_t>(value - 1);
  }

  [[noreturn]] void fail(std::string message) const {
    Issue issue;
    issue.where = {file_, line_, {}};
    issue.message = std::move(message);
    throw Error(std::move(issue));
  }

  const std::string& file_;
  int line_ = 0;
  std::string_view left_;
  std::size_t group_ = 0;
  std::unordered_map<std::string, std::size_t> byName_;
  ObjMesh mesh_;
};

}  // namespace

const ObjMesh::Group* ObjMesh::find(std::string_view name) const {
  for (const Group& group : groups) {
    if (group.name == name) return &group;
  }
  return nullptr;
}

ObjMesh parseObj(std::string_view text, const std::string& file) {
  return ObjParser(file).parse(withoutByteOrderMark(text));
}

Vec3 middleOf(const ObjMesh& mesh, const ObjMesh::Group& group) {
  std::vector<std::uint32_t> points;
  for (const ObjMesh::Corner& corner : group.corners) points.push_back(corner.position);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t p : points) sum += mesh.positions[p];
  return sum / static_cast<double>(points.size());
}

}  // namespace fascia
