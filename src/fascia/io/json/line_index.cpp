#include <fascia/io/json/line_index.h>

#include <algorithm>
#include <charconv>

#include <fascia/io/json/line_tree.h>

namespace fascia {
namespace {

std::string unescapedPointerKey(std::string_view key) {
  std::string out;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const bool escape = key[i] == '~' && i + 1 < key.size();
    if (!escape) {
      out += key[i];
    } else {
      out += key[++i] == '1' ? '/' : '~';
    }
  }
  return out;
}

// The child of `value` that a pointer's part names, and the part as the file spells it.
const Json* child(const Json& value, const std::string& part, std::string& spelled) {
  spelled = part;
  if (value.is(Json::Kind::list)) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    const bool whole = error == std::errc() && end == part.data() + part.size();
    return whole && index < value.list().size() ? &value.list()[index] : nullptr;
  }
  if (const Json* found = value.find(part)) return found;
  if (part.ends_with("_rad")) {
    spelled = part.substr(0, part.size() - 3) + "deg";
    return value.find(spelled);
  }
  return nullptr;
}

}  // namespace

Location LineIndex::locate(std::string_view pointer) const {
  Location where{file_, 0, {}};
  if (!tree_) {
    where.pointer = pointer;
    return where;
  }
  const Json* at = &tree_->root;
  where.line = at->line();
  std::string unmatched;  // trailing parts that the file lacks, e.g. a missing key
  while (!pointer.empty()) {
    pointer.remove_prefix(1);  // the slash
    const std::size_t end = std::min(pointer.find('/'), pointer.size());
    const std::string part = unescapedPointerKey(pointer.substr(0, end));
    pointer.remove_prefix(end);
    std::string spelled;
    if (const Json* next = child(*at, part, spelled)) {
      at = next;
      where.line = at->line();
      where.pointer += '/';
      where.pointer += escapedPointerKey(spelled);
      unmatched.clear();
    } else {
      unmatched += '/';
      unmatched += escapedPointerKey(spelled);
    }
  }
  where.pointer += unmatched;
  return where;
}

std::vector<Issue> LineIndex::locate(std::vector<Issue> issues) const {
  for (Issue& issue : issues) issue.where = locate(issue.where.pointer);
  return issues;
}

}  // namespace fascia
