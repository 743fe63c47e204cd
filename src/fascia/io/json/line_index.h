#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/base/error.h>

namespace fascia {

// Finds places in a file that was read, so that faults found later (while building) get a line too.
class LineIndex {
 public:
  struct Tree;  // what the file's text says; see line_tree.h

  LineIndex() = default;
  LineIndex(std::shared_ptr<const Tree> tree, std::string file)
      : tree_(std::move(tree)), file_(std::move(file)) {}

  // The line of the place or of its nearest ancestor in the file. Parts of the pointer that name
  // our structures but not the file's ("/flesh/solids/2", "…_rad") are matched to the file's.
  Location locate(std::string_view pointer) const;
  // The same issues with file, line and the file's own pointers.
  std::vector<Issue> locate(std::vector<Issue> issues) const;
  const std::string& file() const { return file_; }

 private:
  std::shared_ptr<const Tree> tree_;
  std::string file_;
};

}  // namespace fascia
