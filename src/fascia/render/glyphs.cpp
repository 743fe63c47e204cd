#include <fascia/render/glyphs.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

namespace fascia {
namespace {

// M x y: the pen goes there. L x y: a line. Q cx cy x y: a quarter of an ellipse that leaves
// towards the corner c and arrives from it.
struct Path {
  char32_t character;
  std::string_view strokes;
};

constexpr std::string_view kBowl = "M0 25Q0 50 20 50Q40 50 40 25Q40 0 20 0Q0 0 0 25";

constexpr Path kOnABowl[] = {
    {U'a', "M40 50L40 0"},
    {U'b', "M0 70L0 0"},
    {U'd', "M40 70L40 0"},
    {U'g', "M40 50L40 -4Q40 -20 21 -20Q10 -20 4 -15"},
    {U'o', ""},
    {U'p', "M0 50L0 -20"},
    {U'q', "M40 50L40 -20"},
};

constexpr Path kOutlines[] = {
    {U'c', "M36 42Q31 50 20 50Q0 50 0 25Q0 0 20 0Q31 0 36 8"},
    {U'e', "M0 26L40 26Q40 50 20 50Q0 50 0 25Q0 0 20 0Q31 0 37 8"},
    {U'f', "M26 70L24 70Q10 70 10 56L10 0M0 48L24 48"},
    {U'h', "M0 70L0 0M0 28Q0 50 19 50Q36 50 36 30L36 0"},
    {U'i', "M0 50L0 0M0 67L0 68"},
    {U'j', "M8 50L8 -8Q8 -20 -4 -20M8 67L8 68"},
    {U'k', "M0 70L0 0M32 50L0 18M12 29L34 0"},
    {U'l', "M0 70L0 12Q0 0 11 0"},
    {U'm', "M0 50L0 0M0 30Q0 50 16 50Q30 50 30 32L30 0M30 30Q30 50 46 50Q60 50 60 32L60 0"},
    {U'n', "M0 50L0 0M0 28Q0 50 19 50Q36 50 36 30L36 0"},
    {U'r', "M0 50L0 0M0 26Q0 50 20 50L22 50"},
    {U's', "M32 41Q28 50 17 50Q2 50 2 38Q2 27 17 25Q33 23 33 13Q33 0 17 0Q4 0 0 9"},
    {U't', "M10 66L10 14Q10 0 23 0L25 0M0 50L24 50"},
    {U'u', "M0 50L0 20Q0 0 17 0Q36 0 36 22M36 50L36 0"},
    {U'v', "M0 50L18 0L36 50"},
    {U'w', "M0 50L14 0L28 48L42 0L56 50"},
    {U'x', "M0 50L34 0M34 50L0 0"},
    {U'y', "M0 50L18 0M36 50L16 -6Q11 -20 2 -20"},
    {U'z', "M2 50L34 50L0 0L36 0"},
    {U'A', "M0 0L27 70L54 0M9 24L45 24"},
    {U'B', "M0 0L0 70L24 70Q42 70 42 53Q42 37 24 37L0 37M24 37Q46 37 46 18Q46 0 24 0L0 0"},
    {U'C', "M53 56Q46 70 31 70Q0 70 0 35Q0 0 31 0Q46 0 53 14"},
    {U'D', "M0 0L0 70L20 70Q54 70 54 35Q54 0 20 0L0 0"},
    {U'E', "M42 70L0 70L0 0L43 0M0 37L38 37"},
    {U'F', "M42 70L0 70L0 0M0 36L37 36"},
    {U'G', "M54 57Q47 70 31 70Q0 70 0 35Q0 0 31 0Q56 0 56 26L56 33L33 33"},
    {U'H', "M0 70L0 0M50 70L50 0M0 37L50 37"},
    {U'I', "M0 70L0 0"},
    {U'J', "M28 70L28 18Q28 0 14 0Q2 0 0 12"},
    {U'K', "M0 70L0 0M44 70L0 28M14 41L47 0"},
    {U'L', "M0 70L0 0L40 0"},
    {U'M', "M0 0L0 70L31 12L62 70L62 0"},
    {U'N', "M0 0L0 70L50 0L50 70"},
    {U'O', "M0 35Q0 70 31 70Q62 70 62 35Q62 0 31 0Q0 0 0 35"},
    {U'P', "M0 0L0 70L24 70Q45 70 45 51Q45 32 24 32L0 32"},
    {U'Q', "M0 35Q0 70 31 70Q62 70 62 35Q62 0 31 0Q0 0 0 35M40 16L60 -6"},
    {U'R', "M0 0L0 70L24 70Q45 70 45 51Q45 32 24 32L0 32M25 32L47 0"},
    {U'S', "M43 57Q38 70 23 70Q3 70 3 54Q3 39 23 36Q46 33 46 18Q46 0 23 0Q4 0 0 14"},
    {U'T', "M0 70L50 70M25 70L25 0"},
    {U'U', "M0 70L0 25Q0 0 25 0Q50 0 50 25L50 70"},
    {U'V', "M0 70L26 0L52 70"},
    {U'W', "M0 70L19 0L38 68L57 0L76 70"},
    {U'X', "M0 0L48 70M48 0L0 70"},
    {U'Y', "M0 70L24 34L48 70M24 34L24 0"},
    {U'Z', "M2 70L46 70L0 0L47 0"},
    {U'0', "M0 35Q0 70 20 70Q40 70 40 35Q40 0 20 0Q0 0 0 35"},
    {U'1', "M6 56L22 70L22 0M40 0"},
    {U'2', "M1 54Q3 70 20 70Q39 70 39 52Q39 41 26 29L0 0L40 0"},
    {U'3', "M2 57Q6 70 20 70Q37 70 37 54Q37 38 18 38Q40 38 40 19Q40 0 19 0Q3 0 0 14"},
    {U'4', "M29 0L29 70L0 20L40 20"},
    {U'5', "M36 70L7 70L4 38Q9 44 19 44Q39 44 39 22Q39 0 18 0Q3 0 0 12M40 0"},
    {U'6', "M36 61Q32 70 21 70Q0 70 0 32L0 22Q0 44 20 44Q40 44 40 22Q40 0 20 0Q0 0 0 22"},
    {U'7', "M0 70L40 70L14 0"},
    {U'8',
     "M20 38Q3 38 3 54Q3 70 20 70Q37 70 37 54Q37 38 20 38Q0 38 0 19Q0 0 20 0Q40 0 40 19"
     "Q40 38 20 38"},
    {U'9', "M4 9Q8 0 19 0Q40 0 40 38L40 48Q40 26 20 26Q0 26 0 48Q0 70 20 70Q40 70 40 48"},
    {U' ', "M14 0"},
    {U'.', "M0 0L0 1"},
    {U',', "M2 2L-2 -11"},
    {U':', "M0 1L0 2M0 43L0 44"},
    {U';', "M2 2L-2 -11M2 43L2 44"},
    {U'!', "M0 70L0 22M0 0L0 1"},
    {U'?', "M0 57Q4 70 17 70Q34 70 34 53Q34 42 26 36Q17 30 17 20M17 0L17 1"},
    {U'\'', "M0 70L0 52"},
    {U'"', "M0 70L0 52M14 70L14 52"},
    {U'(', "M14 78Q0 62 0 32Q0 2 14 -14"},
    {U')', "M0 78Q14 62 14 32Q14 2 0 -14"},
    {U'[', "M14 78L0 78L0 -14L14 -14"},
    {U']', "M0 78L14 78L14 -14L0 -14"},
    {U'{', "M18 78Q8 78 8 66L8 46Q8 34 0 32Q8 30 8 18L8 -2Q8 -14 18 -14"},
    {U'}', "M0 78Q10 78 10 66L10 46Q10 34 18 32Q10 30 10 18L10 -2Q10 -14 0 -14"},
    {U'/', "M0 -8L30 76"},
    {U'\\', "M0 76L30 -8"},
    {U'|', "M0 80L0 -16"},
    {U'-', "M0 26L24 26"},
    {U'_', "M0 -8L40 -8"},
    {U'+', "M0 30L40 30M20 50L20 10"},
    {U'=', "M0 40L38 40M0 20L38 20"},
    {U'<', "M36 52L0 30L36 8"},
    {U'>', "M0 52L36 30L0 8"},
    {U'~', "M0 26Q2 38 12 36L28 26Q38 24 40 36"},
    {U'^', "M0 46L16 70L32 46"},
    {U'`', "M0 72L10 58"},
    {U'*', "M18 70L18 38M4 62L32 46M32 62L4 46"},
    {U'#', "M14 70L8 0M38 70L32 0M2 48L46 48M0 22L44 22"},
    {U'$', "M40 54Q36 64 21 64Q3 64 3 50Q3 37 21 35Q42 33 42 19Q42 5 21 5Q4 5 0 17M21 76L21 -8"},
    {U'%',
     "M0 55Q0 70 12 70Q24 70 24 55Q24 40 12 40Q0 40 0 55M40 15Q40 30 52 30Q64 30 64 15"
     "Q64 0 52 0Q40 0 40 15M54 70L10 0"},
    {U'&', "M52 0L12 48Q8 70 23 70Q37 70 37 56Q37 44 20 37Q0 30 0 16Q0 0 20 0Q42 0 50 32"},
    {U'@',
     "M46 34Q46 48 35 48Q22 48 22 31Q22 16 32 16Q46 16 46 34L46 24Q46 14 56 16Q68 20 68 36"
     "Q68 70 36 70Q0 70 0 31Q0 -8 36 -8Q48 -8 56 -3"},
    {U'°', "M0 58Q0 70 11 70Q22 70 22 58Q22 46 11 46Q0 46 0 58"},
    {U'×', "M0 46L32 12M32 46L0 12"},
    {U'·', "M0 28L0 29"},
    {U'–', "M0 26L40 26"},
    {U'—', "M0 26L64 26"},
    {U'±', "M0 38L40 38M20 58L20 18M0 2L40 2"},
    {U'µ', "M0 50L0 -20M0 20Q0 0 17 0Q36 0 36 22M36 50L36 0"},
    {U'’', "M4 72L0 56"},
};

constexpr std::string_view kBox = "M0 0L36 0L36 70L0 70L0 0";
constexpr int kPiecesOfACurve = 8;

class Pen {
 public:
  Glyph write(std::string_view path) {
    while (!path.empty()) {
      const char order = path.front();
      path.remove_prefix(1);
      const Eigen::Vector2f point = readPoint(path);
      if (order == 'M') at_ = point;
      if (order == 'L') lineTo(point);
      if (order == 'Q') curveTo(point, readPoint(path));
      glyph_.width = std::max(glyph_.width, at_.x());
    }
    return std::move(glyph_);
  }

