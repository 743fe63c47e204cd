#include <algorithm>
#include <charconv>
#include <cmath>
#include <unordered_set>

#include <fascia/base/error.h>
#include <fascia/base/suggest.h>
#include <fascia/io/file/file.h>
#include <fascia/io/motion/bvh.h>

namespace fascia {
namespace {

// What a stranger's file may cost us.
constexpr std::size_t kMaxJoints = 4096;
constexpr double kLargestValue = 1e9;  // no length or angle in any unit is larger
constexpr double kLongestFrameTime_s = 1000;

constexpr std::pair<std::string_view, BvhChannel> kChannels[] = {
    {"xposition", BvhChannel::xPosition}, {"yposition", BvhChannel::yPosition},
    {"zposition", BvhChannel::zPosition}, {"xrotation", BvhChannel::xRotation},
    {"yrotation", BvhChannel::yRotation}, {"zrotation", BvhChannel::zRotation}};

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

// Words of the file one by one, with the line for messages.
class Words {
 public:
  Words(std::string_view text, const std::string& file) : left_(text), file_(file) {}

  std::string_view peek() {
    skipSpace();
    // Braces stand alone even where nothing separates them.
    if (!left_.empty() && isBrace(left_[0])) return left_.substr(0, 1);
    std::size_t size = 0;
    while (size < left_.size() && !ends(left_[size])) ++size;
    return left_.substr(0, size);
  }
  std::string_view next(const char* expected) {
    const std::string_view word = peek();
    if (word.empty()) fail(std::string("the file ends, expected ") + expected);
    left_.remove_prefix(word.size());
    return word;
  }
  // The rest of the line up to a brace: names may hold spaces.
  std::string_view restOfLine() {
    while (!left_.empty() && isSpace(left_[0]) && left_[0] != '\n') left_.remove_prefix(1);
    std::size_t size = 0;
    while (size < left_.size() && left_[size] != '\n' && left_[size] != '{') ++size;
    std::string_view rest = left_.substr(0, size);
    left_.remove_prefix(size);
    while (!rest.empty() && isSpace(rest.back())) rest.remove_suffix(1);
    return rest;
  }
  void expect(std::string_view keyword) {
    const std::string_view word = next(std::string(keyword).c_str());
    if (lower(word) != lower(keyword)) failFound(word, std::string(keyword));
  }
  double number(const char* what) {
    std::string_view word = next(what);
    const std::string_view shown = word;
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() ||
        !(std::abs(value) <= kLargestValue))
      failFound(shown, what);
    return value;
  }
  std::size_t count(const char* what) {
    const std::string_view word = next(what);
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) failFound(word, what);
    return value;
  }
  std::size_t bytesLeft() const { return left_.size(); }

  [[noreturn]] void failFound(std::string_view found, const std::string& expected) const {
    fail(std::string("found ") + quotedName(found) + ", expected " + expected);
  }
  [[noreturn]] void fail(std::string message, std::string hint = {}) const {
    Issue issue;
    issue.where = {file_, line_, {}};
    issue.message = std::move(message);
    issue.hint = std::move(hint);
    throw Error(std::move(issue));
  }

 private:
  static bool isBrace(char c) { return c == '{' || c == '}'; }
  static bool ends(char c) { return isSpace(c) || isBrace(c); }
  void skipSpace() {
    while (!left_.empty() && isSpace(left_[0])) {
      if (left_[0] == '\n') ++line_;
      left_.remove_prefix(1);
    }
  }

  std::string_view left_;
  const std::string& file_;
  int line_ = 1;
};

