#include <fascia/render/overlay.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include <fascia/render/glyphs.h>

namespace fascia {
namespace {

constexpr double kUnits = 100;   // of the letters' grid in a line's height
constexpr double kSpacing = 17;  // between letters, of those
constexpr char32_t kBroken = 0xFFFD;

// The first character of UTF-8 text, which loses it. Bytes that are none give U+FFFD one by one.
char32_t nextCharacter(std::string_view& text) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80       ? 1
                             : first >> 5 == 6  ? 2
                             : first >> 4 == 14 ? 3
                             : first >> 3 == 30 ? 4
                                                : 0;
  bool whole = length >= 1 && length <= text.size();
  for (std::size_t i = 1; whole && i < length; ++i) whole = byte(i) >> 6 == 2;
  if (!whole) {
    text.remove_prefix(1);
    return kBroken;
  }
  char32_t character = length == 1 ? first : first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) character = character << 6 | (byte(i) & 0x3Fu);
  text.remove_prefix(length);
  return character;
}

void blend(Pixels& picture, int x, int y, const Ink& ink, double coverage) {
  const float share = static_cast<float>(std::clamp(coverage, 0.0, 1.0)) * ink.opacity;
  if (share <= 0) return;
  std::uint8_t* pixel = picture.rgba.data() +
                        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(x));
  for (int k = 0; k < 3; ++k) {
    const float below = pixel[k];
    const float above = 255 * std::clamp(ink.color[k], 0.f, 1.f);
    pixel[k] = static_cast<std::uint8_t>(std::lround(below + share * (above - below)));
  }
}

// Calls cover(x, y) with the middles of all pixels in a box, and blends by how much it says.
template <class Cover>
void shade(Pixels& picture, const Eigen::Vector2d& low, const Eigen::Vector2d& high, const Ink& ink,
           const Cover& cover) {
  const int x0 = static_cast<int>(std::clamp(std::floor(low.x()), 0.0, double(picture.width)));
  const int y0 = static_cast<int>(std::clamp(std::floor(low.y()), 0.0, double(picture.height)));
  const int x1 = static_cast<int>(std::clamp(std::ceil(high.x()), 0.0, double(picture.width)));
  const int y1 = static_cast<int>(std::clamp(std::ceil(high.y()), 0.0, double(picture.height)));
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      blend(picture, x, y, ink, cover(Eigen::Vector2d(x + 0.5, y + 0.5)));
}

double distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0;
  return (p - a - t * along).norm();
}

void drawGlyph(Pixels& picture, double x, double baseline, const Glyph& glyph,
               const TextStyle& style) {
  if (glyph.lines.empty()) return;
  const double scale = style.size / kUnits, half = 0.5 * style.weight * style.size;
  const auto placed = [&](const Eigen::Vector2f& p) {
    return Eigen::Vector2d(x + scale * p.x(), baseline - scale * p.y());
  };
  std::vector<std::array<Eigen::Vector2d, 2>> lines;
  Eigen::Vector2d low = placed(glyph.lines[0].from), high = low;
  for (const Glyph::Line& line : glyph.lines) {
    lines.push_back({placed(line.from), placed(line.to)});
    for (const Eigen::Vector2d& p : lines.back()) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(half + 1);
  shade(picture, low - margin, high + margin, style.ink, [&](const Eigen::Vector2d& p) {
    double nearest = 1e300;
    for (const auto& line : lines) nearest = std::min(nearest, distance(p, line[0], line[1]));
    return half + 0.5 - nearest;
  });
}

}  // namespace

double textWidth(std::string_view text, const TextStyle& style) {
  double width = 0;
  while (!text.empty()) width += glyphOf(nextCharacter(text)).width + kSpacing;
  return std::max(0.0, width - kSpacing) * style.size / kUnits;
}

double drawText(Pixels& picture, double x, double baseline, std::string_view text,
                const TextStyle& style) {
  const double end = x + textWidth(text, style);
  while (!text.empty()) {
    const Glyph& glyph = glyphOf(nextCharacter(text));
    drawGlyph(picture, x, baseline, glyph, style);
    x += (glyph.width + kSpacing) * style.size / kUnits;
  }
  return end;
}

void fillBox(Pixels& picture, const Rectangle& box, const Ink& ink, double cornerRadius) {
  const Eigen::Vector2d half(0.5 * box.width, 0.5 * box.height);
  const Eigen::Vector2d middle = Eigen::Vector2d(box.x, box.y) + half;
  const double radius = std::min({cornerRadius, half.x(), half.y()});
  const Eigen::Vector2d inner = half - Eigen::Vector2d::Constant(radius);
  shade(picture, middle - half, middle + half, ink, [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d out = (p - middle).cwiseAbs() - inner;
    const double outside =
        out.cwiseMax(0.0).norm() + std::min(out.maxCoeff(), 0.0) - radius;  // signed distance
    return 0.5 - outside;
  });
}

void drawRing(Pixels& picture, double x, double y, double radius, double thickness,
              const Ink& ink) {
  const Eigen::Vector2d middle(x, y);
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(radius + 0.5 * thickness + 1);
  shade(picture, middle - reach, middle + reach, ink, [&](const Eigen::Vector2d& p) {
    return 0.5 * thickness + 0.5 - std::abs((p - middle).norm() - radius);
  });
}

void placeColumns(const Pixels& piece, int columns, int x, int y, Pixels& picture) {
  assert(columns >= 0 && columns <= piece.width);
  assert(x >= 0 && y >= 0 && x + columns <= picture.width && y + piece.height <= picture.height);
  const std::size_t row = 4 * static_cast<std::size_t>(columns);
  for (int line = 0; line < piece.height; ++line) {
    const std::uint8_t* from = piece.at(0, line);
    std::copy(from, from + row,
              picture.rgba.begin() + (picture.at(x, y + line) - picture.rgba.data()));
  }
}

void place(const Pixels& piece, int x, int y, Pixels& picture) {
  placeColumns(piece, piece.width, x, y, picture);
}

}  // namespace fascia