 private:
  static float number(std::string_view& path) {
    while (path.front() == ' ') path.remove_prefix(1);
    int value = 0;
    const char* end = std::from_chars(path.data(), path.data() + path.size(), value).ptr;
    path.remove_prefix(static_cast<std::size_t>(end - path.data()));
    return static_cast<float>(value);
  }
  static Eigen::Vector2f readPoint(std::string_view& path) {
    const float x = number(path), y = number(path);
    return {x, y};
  }
  void lineTo(const Eigen::Vector2f& to) {
    glyph_.lines.push_back({at_, to});
    at_ = to;
  }
  // A conic of weight √½: between perpendicular ends it is a quarter of an ellipse.
  void curveTo(const Eigen::Vector2f& corner, const Eigen::Vector2f& to) {
    const Eigen::Vector2f from = at_;
    for (int i = 1; i <= kPiecesOfACurve; ++i) {
      const float t = static_cast<float>(i) / kPiecesOfACurve, s = 1 - t;
      const float a = s * s, b = 2 * s * t * std::sqrt(0.5f), c = t * t;
      lineTo((a * from + b * corner + c * to) / (a + b + c));
    }
  }

  Glyph glyph_;
  Eigen::Vector2f at_{0, 0};
};

std::map<char32_t, Glyph> writeAll() {
  std::map<char32_t, Glyph> glyphs;
  for (const Path& path : kOutlines) glyphs[path.character] = Pen().write(path.strokes);
  for (const Path& path : kOnABowl)
    glyphs[path.character] = Pen().write(std::string(kBowl) + std::string(path.strokes));
  return glyphs;
}

}  // namespace

const Glyph& glyphOf(char32_t character) {
  static const std::map<char32_t, Glyph> glyphs = writeAll();
  static const Glyph box = Pen().write(kBox);
  const auto found = glyphs.find(character);
  return found == glyphs.end() ? box : found->second;
}

}  // namespace fascia