class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : words_(text, file) {}

  BvhMotion parse() {
    words_.expect("HIERARCHY");
    words_.expect("ROOT");
    readTree();
    words_.expect("MOTION");
    readFrames();
    return std::move(motion_);
  }

 private:
  // A joint's opening up to its brace; its contents follow.
  int openJoint(int parent) {
    if (motion_.joints.size() >= kMaxJoints) {
      words_.fail("more than " + std::to_string(kMaxJoints) + " joints");
    }
    BvhJoint joint;
    joint.name = words_.restOfLine();
    if (joint.name.empty()) words_.fail("found a joint without a name");
    joint.parent = parent;
    if (!names_.insert(joint.name).second) {
      const std::string original = joint.name;
      while (!names_.insert(joint.name).second) {
        joint.name = original + "_" + std::to_string(++renamed_);
      }
      motion_.notes.push_back("two joints are called " + quotedName(original) + ": one is now " +
                              quotedName(joint.name));
    }
    words_.expect("{");
    motion_.joints.push_back(std::move(joint));
    return static_cast<int>(motion_.joints.size()) - 1;
  }

  // No recursion: a hostile file may nest as deep as it likes.
  void readTree() {
    int current = openJoint(-1);
    while (current >= 0) {
      BvhJoint& joint = motion_.joints[static_cast<std::size_t>(current)];
      const std::string_view word = words_.next("OFFSET, CHANNELS, JOINT, End Site or }");
      const std::string keyword = lower(word);
      if (keyword == "offset") {
        joint.offset = readVector();
      } else if (keyword == "channels") {
        readChannels(joint);
      } else if (keyword == "joint") {
        current = openJoint(current);
      } else if (keyword == "end") {
        words_.restOfLine();
        words_.expect("{");
        words_.expect("OFFSET");
        joint.endSite = readVector();
        words_.expect("}");
      } else if (keyword == "}") {
        current = joint.parent;
      } else {
        words_.failFound(word, "OFFSET, CHANNELS, JOINT, End Site or }");
      }
    }
    if (lower(words_.peek()) == "root") {
      words_.fail("found a second ROOT, expected MOTION", "keep one figure in the file");
    }
  }

  Vec3 readVector() {
    const double x = words_.number("a length"), y = words_.number("a length");
    return {x, y, words_.number("a length")};
  }

  void readChannels(BvhJoint& joint) {
    if (!joint.channels.empty())
      words_.fail("found a second CHANNELS of " + quotedName(joint.name));
    const std::size_t count = words_.count("a number of channels");
    if (count > std::size(kChannels)) {
      words_.fail("found " + std::to_string(count) + " channels, expected at most 6");
    }
    joint.firstChannel = motion_.channelCount;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view word = words_.next("a channel");
      const std::string name = lower(word);
      const auto* const found = std::find_if(std::begin(kChannels), std::end(kChannels),
                                             [&](const auto& c) { return c.first == name; });
      if (found == std::end(kChannels)) {
        words_.failFound(word,
                         "Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation");
      }
      if (std::count(joint.channels.begin(), joint.channels.end(), found->second) > 0) {
        words_.fail("found " + quotedName(word) + " twice in " + quotedName(joint.name));
      }
      joint.channels.push_back(found->second);
    }
    motion_.channelCount += count;
  }

  void readFrames() {
    words_.expect("Frames:");
    const std::size_t frames = words_.count("a number of frames");
    words_.expect("Frame");
    words_.expect("Time:");
    motion_.frameTime_s = words_.number("a time in seconds");
    if (!(motion_.frameTime_s > 0) || motion_.frameTime_s > kLongestFrameTime_s) {
      words_.fail("found a frame time of " + shortNumber(motion_.frameTime_s) +
                  ", expected seconds in (0, 1000]");
    }
    if (motion_.channelCount == 0) words_.fail("found no channels, expected at least one");
    // Every value takes two bytes at least, whatever the file claims.
    motion_.values.reserve(std::min(frames, words_.bytesLeft() / motion_.channelCount) *
                           motion_.channelCount);
    while (!words_.peek().empty()) {
      motion_.values.push_back(static_cast<float>(words_.number("a number")));
    }
    const std::size_t found = motion_.frameCount();
    const std::size_t over = motion_.values.size() - found * motion_.channelCount;
    if (found == 0) words_.fail("found no whole frame, expected " + std::to_string(frames));
    if (over > 0) {
      words_.fail("the last frame has " + std::to_string(over) + " values, expected " +
                  std::to_string(motion_.channelCount));
    }
    if (found != frames) {
      motion_.notes.push_back("the file says " + std::to_string(frames) + " frames and holds " +
                              std::to_string(found));
    }
  }

  Words words_;
  BvhMotion motion_;
  std::unordered_set<std::string> names_;
  int renamed_ = 1;  // only grows, so that no file makes the search for a free name long
};

}  // namespace

BvhMotion parseBvh(std::string_view text, const std::string& file) {
  return Parser(withoutByteOrderMark(text), file).parse();
}

}  // namespace fascia
